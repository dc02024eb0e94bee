#include "accel/clusters.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <variant>

#include "base/parallel.h"

namespace ink {

namespace {

constexpr std::size_t kGrain = 1 << 14;

/// Every third bit of the result is one of the 21 low bits of `v`.
std::uint64_t spread(std::uint64_t v) {
    v = (v | v << 32U) & 0x001F00000000FFFFU;
    v = (v | v << 16U) & 0x001F0000FF0000FFU;
    v = (v | v << 8U) & 0x100F00F00F00F00FU;
    v = (v | v << 4U) & 0x10C30C30C30C30C3U;
    return (v | v << 2U) & 0x1249249249249249U;
}

/// Scene coordinates lie within [-1, 1].
std::uint64_t morton_code(Vec3f p) {
    const auto cell = [](float v) {
        constexpr float kCells = 1 << 21;
        const float place = std::max(0.0F, (v + 1.0F) * 0.5F * kCells);  // of no number, zero
        return static_cast<std::uint64_t>(std::min(place, kCells - 1.0F));
    };
    return spread(cell(p.x)) | spread(cell(p.y)) << 1U | spread(cell(p.z)) << 2U;
}

void put(Points& points, int lane, Vec3f p) {
    points.x[lane] = p.x;
    points.y[lane] = p.y;
    points.z[lane] = p.z;
}

void put(TriangleLanes& lanes, int lane, Vec3f a, Vec3f b, Vec3f c) {
    put(lanes.a, lane, a);
    put(lanes.b, lane, b);
    put(lanes.c, lane, c);
}

// What is sorted into clusters: its parts, their bounds, the primitive that each belongs to, and
// how they lie side by side.

struct SphereParts {
    const Spheres& shape;
    static constexpr ClusterKind kKind = ClusterKind::spheres;

    std::size_t count() const { return shape.spheres.size(); }
    std::uint32_t primitive(std::uint32_t i) const { return i; }
    Bounds3f bounds(std::size_t i, std::size_t copy = 0) const {
        Bounds3f bounds;
        const Sphere sphere = shape.at(copy * shape.spheres.size() + i);
        bounds.add(sphere.centre, sphere.radius);
        return bounds;
    }
    void put(std::uint32_t i, int lane, SphereLanes& lanes) const {
        ink::put(lanes.centre, lane, shape.spheres[i].centre);
        lanes.radius[lane] = shape.spheres[i].radius;
    }
};

struct TriangleParts {
    const Mesh& mesh;
    static constexpr ClusterKind kKind = ClusterKind::triangles;

    std::size_t count() const { return mesh.triangles.size(); }
    std::uint32_t primitive(std::uint32_t i) const { return i; }
    Bounds3f bounds(std::size_t i) const {
        Bounds3f bounds;
        for (const std::uint32_t corner : mesh.triangles[i]) bounds.add(mesh.vertices[corner]);
        return bounds;
    }
    void put(std::uint32_t i, int lane, TriangleLanes& lanes) const {
        const auto& [a, b, c] = mesh.triangles[i];
        ink::put(lanes, lane, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
    }
};

struct SolidParts {
    const Hexahedra& shape;
    static constexpr ClusterKind kKind = ClusterKind::solids;
    static constexpr std::uint32_t kParts = 12;  ///< triangles of a hexahedron

    std::size_t count() const { return shape.corners.size() * kParts; }
    std::uint32_t primitive(std::uint32_t i) const { return i / kParts; }
    std::array<Vec3f, 3> triangle(std::size_t i) const {
        const Hexahedra::Corners& corners = shape.corners[i / kParts];
        const auto& [a, b, c, d] = Hexahedra::kFaces[i % kParts / 2];
        if (i % 2 == 0) return {corners[a], corners[b], corners[c]};
        return {corners[a], corners[c], corners[d]};
    }
    Bounds3f bounds(std::size_t i) const {
        Bounds3f bounds;
        for (const Vec3f corner : triangle(i)) bounds.add(corner);
        return bounds;
    }
    void put(std::uint32_t i, int lane, SolidLanes& lanes) const {
        const auto [p, q, r] = triangle(i);
        ink::put(lanes.triangles, lane, p, q, r);
        const Hexahedra::Corners& corners = shape.corners[i / kParts];
        const auto& [a, b, c, d] = Hexahedra::kFaces[i % kParts / 2];
        ink::put(lanes.normal, lane,
                 to_float(cross(to_double(corners[c]) - to_double(corners[a]),
                                to_double(corners[d]) - to_double(corners[b]))));
    }
};

struct GlyphParts {
    const Glyphs& shape;
    static constexpr ClusterKind kKind = ClusterKind::glyphs;

