#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/lanes.h"
#include "base/vec.h"

namespace ink {

/// Sets of groups of directions, a bit each.
inline constexpr std::size_t kGroupsAWord = 64;
using GroupBits = std::array<std::uint64_t, 2>;

/// Directions spread evenly over the sphere, in groups of sixteen that lie close together, so that
/// a whole group can be passed over at once.
struct SkyDirections {
    /// No more `groups` than GroupBits has room for.
    explicit SkyDirections(int groups);

    struct Group {
        Lanes<float> x, y, z;
        Vec3f axis;      ///< all of its directions lie within a cone about it
        float cos, sin;  ///< of the cone's half angle
        /// The same of a cone that is wider by half a spacing.
        float wide_cos, wide_sin;
    };
    std::vector<Group> groups;
    /// Axes of sixteen groups; those past the last group are like the last.
    struct Axes {
        Lanes<float> x, y, z;
        Lanes<float> sin, wide_cos, wide_sin;
    };
    std::vector<Axes> axes;
    std::size_t words() const { return (groups.size() + kGroupsAWord - 1) / kGroupsAWord; }
    /// Bits of a word that stand for groups.
    std::uint64_t used(std::size_t word) const {
        const std::size_t rest = groups.size() - word * kGroupsAWord;
        return rest >= kGroupsAWord ? ~std::uint64_t{0} : (std::uint64_t{1} << rest) - 1U;
    }
    float spacing;  ///< angle between neighbours, radians
};

/// Sorts points, a multiple of sixteen, so that each sixteen of them lie close together.
void sort_into_groups(std::span<Vec3f> points);

/// The tangents of a unit vector: with it they form an orthonormal basis (Duff et al. 2017).
void make_basis(Vec3f n, Vec3f& tangent, Vec3f& bitangent);

}  // namespace ink
