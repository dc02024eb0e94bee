#pragma once

#include <cstdint>
#include <vector>

#include "base/color.h"
#include "base/vec.h"

namespace ink {

struct Sphere {
    Vec3f centre;  ///< in the frame of the object or scene that holds it
    float radius;  ///< > 0
};

/// Spheres as flat arrays. `colors` and `parts` have one entry a sphere, or none at all.
struct Spheres {
    std::vector<Sphere> spheres;
    std::vector<Rgb8> colors;          ///< instead of the material's
    std::vector<std::uint32_t> parts;  ///< index into the object's `part_names`
};

}  // namespace ink
