#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/color.h"
#include "base/vec.h"
#include "scene/copies.h"

namespace ink {

struct Sphere {
    Vec3f centre;  ///< in the frame of the object or scene that holds it
    float radius;  ///< > 0
};

/// Spheres as flat arrays. `colors` and `parts` have one entry a stored sphere, or none at all.
struct Spheres {
    std::vector<Sphere> spheres;
    std::vector<Rgb8> colors;          ///< instead of the material's
    std::vector<std::uint32_t> parts;  ///< index into the object's `part_names`
    std::vector<Copy> copies{};        ///< see CopyNumbering
    std::uint32_t parts_a_copy = 0;

    CopyNumbering numbering() const { return {copies, spheres.size(), parts_a_copy}; }
    std::size_t count() const { return numbering().count(); }
    Sphere at(std::size_t primitive) const {
        if (copies.empty()) return spheres[primitive];
        const Sphere& sphere = spheres[numbering().source(primitive)];
        return {numbering().copy(primitive).motion(sphere.centre), sphere.radius};
    }
};

}  // namespace ink