    std::size_t count() const { return shape.placements.size(); }
    std::uint32_t primitive(std::uint32_t i) const { return i; }
    Bounds3f bounds(std::size_t i, std::size_t copy = 0) const {
        return glyph_bounds(shape.shape, shape.at(copy * shape.placements.size() + i));
    }
    void put(std::uint32_t i, int lane, GlyphLanes& lanes) const {
        const Placement& placement = shape.placements[i];
        ink::put(lanes.origin, lane, placement.origin);
        ink::put(lanes.x_axis, lane, placement.x_axis);
        ink::put(lanes.y_axis, lane, placement.y_axis);
        ink::put(lanes.z_axis, lane, placement.z_axis);
    }
};

void put(BoxLanes& lanes, int lane, const Bounds3f& box) {
    put(lanes.lower, lane, box.lower);
    put(lanes.upper, lane, box.upper);
}

Bounds3f union_of(const BoxLanes& boxes) {
    const auto least = [](const Lanes<float>& v) { return *std::ranges::min_element(v); };
    const auto most = [](const Lanes<float>& v) { return *std::ranges::max_element(v); };
    return {{least(boxes.lower.x), least(boxes.lower.y), least(boxes.lower.z)},
            {most(boxes.upper.x), most(boxes.upper.y), most(boxes.upper.z)}};
}

constexpr std::size_t packets_for(std::size_t count) { return (count + kLanes - 1) / kLanes; }

/// `bounds(i)` gives the boxes of a level; unused lanes repeat the last one.
template <class BoundsOf>
void add_level(std::size_t count, const BoundsOf& bounds, std::vector<Clusters::Level>& levels) {
    Clusters::Level level{std::vector<BoxLanes>(packets_for(count)), count};
    parallel_ranges(level.boxes.size(), kGrain / kLanes, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            for (int lane = 0; lane < kLanes; ++lane) {
                const std::size_t i = k * kLanes + static_cast<std::size_t>(lane);
                put(level.boxes[k], lane, bounds(std::min(i, count - 1)));
            }
        }
    });
    levels.push_back(std::move(level));
}

/// A primitive's place and number.
struct Placed {
    Vec3f centre;
    std::uint32_t number;
};

/// Brings primitives that are close together next to each other: halves them across the longest
/// side of their bounds, again and again, down to a cluster's.
void gather_neighbours(std::span<Placed> placed) {
    if (placed.size() <= kLanes) return;
    Bounds3f bounds;
    for (const Placed& one : placed) bounds.add(one.centre);
    const Vec3f size = bounds.upper - bounds.lower;
    const auto axis = size.x >= size.y && size.x >= size.z ? &Vec3f::x
                      : size.y >= size.z                   ? &Vec3f::y
                                                           : &Vec3f::z;
    const auto before = [axis](const Placed& a, const Placed& b) {
        const float at_a = a.centre.*axis;
        const float at_b = b.centre.*axis;
        return at_a < at_b || (at_a == at_b && a.number < b.number);
    };
    const std::size_t half = (packets_for(placed.size()) + 1) / 2 * kLanes;
    std::ranges::nth_element(placed, placed.begin() + static_cast<std::ptrdiff_t>(half), before);
    gather_neighbours(placed.first(half));
    gather_neighbours(placed.subspan(half));
}

using Keys = std::vector<std::pair<std::uint64_t, std::uint32_t>>;

/// Triangles by their keys, those of the same cluster close together: a curve that fills space
/// leaves a surface and comes back elsewhere, and puts into one cluster what it meets before and
/// after. So runs of it are divided anew. All triangles at once would take three times as long. Of
/// many millions, places come from memory, which takes as long as all else, and clusters are small
/// on the screen anyway.
template <class Parts>
void regroup(const Parts& parts, Keys& keys) {
    constexpr std::size_t kRun = 4096;
    constexpr std::size_t kMany = std::size_t{1} << 21U;
    if (keys.size() > kMany) return;
    const std::size_t runs = (keys.size() + kRun - 1) / kRun;
    parallel_ranges(runs, kGrain / kRun, [&](std::size_t begin, std::size_t end) {
        std::vector<Placed> placed;
        for (std::size_t run = begin; run < end; ++run) {
            const auto own =
                std::span(keys).subspan(run * kRun).first(std::min(kRun, keys.size() - run * kRun));
            placed.clear();
            for (const auto& [key, part] : own)
                placed.push_back({parts.bounds(part).centre(), part});
            gather_neighbours(placed);
            for (std::size_t k = 0; k < own.size(); ++k) own[k].second = placed[k].number;
        }
    });
}

template <class Parts, class PartLanes>
void append(const Parts& parts, std::uint32_t object, std::vector<PartLanes>& packets,
            Clusters& all, std::vector<Bounds3f>& boxes) {
    const std::size_t count = parts.count();
    Keys keys(count);
    parallel_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            keys[i] = {morton_code(parts.bounds(i).centre()), static_cast<std::uint32_t>(i)};
        }
    });
    parallel_sort(keys);
    if constexpr (Parts::kKind == ClusterKind::triangles) regroup(parts, keys);

    const std::size_t first = all.order.size();
    const std::size_t first_cluster = all.clusters.size();
    const std::size_t clusters = packets_for(count);
    all.order.resize(first + count);
    all.clusters.resize(first_cluster + clusters);
    boxes.resize(first_cluster + clusters);
    const std::size_t first_packet = packets.size();
    packets.resize(first_packet + clusters);
    parallel_ranges(clusters, kGrain / kLanes, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            const std::size_t from = c * kLanes;
            const std::size_t to = std::min(from + kLanes, count);
            all.clusters[first_cluster + c] = {object,
                                               static_cast<std::uint32_t>(first + from),
                                               static_cast<std::uint32_t>(first_packet + c),
                                               kNoCopy,
                                               static_cast<std::uint8_t>(to - from),
                                               Parts::kKind};
            for (int lane = 0; lane < kLanes; ++lane) {
                const std::size_t i = std::min(from + static_cast<std::size_t>(lane), to - 1);
                const std::uint32_t part = keys[i].second;
                all.order[first + i] = parts.primitive(part);
                boxes[first_cluster + c].add(parts.bounds(part));
                parts.put(part, lane, packets[first_packet + c]);
            }
        }
    });
}

