#include "sampling/surfaces.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <variant>

#include "base/multiversion.h"
#include "sampling/shared_edges.h"

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

/// From a point of a triangle to its nearest open edge.
float rim_distance(const Mesh& mesh, std::uint32_t triangle, Vec3f point) {
    float least = std::numeric_limits<float>::infinity();
    const Mesh::Triangle& corners = mesh.triangles[triangle];
    for (std::size_t k = 0; k < 3; ++k) {
        if (!mesh.is_boundary(triangle, k)) continue;
        const Vec3f a = mesh.vertices[corners[k]];
        const Vec3f edge = mesh.vertices[corners[(k + 1) % 3]] - a;
        least = std::min(least, length(cross(edge, point - a)) / length(edge));
    }
    return least;
}

/// Where the way from screen point `from`, which sees the triangle, to `to` leaves it, in [0, 1].
double way_out_of_triangle(const Viewpoint& viewpoint, const Mesh& mesh,
                           const Mesh::Triangle& triangle, Vec2f from, Vec2f to) {
    const Vec3d origin_0 = viewpoint.origin(from);
    const Vec3d origin_1 = viewpoint.origin(to);
    const Vec3d direction_0 = viewpoint.direction(from);
    const Vec3d direction_1 = viewpoint.direction(to);
    double out = 1.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d a = to_double(mesh.vertices[triangle[k]]);
        const Vec3d edge = to_double(mesh.vertices[triangle[(k + 1) % 3]]) - a;
        // On which side of the edge a ray passes; along the way this is linear.
        const double side_0 = dot(cross(direction_0, edge), origin_0 - a);
        const double side_1 = dot(cross(direction_1, edge), origin_1 - a);
        if ((side_0 > 0.0) == (side_1 > 0.0)) continue;
        out = std::min(out, side_0 / (side_0 - side_1));
    }
    return out;
}

/// Which part of a frustum's surface a hit lies on, with its normal towards the viewer.
enum class FrustumPart : std::uint8_t { cap, outside, inside };

FrustumPart frustum_part(const UnitShape& shape, const Placement& placement, Vec3f normal,
                         Vec3f at) {
    const Vec3d x = to_double(placement.x_axis);
    const Vec3d y = to_double(placement.y_axis);
    const Vec3d z = to_double(placement.z_axis);
    const Vec3d along = cross(x, y);
    const Vec3d n = to_double(normal);
    constexpr double kParallel = 1.0 - 1e-6;
    const double cosine = std::abs(dot(n, along)) / length(along);
    if (shape.capped && cosine > kParallel) return FrustumPart::cap;
    // Coordinates of the unit shape, times the map's volume; the outward normal of its side.
    const Vec3d p = to_double(at) - to_double(placement.origin);
    const double volume = dot(z, along);
    const double height = dot(along, p) / volume;
    const double radius = 0.5 * (1.0 + shape.a) + 0.5 * (shape.a - 1.0) * height;
    const Vec3d yz = cross(y, z);
    const Vec3d zx = cross(z, x);
    const Vec3d outward = yz * (dot(yz, p) / volume) + zx * (dot(zx, p) / volume) -
                          along * (0.5 * (shape.a - 1.0) * radius);
    return dot(outward, n) * volume > 0.0 ? FrustumPart::outside : FrustumPart::inside;
}

/// Whether two hits on one glyph, with normals towards the viewer, lie on a part of its surface
/// that is smooth and hides none of itself.
bool smooth_glyph(const UnitShape& shape, const Placement& placement, Vec3f normal_a,
                  const Vec3f* at_a, Vec3f normal_b, const Vec3f* at_b) {
    switch (shape.kind) {
        case GlyphKind::ellipsoid:
        case GlyphKind::disc:
        case GlyphKind::rectangle: return true;
        case GlyphKind::box: return dot(normal_a, normal_b) > 1.0F - 1e-6F;
        case GlyphKind::frustum:
            return at_a != nullptr && at_b != nullptr &&
                   frustum_part(shape, placement, normal_a, *at_a) ==
                       frustum_part(shape, placement, normal_b, *at_b);
        case GlyphKind::torus:
        case GlyphKind::superellipsoid:
        case GlyphKind::gaussian:
        case GlyphKind::waves: return false;
    }
    return false;
}

