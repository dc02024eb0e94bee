#include "shading/triangle_corners.h"

namespace ink {

TriangleCorners corners_of(const Mesh& mesh, std::uint32_t triangle, Vec3f seen_normal) {
    TriangleCorners corners{};
    for (std::size_t k = 0; k < 3; ++k) {
        corners.points[k] = mesh.vertices[mesh.triangles[triangle][k]];
    }
    const Vec3f across =
        cross(corners.points[1] - corners.points[0], corners.points[2] - corners.points[0]);
    corners.from_behind = dot(across, seen_normal) < 0.0F;
    const Vec3f facet = corners.from_behind ? -across : across;
    const float size = length(facet);
    corners.normals.fill(size > 0.0F ? facet * (1.0F / size) : seen_normal);
    corners.smooth = !mesh.corner_normals.empty();
    for (std::size_t k = 0; corners.smooth && k < 3; ++k) {
        const Vec3f n = unpack_normal(mesh.corner_normals[triangle][k]);
        corners.normals[k] = dot(n, facet) < 0.0F ? -n : n;
    }
    // Opposite normals cancel somewhere between them.
    const auto& n = corners.normals;
    const bool opposed = std::min({dot(n[0], n[1]), dot(n[1], n[2]), dot(n[2], n[0])}) < -0.5F;
    if (opposed && size > 0.0F) corners.normals.fill(facet * (1.0F / size));
    return corners;
}

}  // namespace ink
