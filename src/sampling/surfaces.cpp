#include "sampling/surfaces.h"

#include <variant>

namespace ink {

namespace {

Vec3f hit_normal(const HitPacket& hits, int lane) {
    return {hits.normal_x[lane], hits.normal_y[lane], hits.normal_z[lane]};
}

/// Whether the side of a triangle that its corners run round anticlockwise is the one with
/// `normal`.
bool shows_front(const Mesh& mesh, const Mesh::Triangle& triangle, Vec3f normal) {
    const Vec3f a = mesh.vertices[triangle[0]];
    const Vec3f b = mesh.vertices[triangle[1]];
    const Vec3f c = mesh.vertices[triangle[2]];
    return dot(cross(b - a, c - a), normal) > 0.0F;
}

}  // namespace

Ball Surfaces::ball(const HitPacket& hits, int lane) const {
    if (hits.object[lane] == kNoObject) return {};
    const auto* spheres = std::get_if<Spheres>(&scene_.objects()[hits.object[lane]].shape);
    if (spheres == nullptr) return {};
    const Sphere& sphere = spheres->spheres[hits.primitive[lane]];
    return {sphere.centre, sphere.radius};
}

bool Surfaces::smooth_between(const HitPacket& a, int lane_a, const HitPacket& b,
                              int lane_b) const {
    if (a.object[lane_a] == kNoObject || a.object[lane_a] != b.object[lane_b]) return false;
    const Object& object = scene_.objects()[a.object[lane_a]];
    const std::uint32_t primitive_a = a.primitive[lane_a];
    const std::uint32_t primitive_b = b.primitive[lane_b];
    const auto* mesh = std::get_if<Mesh>(&object.shape);
    if (primitive_a == primitive_b) {
        return mesh != nullptr || std::holds_alternative<Spheres>(object.shape);
    }
    const bool facets_turn = object.normals.value_or(normals_) == NormalSource::geometric;
    return mesh != nullptr && !facets_turn &&
           across_smooth_edge(*mesh, primitive_a, hit_normal(a, lane_a), primitive_b,
                              hit_normal(b, lane_b));
}

bool Surfaces::across_smooth_edge(const Mesh& mesh, std::uint32_t a, Vec3f normal_a,
                                  std::uint32_t b, Vec3f normal_b) const {
    if (mesh.edge_flags.empty()) return false;
    const Mesh::Triangle& first = mesh.triangles[a];
    const Mesh::Triangle& second = mesh.triangles[b];
    for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = first[k];
        const std::uint32_t to = first[(k + 1) % 3];
        for (std::size_t n = 0; n < 3; ++n) {
            // The other triangle runs the edge the other way, if both face one side.
            if (second[n] != to || second[(n + 1) % 3] != from) continue;
            return !mesh.is_crease(a, k) && !mesh.is_boundary(a, k) &&
                   shows_front(mesh, first, normal_a) == shows_front(mesh, second, normal_b);
        }
    }
    return false;
}

}  // namespace ink
