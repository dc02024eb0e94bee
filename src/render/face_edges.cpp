#include "render/face_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

namespace ink {

namespace {

/// Parts of edges that are nearer to the eye than this, in widths of a pixel at the edge's farther
/// end, are left out.
constexpr float kNearest = 1e-3F;

}  // namespace

void FaceEdges::begin() {
    edges_.clear();
    std::ranges::fill(table_, Face{});
    faces_ = 0;
}

bool FaceEdges::measure(int x, int y, float reach, NearestEdges& nearest) {
    if (!map_.get(x, y, nearest.triangle)) return false;
    near_.clear();
    Lanes<std::uint32_t> triangles;
    const std::size_t count = find_distinct(nearest.triangle, FaceMap::kNone, triangles);
    for (const std::uint32_t triangle : std::span(triangles).first(count)) {
        const FaceMap::Triangle seen = map_.triangle(triangle);
        const TriangleRange face = triangles_of(*map_.mesh(seen.object), seen.primitive);
        // Counted over all meshes.
        const std::uint32_t first = triangle - (seen.primitive - face.begin);
        const TriangleRange numbers{first, first + (face.end - face.begin)};
        const bool several = face.end - face.begin > 1;
        const auto is_own = [first](const FaceEdge& edge) { return edge.begin == first; };
        if (several && std::ranges::any_of(near_, is_own)) continue;
        collect(edges_of(first, seen, face), numbers, x, y, reach);
    }
    if (near_.empty()) return false;
    Lanes<float> vx;
    Lanes<float> vy;
    find_nearest(near_, static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F, reach, nearest,
                 vx, vy);
    if (map_.any_marked(x, y, reach)) {
        for (int i = 0; i < kLanes; ++i) {
            const Vec2f foot{static_cast<float>(x + i % kBlockSide) + 0.5F - vx[i],
                             static_cast<float>(y + i / kBlockSide) + 0.5F - vy[i]};
            if (nearest.distance[i] < kInfinity && map_.marked(foot)) {
                nearest.distance[i] = kInfinity;
            }
        }
    }
    return std::ranges::any_of(nearest.distance, [](float d) { return d < kInfinity; });
}

/// Of a large face, those edges only that matter to a block.
void FaceEdges::collect(std::span<const ScreenEdge> edges, TriangleRange numbers, int x, int y,
                        float reach) {
    const Vec2f middle{static_cast<float>(x) + 0.5F * kBlockSide,
                       static_cast<float>(y) + 0.5F * kBlockSide};
    const float most = reach + 0.5F * kBlockSide * std::numbers::sqrt2_v<float>;
    for (const ScreenEdge& edge : edges) {
        if (edges.size() > 3) {
            const Vec2f r = middle - edge.a;
            const Vec2f v = r - edge.along * std::clamp(dot(r, edge.along), 0.0F, edge.length);
            if (dot(v, v) > most * most) continue;
        }
        near_.push_back({edge, numbers.begin, numbers.end});
    }
}

TriangleRange FaceEdges::triangles_of(const Mesh& mesh, std::uint32_t triangle) {
    TriangleRange range{triangle, triangle + 1};
    if (mesh.faces.empty()) return range;
    const std::uint32_t face = mesh.faces[triangle];
    while (range.begin > 0 && mesh.faces[range.begin - 1] == face) --range.begin;
    while (range.end < mesh.faces.size() && mesh.faces[range.end] == face) ++range.end;
    return range;
}

/// `first`: number of the first triangle over all meshes.
std::span<const ScreenEdge> FaceEdges::edges_of(std::uint32_t first, FaceMap::Triangle seen,
                                                TriangleRange triangles) {
    if (2 * faces_ >= table_.size()) grow();
    Face& face = table_[place_of(first)];
    if (face.key == FaceMap::kNone) {
        const std::size_t begin = edges_.size();
        add_edges(seen.object, triangles);
        face = {first, static_cast<std::uint32_t>(begin),
                static_cast<std::uint32_t>(edges_.size() - begin)};
        ++faces_;
    }
    return std::span(edges_).subspan(face.first, face.count);
}

/// Where a face is in the table, or is to be put.
std::size_t FaceEdges::place_of(std::uint32_t key) const {
    const std::size_t mask = table_.size() - 1;
    std::size_t place = (key * 0x9E3779B97F4A7C15U >> 32U) & mask;
    while (table_[place].key != FaceMap::kNone && table_[place].key != key) {
        place = (place + 1) & mask;
    }
    return place;
}

void FaceEdges::grow() {
    std::vector<Face> old(2 * table_.size());
    old.swap(table_);
    for (const Face& face : old) {
        if (face.key != FaceMap::kNone) table_[place_of(face.key)] = face;
    }
}

/// The edges that bound the face, but not the open ones: those have lines of their own.
void FaceEdges::add_edges(std::uint32_t object, TriangleRange triangles) {
    const Mesh& mesh = *map_.mesh(object);
    const std::vector<ScreenPoint>& points = vertices_.of(object);
    // Edges within the face are there twice, in both directions.
    const auto number = [](std::uint32_t from, std::uint32_t to) {
        return static_cast<std::uint64_t>(from) << 32U | to;
    };
    directed_.clear();
    const bool several = triangles.end - triangles.begin > 1;
    for (std::uint32_t t = triangles.begin; several && t < triangles.end; ++t) {
        const Mesh::Triangle& corners = mesh.triangles[t];
        for (std::size_t k = 0; k < 3; ++k) {
            directed_.push_back(number(corners[k], corners[(k + 1) % 3]));
        }
    }
    std::ranges::sort(directed_);
    for (std::uint32_t t = triangles.begin; t < triangles.end; ++t) {
        const Mesh::Triangle& corners = mesh.triangles[t];
        std::array<Corner, 3> projected;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3f position = mesh.vertices[corners[k]];
            projected[k] = {position, points.empty() ? project(projection_, to_double(position))
                                                     : points[corners[k]]};
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t next = (k + 1) % 3;
            const std::uint32_t from = corners[k];
            const std::uint32_t to = corners[next];
            if (!mesh.edge_flags.empty() && mesh.is_boundary(t, k)) continue;
            if (std::ranges::binary_search(directed_, number(to, from))) continue;
            // The two faces of an edge must agree on where it is, to the last bit.
            if (from < to) {
                add_edge(projected[k], projected[next]);
            } else {
                add_edge(projected[next], projected[k]);
            }
        }
    }
}

