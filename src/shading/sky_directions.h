#pragma once

#include <span>
#include <vector>

#include "base/lanes.h"
#include "base/vec.h"

namespace ink {

/// Directions spread evenly over the sphere, in groups of sixteen that lie close together, so that
/// a whole group can be passed over at once.
struct SkyDirections {
    /// `groups` is a power of two.
    explicit SkyDirections(int groups);

    struct Group {
        Lanes<float> x, y, z;
        Vec3f axis;      ///< all of its directions lie within a cone about it
        float cos, sin;  ///< of the cone's half angle
        /// The same of a cone that is wider by half a spacing.
        float wide_cos, wide_sin;
    };
    std::vector<Group> groups;
    float spacing;  ///< angle between neighbours, radians
};

/// Sorts points, sixteen times a power of two, so that each sixteen of them lie close together.
void sort_into_groups(std::span<Vec3f> points);

/// The tangents of a unit vector: with it they form an orthonormal basis (Duff et al. 2017).
void make_basis(Vec3f n, Vec3f& tangent, Vec3f& bitangent);

}  // namespace ink