/// Whether no primitive has a line within itself.
bool has_plain_primitives(const Shape& shape) {
    return std::holds_alternative<Mesh>(shape) || std::holds_alternative<Spheres>(shape);
}

/// Of edges of a mesh that are known.
void drop_creases(const Mesh& mesh, std::span<std::uint32_t> edges) {
    for (std::uint32_t& edge : edges) {
        if (edge == Mesh::kNoTwin) continue;
        const std::uint32_t triangle = edge / 3;
        const std::uint32_t k = edge % 3;
        if (mesh.is_crease(triangle, k) || mesh.is_boundary(triangle, k)) edge = Mesh::kNoTwin;
    }
}

INKTRACE_MULTIVERSION
void number_hits(const std::uint32_t* firsts, const HitPacket& hits,
                 Lanes<std::uint32_t>& numbers) {
    for (int i = 0; i < kLanes; ++i) {
        const std::uint32_t object = hits.object[i] == kNoObject ? 0 : hits.object[i];
        numbers[i] = firsts[object] + hits.primitive[i];
    }
}

}  // namespace

Surfaces::Surfaces(const Scene& scene, NormalSource normals) : scene_(scene), normals_(normals) {
    std::size_t next = 0;
    for (const Object& object : scene.objects()) {
        spheres_.push_back(std::get_if<Spheres>(&object.shape));
        meshes_.push_back(std::get_if<Mesh>(&object.shape));
        const std::size_t past = next + object.primitive_count();
        const bool plain =
            has_plain_primitives(object.shape) && past <= SampleGrid::kUnknownSurface;
        numbers_.push_back(plain ? static_cast<std::uint32_t>(next) : SampleGrid::kUnknownSurface);
        if (plain) numbered_.push_back(meshes_.size() - 1);
        if (plain) next = past;
    }
}

void Surfaces::number(const HitPacket& hits, Lanes<std::uint32_t>& numbers) const {
    if (numbers_.size() == 1 && numbers_[0] == 0) {
        numbers = hits.primitive;
    } else {
        number_hits(numbers_.data(), hits, numbers);
    }
}

void Surfaces::describe(const HitPacket& hits, int lane, Sample& sample) const {
    if (hits.object[lane] == kNoObject) return;
    sample.facet = hit_normal(hits, lane);
    const Shape& shape = scene_.objects()[hits.object[lane]].shape;
    if (const auto* spheres = std::get_if<Spheres>(&shape)) {
        const Sphere sphere = spheres->at(hits.primitive[lane]);
        sample.ball = {sphere.centre, sphere.radius};
    } else if (const auto* mesh = std::get_if<Mesh>(&shape)) {
        if (!mesh->edge_flags.empty())
            sample.rim = rim_distance(*mesh, hits.primitive[lane], sample.position);
        sample.object = hits.object[lane];
        sample.triangle = hits.primitive[lane];
    }
}

double Surfaces::way_out(const Viewpoint& viewpoint, const Sample& sample, Vec2f from,
                         Vec2f to) const {
    if (sample.triangle == kNoTriangle) return 1.0;
    const auto& mesh = std::get<Mesh>(scene_.objects()[sample.object].shape);
    return way_out_of_triangle(viewpoint, mesh, mesh.triangles[sample.triangle], from, to);
}

bool Surfaces::is_mesh(std::uint32_t object) const {
    return std::holds_alternative<Mesh>(scene_.objects()[object].shape);
}

std::uint32_t Surfaces::face(const HitPacket& hits, int lane) const {
    if (hits.object[lane] == kNoObject) return 0;
    const auto* mesh = std::get_if<Mesh>(&scene_.objects()[hits.object[lane]].shape);
    if (mesh == nullptr) return 0;
    return mesh->faces.empty() ? hits.primitive[lane] : mesh->faces[hits.primitive[lane]];
}

float Surfaces::face_crossing(const Viewpoint& viewpoint, Vec2f a, const HitPacket& hits_a,
                              int lane_a, Vec2f b, const HitPacket& hits_b, int lane_b) const {
    const auto& mesh = std::get<Mesh>(scene_.objects()[hits_a.object[lane_a]].shape);
    const auto way_out = [&](Vec2f from, Vec2f to, std::uint32_t triangle) {
        return way_out_of_triangle(viewpoint, mesh, mesh.triangles[triangle], from, to);
    };
    const double leaves = way_out(a, b, hits_a.primitive[lane_a]);
    const double enters = 1.0 - way_out(b, a, hits_b.primitive[lane_b]);
    return static_cast<float>(std::clamp(0.5 * (leaves + enters), 0.0, 1.0));
}

