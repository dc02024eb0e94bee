#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/color.h"
#include "base/vec.h"
#include "scene/motion.h"

namespace ink {

struct Sphere {
    Vec3f centre;  ///< in the frame of the object or scene that holds it
    float radius;  ///< > 0
};

/// Spheres as flat arrays. `colors` and `parts` have one entry a sphere, or none at all.
///
/// All of them may be there several times: with `copies`, they are drawn once for each of these, by
/// which they are moved, and nothing is stored anew. Primitives are numbered copy by copy.
struct Spheres {
    std::vector<Sphere> spheres;
    std::vector<Rgb8> colors;          ///< instead of the material's
    std::vector<std::uint32_t> parts;  ///< index into the object's `part_names`
    std::vector<Motion> copies{};      ///< in the frame of `spheres`; empty: once, as they are
    std::uint32_t parts_a_copy = 0;  ///< parts of copy k are k times this on; 0: copies share them

    std::size_t copy_count() const { return std::max<std::size_t>(copies.size(), 1); }
    std::size_t count() const { return spheres.size() * copy_count(); }
    /// The entry of `spheres` that a primitive is a copy of, and which copy it is.
    std::size_t source(std::size_t primitive) const {
        return copies.empty() ? primitive : narrow(primitive) % narrow(spheres.size());
    }
    std::size_t copy(std::size_t primitive) const {
        return copies.empty() ? 0 : narrow(primitive) / narrow(spheres.size());
    }
    Sphere at(std::size_t primitive) const {
        if (copies.empty()) return spheres[primitive];
        const Sphere& sphere = spheres[source(primitive)];
        return {copies[copy(primitive)](sphere.centre), sphere.radius};
    }

  private:
    /// Primitives are numbered in 32 bits, which divide in a third of the time.
    static std::uint32_t narrow(std::size_t number) { return static_cast<std::uint32_t>(number); }
};

}  // namespace ink
