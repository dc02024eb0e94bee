#include "render/face_edges.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

namespace ink {

namespace {

/// Parts of edges that are nearer to the eye than this, in widths of a pixel at the edge's farther
/// end, are left out.
constexpr float kNearest = 1e-3F;

std::uint64_t directed(std::uint32_t from, std::uint32_t to) {
    return static_cast<std::uint64_t>(from) << 32U | to;
}

}  // namespace

void FaceEdges::enter(const Tile& tile) {
    x0_ = tile.x0;
    y0_ = tile.y0;
    across_ = (tile.x1 - tile.x0 + kBlockSide - 1) / kBlockSide;
    list_triangles(tile);
    gather_faces();
}

void FaceEdges::list_triangles(const Tile& tile) {
    begins_.clear();
    listed_.clear();
    seen_.clear();
    std::ranges::fill(triangles_, Entry{});
    constexpr int kAhead = 3;  // rows of blocks: many of them see nothing and take no time
    for (int y = tile.y0; y < tile.y1; y += kBlockSide) {
        for (int x = tile.x0; x < tile.x1; x += kBlockSide) {
            map_.prefetch(x, y + kAhead * kBlockSide);
            const auto block = static_cast<std::uint32_t>(begins_.size());
            begins_.push_back(static_cast<std::uint32_t>(listed_.size()));
            const Lanes<std::uint32_t>& numbers = map_.triangles(x, y);
            std::uint32_t starts = find_starts(numbers, FaceMap::kNone);
            if (starts == 0) continue;
            make_room(triangles_, seen_.size() + kLanes);
            for (; starts != 0; starts &= starts - 1) {
                list(numbers[std::countr_zero(starts)], block);
            }
        }
    }
    begins_.push_back(static_cast<std::uint32_t>(listed_.size()));
}

/// Lists a triangle for a block, unless it is there already.
void FaceEdges::list(std::uint32_t number, std::uint32_t block) {
    Entry& place = entry(triangles_, number);
    if (place.key == FaceMap::kNone) {
        place = {number, static_cast<std::uint32_t>(seen_.size())};
        seen_.push_back({number, map_.triangle(number), block});
    } else if (std::exchange(seen_[place.value].listed_for, block) == block) {
        return;
    }
    listed_.push_back(place.value);
}

/// In passes that ask for much at a time and wait for it once.
void FaceEdges::gather_faces() {
    faces_.clear();
    edges_.clear();
    std::ranges::fill(polygons_, Entry{});
    for (Seen& seen : seen_) {
        seen.corners = map_.mesh(seen.triangle.object)->triangles[seen.triangle.primitive];
    }
    constexpr std::size_t kAhead = 8;
    for (std::size_t k = 0; k < seen_.size(); ++k) {
        if (k + kAhead < seen_.size()) prefetch(seen_[k + kAhead]);
        seen_[k].face = face_of(seen_[k]);
    }
    gathered_ = edges_.size();
}

void FaceEdges::prefetch(const Seen& seen) const {
    const Mesh& mesh = *map_.mesh(seen.triangle.object);
    const std::vector<ScreenPoint>& points = vertices_.of(seen.triangle.object);
    for (const std::uint32_t corner : seen.corners) {
        if (points.empty()) {
            __builtin_prefetch(&mesh.vertices[corner]);
        } else {
            __builtin_prefetch(&points[corner]);
        }
    }
    if (!mesh.edge_flags.empty()) __builtin_prefetch(&mesh.edge_flags[seen.triangle.primitive]);
}

/// Adds it, if it is not there yet.
std::uint32_t FaceEdges::face_of(const Seen& seen) {
    const auto next = static_cast<std::uint32_t>(faces_.size());
    const auto [object, primitive] = seen.triangle;
    const Mesh& mesh = *map_.mesh(object);
    const TriangleRange triangles = triangles_of(mesh, primitive);
    const std::uint32_t count = triangles.end - triangles.begin;
    const std::uint32_t begin = seen.number - (primitive - triangles.begin);  // over all meshes
    directed_.clear();
    if (count > 1) {
        make_room(polygons_, faces_.size() + 1);
        Entry& place = entry(polygons_, begin);
        if (place.key != FaceMap::kNone) return place.value;
        place = {begin, next};
        list_directed(mesh, triangles);
    }
    const auto first = static_cast<std::uint32_t>(edges_.size());
    if (count == 1) {
        add_edges(object, primitive, seen.corners);
    } else {
        for (std::uint32_t t = triangles.begin; t < triangles.end; ++t) {
            add_edges(object, t, mesh.triangles[t]);
        }
    }
    faces_.push_back(
        {begin, begin + count, first, static_cast<std::uint32_t>(edges_.size()) - first});
    return next;
}

TriangleRange FaceEdges::triangles_of(const Mesh& mesh, std::uint32_t triangle) {
    TriangleRange range{triangle, triangle + 1};
    if (mesh.faces.empty()) return range;
    const std::uint32_t face = mesh.faces[triangle];
    while (range.begin > 0 && mesh.faces[range.begin - 1] == face) --range.begin;
    while (range.end < mesh.faces.size() && mesh.faces[range.end] == face) ++range.end;
    return range;
}

/// Edges within a face are there twice, in both directions.
void FaceEdges::list_directed(const Mesh& mesh, TriangleRange triangles) {
    for (std::uint32_t t = triangles.begin; t < triangles.end; ++t) {
        const Mesh::Triangle& corners = mesh.triangles[t];
        for (std::size_t k = 0; k < 3; ++k) {
            directed_.push_back(directed(corners[k], corners[(k + 1) % 3]));
        }
    }
    std::ranges::sort(directed_);
}

/// Those edges of a triangle that bound its face, but not the open ones, which have lines of their
/// own.
void FaceEdges::add_edges(std::uint32_t object, std::uint32_t triangle,
                          const Mesh::Triangle& corners) {
    const Mesh& mesh = *map_.mesh(object);
    const std::vector<ScreenPoint>& points = vertices_.of(object);
    std::array<Corner, 3> projected;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t vertex = corners[k];
        projected[k] = {vertex, points.empty()
                                    ? project(projection_, to_double(mesh.vertices[vertex]))
                                    : points[vertex]};
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        const std::uint32_t from = corners[k];
        const std::uint32_t to = corners[next];
        if (!mesh.edge_flags.empty() && mesh.is_boundary(triangle, k)) continue;
        if (!directed_.empty() && std::ranges::binary_search(directed_, directed(to, from))) {
            continue;
        }
        // The two faces of an edge must agree on where it is, to the last bit.
        if (from < to) {
            add_edge(mesh, projected[k], projected[next]);
        } else {
            add_edge(mesh, projected[next], projected[k]);
        }
    }
}