bool Surfaces::smooth_between(const HitPacket& a, int lane_a, const Vec3f* at_a, const HitPacket& b,
                              int lane_b, const Vec3f* at_b) const {
    if (a.object[lane_a] == kNoObject || a.object[lane_a] != b.object[lane_b]) return false;
    const Object& object = scene_.objects()[a.object[lane_a]];
    const std::uint32_t primitive_a = a.primitive[lane_a];
    const std::uint32_t primitive_b = b.primitive[lane_b];
    const auto* mesh = std::get_if<Mesh>(&object.shape);
    if (primitive_a == primitive_b) {
        if (const auto* glyphs = std::get_if<Glyphs>(&object.shape)) {
            return smooth_glyph(glyphs->shape, glyphs->at(primitive_a), hit_normal(a, lane_a), at_a,
                                hit_normal(b, lane_b), at_b);
        }
        return mesh != nullptr || std::holds_alternative<Spheres>(object.shape);
    }
    const bool facets_turn = object.normals.value_or(normals_) == NormalSource::geometric;
    return mesh != nullptr && !facets_turn &&
           across_smooth_edge(*mesh, primitive_a, hit_normal(a, lane_a), primitive_b,
                              hit_normal(b, lane_b));
}

void Surfaces::find_smooth_edges(const Viewpoint& viewpoint, std::span<const std::uint32_t> first,
                                 std::span<const std::uint32_t> second,
                                 std::span<std::uint32_t> edges) const {
    std::ranges::fill(edges, Mesh::kNoTwin);
    const auto first_number = [&](std::size_t object) { return numbers_[object]; };
    for (std::size_t k = 0; k < first.size();) {
        if (first[k] >= SampleGrid::kUnknownSurface) {
            ++k;
            continue;
        }
        // Those that begin on one object go together.
        const auto after = std::ranges::upper_bound(numbered_, first[k], {}, first_number);
        const std::size_t object = *(after - 1);
        const std::uint32_t base = numbers_[object];
        const std::uint32_t past =
            after == numbered_.end() ? SampleGrid::kUnknownSurface : numbers_[*after];
        const auto others = first.subspan(k);
        const auto end = std::ranges::find_if(
            others, [&](std::uint32_t number) { return number < base || number >= past; });
        const auto count = static_cast<std::size_t>(end - others.begin());
        if (knows_smooth_edges(object)) {
            const Mesh& mesh = *meshes_[object];
            const auto found = edges.subspan(k, count);
            find_shared_edges(mesh, viewpoint, base, others.first(count), second.subspan(k, count),
                              found);
            drop_creases(mesh, found);
        }
        k += count;
    }
}

/// Whether normals are the same on both sides of edges that are no creases, and it is known which
/// these are.
bool Surfaces::knows_smooth_edges(std::size_t object) const {
    const Mesh* mesh = meshes_[object];
    const bool facets_turn =
        scene_.objects()[object].normals.value_or(normals_) == NormalSource::geometric;
    return mesh != nullptr && !facets_turn && !mesh->edge_flags.empty() &&
           std::max(mesh->triangles.size(), mesh->vertices.size()) <= kMostShared;
}

bool Surfaces::across_smooth_edge(const Mesh& mesh, std::uint32_t a, Vec3f normal_a,
                                  std::uint32_t b, Vec3f normal_b) const {
    if (mesh.edge_flags.empty() || mesh.twins.empty()) return false;
    for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t twin = mesh.twins[3 * a + k];
        if (twin - 3 * b >= 3) continue;
        const Mesh::Triangle& first = mesh.triangles[a];
        const Mesh::Triangle& second = mesh.triangles[b];
        // The other triangle runs the edge the other way, if both face one side.
        if (second[twin - 3 * b] == first[k]) continue;
        return !mesh.is_crease(a, k) && !mesh.is_boundary(a, k) &&
               shows_front(mesh, first, normal_a) == shows_front(mesh, second, normal_b);
    }
    return false;
}

}  // namespace ink