/// The clusters of the primitives that were appended last become those of the first copy, and the
/// others follow.
template <class Parts>
void append_copies(const Parts& parts, Clusters& all, std::vector<Bounds3f>& boxes) {
    const std::vector<Copy>& copies = parts.shape.copies;
    if (copies.empty()) return;
    const std::size_t a_copy = packets_for(parts.count());
    const std::size_t first = all.clusters.size() - a_copy;
    const std::size_t first_copy = all.copies.size();
    for (std::size_t k = 0; k < copies.size(); ++k) {
        all.copies.push_back({copies[k].motion, static_cast<std::uint32_t>(k * parts.count())});
    }
    all.clusters.resize(first + a_copy * copies.size());
    boxes.resize(all.clusters.size());
    for (std::size_t c = 0; c < a_copy; ++c) {
        all.clusters[first + c].copy = static_cast<std::uint32_t>(first_copy);
    }
    parallel_ranges(
        a_copy * (copies.size() - 1), kGrain / kLanes, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                const std::size_t copy = 1 + k / a_copy;
                Cluster cluster = all.clusters[first + k % a_copy];
                cluster.copy = static_cast<std::uint32_t>(first_copy + copy);
                all.clusters[first + a_copy + k] = cluster;
                for (std::size_t i = 0; i < cluster.count; ++i) {
                    boxes[first + a_copy + k].add(parts.bounds(all.order[cluster.first + i], copy));
                }
            }
        });
}

