#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "base/vec.h"
#include "scene/mesh.h"

namespace ink {

/// A triangle's corners and the normals there, which face the side that is seen.
struct TriangleCorners {
    std::array<Vec3f, 3> points, normals;
    bool from_behind;
    bool smooth;

    Vec3f point(float u, float v) const {
        return points[0] * (1.0F - u - v) + points[1] * u + points[2] * v;
    }
    Vec3f normal(float u, float v) const {
        return normalize(normals[0] * (1.0F - u - v) + normals[1] * u + normals[2] * v);
    }
    float longest() const {
        return std::max({length(points[1] - points[0]), length(points[2] - points[1]),
                         length(points[0] - points[2])});
    }
    float area() const {
        return 0.5F * length(cross(points[1] - points[0], points[2] - points[0]));
    }
};

/// `seen_normal`: any that faces the side that is seen; it stands in where there is no area.
TriangleCorners corners_of(const Mesh& mesh, std::uint32_t triangle, Vec3f seen_normal);

}  // namespace ink