void FaceEdges::add_edge(const Mesh& mesh, Corner a, Corner b) {
    const float least = kNearest * std::max(a.seen.width, b.seen.width);
    if (least <= 0.0F) return;  // behind the eye
    if (a.seen.width < least || b.seen.width < least) {
        const bool a_is_near = a.seen.width < b.seen.width;
        Corner& near = a_is_near ? a : b;
        const Corner& far = a_is_near ? b : a;
        const double way = static_cast<double>(least - near.seen.width) /
                           static_cast<double>(far.seen.width - near.seen.width);
        const Vec3d from = to_double(mesh.vertices[near.vertex]);
        const Vec3d to = to_double(mesh.vertices[far.vertex]);
        near.seen = project(projection_, from + (to - from) * way);
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

/// Where a key is in a table, or is to be put.
FaceEdges::Entry& FaceEdges::entry(Table& table, std::uint32_t key) {
    const std::size_t mask = table.size() - 1;
    std::size_t place = (key * 0x9E3779B97F4A7C15U >> 32U) & mask;
    while (table[place].key != FaceMap::kNone && table[place].key != key) {
        place = (place + 1) & mask;
    }
    return table[place];
}

/// Keeps half of a table free.
void FaceEdges::make_room(Table& table, std::size_t count) {
    constexpr std::size_t kLeast = 2048;
    while (2 * count > table.size()) {
        Table old(std::max(2 * table.size(), kLeast));
        old.swap(table);
        for (const Entry& one : old) {
            if (one.key != FaceMap::kNone) entry(table, one.key) = one;
        }
    }
}

bool FaceEdges::measure(int x, int y, float reach, NearestEdges& nearest) {
    const std::size_t block = block_at(x, y);
    const auto listed =
        std::span(listed_).subspan(begins_[block], begins_[block + 1] - begins_[block]);
    if (listed.empty()) return false;
    here_.clear();
    edges_.resize(gathered_);
    std::uint32_t count = 0;
    for (const std::uint32_t k : listed) {
        SeenFace face = faces_[seen_[k].face];
        const auto is_same = [&](const SeenFace& other) { return other.begin == face.begin; };
        if (face.end - face.begin > 1 && std::ranges::any_of(here_, is_same)) continue;
        if (face.count > 3) face = near_part(face, x, y, reach);
        here_.push_back(face);
        count += face.count;
    }
    if (count == 0) return false;
    nearest.triangle = map_.triangles(x, y);
    Lanes<float> vx;
    Lanes<float> vy;
    find_nearest(edges_, here_, static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F, reach,
                 nearest, vx, vy);
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
SeenFace FaceEdges::near_part(SeenFace face, int x, int y, float reach) {
    const Vec2f middle{static_cast<float>(x) + 0.5F * kBlockSide,
                       static_cast<float>(y) + 0.5F * kBlockSide};
    const float most = reach + 0.5F * kBlockSide * std::numbers::sqrt2_v<float>;
    const auto first = static_cast<std::uint32_t>(edges_.size());
    for (std::uint32_t k = face.first; k < face.first + face.count; ++k) {
        const ScreenEdge edge = edges_[k];
        const Vec2f r = middle - edge.a;
        const Vec2f v = r - edge.along * std::clamp(dot(r, edge.along), 0.0F, edge.length);
        if (dot(v, v) <= most * most) edges_.push_back(edge);
    }
    face.first = first;
    face.count = static_cast<std::uint32_t>(edges_.size()) - first;
    return face;
}

}  // namespace ink
