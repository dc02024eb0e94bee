#include "render/face_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/multiversion.h"

namespace ink {

namespace {

/// Parts of edges that are nearer to the eye than this, in widths of a pixel at the edge's farther
/// end, are left out.
constexpr double kNearest = 1e-3;

/// The nearest edges so far.
struct Search {
    Lanes<float> squared;  ///< distance
    Lanes<float> vx, vy;   ///< from the edge's nearest point to the pixel
    Lanes<float> nx, ny;   ///< across the edge; 0 where its end is nearest
    Lanes<float> t;
};

/// Distances to a face's edges from those pixels, the upper left one's centre at (x, y), that see
/// one of its triangles. They leave `open`.
INKTRACE_MULTIVERSION
void approach(std::span<const ScreenEdge> edges, TriangleRange face, float x, float y,
              Lanes<std::uint32_t>& open, Search& search) {
    Lanes<float> most;
    for (int i = 0; i < kLanes; ++i) {
        const bool own = open[i] >= face.begin && open[i] < face.end;
        open[i] = own ? FaceMap::kNone : open[i];
        most[i] = own ? kInfinity : 0.0F;  // below any squared distance
    }
    for (const ScreenEdge& edge : edges) {
        const auto [a, along, length, t] = edge;
        for (int i = 0; i < kLanes; ++i) {
            const float rx = x + static_cast<float>(i % kBlockSide) - a.x;
            const float ry = y + static_cast<float>(i / kBlockSide) - a.y;
            const float s = rx * along.x + ry * along.y;
            const float nearest = std::min(std::max(s, 0.0F), length);
            const float vx = rx - nearest * along.x;
            const float vy = ry - nearest * along.y;
            const float squared = vx * vx + vy * vy;
            const bool better = squared < most[i];
            const bool inside = nearest == s;
            most[i] = better ? squared : most[i];
            search.squared[i] = better ? squared : search.squared[i];
            search.vx[i] = better ? vx : search.vx[i];
            search.vy[i] = better ? vy : search.vy[i];
            search.nx[i] = better ? (inside ? -along.y : 0.0F) : search.nx[i];
            search.ny[i] = better ? (inside ? along.x : 0.0F) : search.ny[i];
            search.t[i] = better ? t : search.t[i];
        }
    }
}

INKTRACE_MULTIVERSION
void finish(const Search& search, float reach, NearestEdges& nearest) {
    for (int i = 0; i < kLanes; ++i) {
        const float distance = std::sqrt(search.squared[i]);
        const float inverse = 1.0F / std::max(distance, 1e-6F);
        const bool end = search.nx[i] == 0.0F && search.ny[i] == 0.0F;
        nearest.nx[i] = end ? search.vx[i] * inverse : search.nx[i];
        nearest.ny[i] = end ? search.vy[i] * inverse : search.ny[i];
        nearest.distance[i] = distance < reach ? distance : kInfinity;
    }
}

}  // namespace

void FaceEdges::begin() {
    edges_.clear();
    std::ranges::fill(table_, Face{});
    faces_ = 0;
}

bool FaceEdges::measure(int x, int y, float reach, NearestEdges& nearest) {
    if (!map_.get(x, y, nearest.triangle)) return false;
    Search search{};
    search.squared.fill(kInfinity);
    Lanes<std::uint32_t> open = nearest.triangle;
    for (int lane = 0; lane < kLanes; ++lane) {
        if (open[lane] == FaceMap::kNone) continue;
        const FaceMap::Triangle seen = map_.triangle(open[lane]);
        const Mesh& mesh = *map_.mesh(seen.object);
        const TriangleRange face = triangles_of(mesh, seen.primitive);
        // Counted over all meshes.
        const std::uint32_t first = open[lane] - (seen.primitive - face.begin);
        const TriangleRange numbers{first, first + (face.end - face.begin)};
        std::span<const ScreenEdge> edges = edges_of(first, mesh, face);
        if (edges.size() > 3) edges = near_edges(edges, x, y, reach);
        approach(edges, numbers, static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F, open,
                 search);
    }
    finish(search, reach, nearest);
    if (map_.any_marked(x, y, reach)) {
        for (int i = 0; i < kLanes; ++i) {
            const Vec2f foot{static_cast<float>(x + i % kBlockSide) + 0.5F - search.vx[i],
                             static_cast<float>(y + i / kBlockSide) + 0.5F - search.vy[i]};
            if (nearest.distance[i] < kInfinity && map_.marked(foot)) {
                nearest.distance[i] = kInfinity;
            }
        }
    }
    nearest.t = search.t;
    return std::ranges::any_of(nearest.distance, [](float d) { return d < kInfinity; });
}

/// Those of a large face that matter to a block.
std::span<const ScreenEdge> FaceEdges::near_edges(std::span<const ScreenEdge> edges, int x, int y,
                                                  float reach) {
    near_.clear();
    const Vec2f middle{static_cast<float>(x) + 0.5F * kBlockSide,
                       static_cast<float>(y) + 0.5F * kBlockSide};
    const float most = reach + 0.5F * kBlockSide * std::numbers::sqrt2_v<float>;
    for (const ScreenEdge& edge : edges) {
        const Vec2f r = middle - edge.a;
        const Vec2f v = r - edge.along * std::clamp(dot(r, edge.along), 0.0F, edge.length);
        if (dot(v, v) <= most * most) near_.push_back(edge);
    }
    return near_;
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
std::span<const ScreenEdge> FaceEdges::edges_of(std::uint32_t first, const Mesh& mesh,
                                                TriangleRange triangles) {
    if (2 * faces_ >= table_.size()) grow();
    Face& face = table_[place_of(first)];
    if (face.key == FaceMap::kNone) {
        const std::size_t begin = edges_.size();
        add_edges(mesh, triangles);
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
void FaceEdges::add_edges(const Mesh& mesh, TriangleRange triangles) {
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
            projected[k] = project(to_double(mesh.vertices[corners[k]]));
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

FaceEdges::Corner FaceEdges::project(const Vec3d& position) const {
    const Projection& p = projection_;
    const Vec3d v = position - p.start;
    const double depth = dot(v, p.forward);
    const double width = p.origin_step + depth * p.slope_step;
    const double scale = 1.0 / width;
    return {position,
            {dot(v, p.right) * scale + static_cast<double>(p.centre.x),
             dot(v, p.down) * scale + static_cast<double>(p.centre.y)},
            depth,
            width};
}

void FaceEdges::add_edge(Corner a, Corner b) {
    const double least = kNearest * std::max(a.width, b.width);
    if (least <= 0.0) return;  // behind the eye
    if (a.width < least || b.width < least) {
        const bool a_is_near = a.width < b.width;
        Corner& near = a_is_near ? a : b;
        const Corner& far = a_is_near ? b : a;
        const double way = (least - near.width) / (far.width - near.width);
        near = project(near.position + (far.position - near.position) * way);
    }
    const Vec2d d = b.point - a.point;
    const double length = ink::length(d);
    const Vec2d along = length > 0.0 ? d * (1.0 / length) : Vec2d{1.0, 0.0};
    const Vec2d off = (a.point + b.point) * 0.5 - to_double(projection_.centre);
    const double step = projection_.slope_step;
    const double t = 0.5 * (a.depth + b.depth) * std::sqrt(1.0 + step * step * dot(off, off));
    edges_.push_back(
        {to_float(a.point), to_float(along), static_cast<float>(length), static_cast<float>(t)});
}

}  // namespace ink