/// The normals of the mesh whose clusters were appended last.
void append_normals(const Mesh& mesh, std::size_t first_cluster, Clusters& all) {
    if (mesh.corner_normals.empty()) return;
    all.has_normals[all.clusters[first_cluster].object] = 1;
    all.corner_normals.resize(all.triangles.size());
    const std::size_t count = all.clusters.size() - first_cluster;
    parallel_ranges(count, kGrain / kLanes, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            const Cluster& cluster = all.clusters[first_cluster + c];
            CornerNormals& normals = all.corner_normals[cluster.packet];
            for (int lane = 0; lane < kLanes; ++lane) {
                const int used = std::min(lane, cluster.count - 1);
                const auto& [at_a, at_b, at_c] =
                    mesh.corner_normals[all.order[cluster.first + static_cast<std::size_t>(used)]];
                normals.a[lane] = at_a;
                normals.b[lane] = at_b;
                normals.c[lane] = at_c;
            }
        }
    });
}

}  // namespace

bool has_screen_form(const Shape& shape) {
    const auto* glyphs = std::get_if<Glyphs>(&shape);
    if (glyphs == nullptr) return true;
    switch (glyphs->shape.kind) {
        case GlyphKind::ellipsoid:
        case GlyphKind::box:
        case GlyphKind::frustum:
        case GlyphKind::disc:
        case GlyphKind::rectangle: return true;
        case GlyphKind::torus:
        case GlyphKind::superellipsoid:
        case GlyphKind::gaussian:
        case GlyphKind::waves: return false;
    }
    return false;
}

SphereLanes moved(const SphereLanes& spheres, const Motion& motion) {
    SphereLanes out;
    out.radius = spheres.radius;
    for (int i = 0; i < kLanes; ++i) {
        const Vec3f p{spheres.centre.x[i], spheres.centre.y[i], spheres.centre.z[i]};
        put(out.centre, i, motion(p));
    }
    return out;
}

GlyphLanes moved(const GlyphLanes& glyphs, const Motion& motion) {
    const auto at = [](const Points& points, int i) {
        return Vec3f{points.x[i], points.y[i], points.z[i]};
    };
    GlyphLanes out;
    for (int i = 0; i < kLanes; ++i) {
        const Placement there = moved(Placement{at(glyphs.x_axis, i), at(glyphs.y_axis, i),
                                                at(glyphs.z_axis, i), at(glyphs.origin, i)},
                                      motion);
        put(out.x_axis, i, there.x_axis);
        put(out.y_axis, i, there.y_axis);
        put(out.z_axis, i, there.z_axis);
        put(out.origin, i, there.origin);
    }
    return out;
}

Clusters::Clusters(const Scene& scene)
    : unit_shapes(scene.objects().size()), has_normals(scene.objects().size()) {
    std::vector<Bounds3f> boxes;
    for (std::uint32_t i = 0; i < scene.objects().size(); ++i) {
        const Shape& shape = scene.objects()[i].shape;
        if (!has_screen_form(shape)) continue;
        if (const auto* balls = std::get_if<Spheres>(&shape)) {
            append(SphereParts{*balls}, i, spheres, *this, boxes);
            append_copies(SphereParts{*balls}, *this, boxes);
        } else if (const auto* mesh = std::get_if<Mesh>(&shape)) {
            const std::size_t first = clusters.size();
            append(TriangleParts{*mesh}, i, triangles, *this, boxes);
            append_normals(*mesh, first, *this);
        } else if (const auto* hexahedra = std::get_if<Hexahedra>(&shape)) {
            append(SolidParts{*hexahedra}, i, solids, *this, boxes);
        } else if (const auto* placed = std::get_if<Glyphs>(&shape)) {
            append(GlyphParts{*placed}, i, glyphs, *this, boxes);
            append_copies(GlyphParts{*placed}, *this, boxes);
            unit_shapes[i] = placed->shape;
        }
    }
    if (boxes.empty()) return;
    add_level(
        boxes.size(), [&](std::size_t i) { return boxes[i]; }, levels);
    while (levels.back().boxes.size() > 1) {
        const std::vector<BoxLanes>& below = levels.back().boxes;
        add_level(
            below.size(), [&](std::size_t i) { return union_of(below[i]); }, levels);
    }
}

}  // namespace ink