void FaceEdges::add_edge(Corner a, Corner b) {
    const float least = kNearest * std::max(a.seen.width, b.seen.width);
    if (least <= 0.0F) return;  // behind the eye
    if (a.seen.width < least || b.seen.width < least) {
        const bool a_is_near = a.seen.width < b.seen.width;
        Corner& near = a_is_near ? a : b;
        const Corner& far = a_is_near ? b : a;
        const double way = static_cast<double>(least - near.seen.width) /
                           static_cast<double>(far.seen.width - near.seen.width);
        const Vec3d from = to_double(near.position);
        near.seen = project(projection_, from + (to_double(far.position) - from) * way);
    }
    const Vec2f d{b.seen.x - a.seen.x, b.seen.y - a.seen.y};
    const float length = ink::length(d);
    const Vec2f along = length > 0.0F ? d * (1.0F / length) : Vec2f{1.0F, 0.0F};
    const Vec2f off = Vec2f{a.seen.x + b.seen.x, a.seen.y + b.seen.y} * 0.5F - projection_.centre;
    const auto step = static_cast<float>(projection_.slope_step);
    const float t =
        0.5F * (a.seen.depth + b.seen.depth) * std::sqrt(1.0F + step * step * dot(off, off));
    edges_.push_back({{a.seen.x, a.seen.y}, along, length, t});
}

}  // namespace ink
