#include "accel/clusters.h"

#include <algorithm>
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
        return static_cast<std::uint64_t>(
            std::clamp((v + 1.0F) * 0.5F * kCells, 0.0F, kCells - 1.0F));
    };
    return spread(cell(p.x)) | spread(cell(p.y)) << 1U | spread(cell(p.z)) << 2U;
}

std::size_t count_of(const Spheres& shape) { return shape.spheres.size(); }
std::size_t count_of(const Mesh& shape) { return shape.triangles.size(); }

Bounds3f bounds_of(const Spheres& shape, std::size_t i) {
    Bounds3f bounds;
    bounds.add(shape.spheres[i].centre, shape.spheres[i].radius);
    return bounds;
}

Bounds3f bounds_of(const Mesh& shape, std::size_t i) {
    Bounds3f bounds;
    for (const std::uint32_t corner : shape.triangles[i]) bounds.add(shape.vertices[corner]);
    return bounds;
}

void put(Points& points, int lane, Vec3f p) {
    points.x[lane] = p.x;
    points.y[lane] = p.y;
    points.z[lane] = p.z;
}

void put(const Spheres& shape, std::uint32_t i, int lane, SphereLanes& lanes) {
    put(lanes.centre, lane, shape.spheres[i].centre);
    lanes.radius[lane] = shape.spheres[i].radius;
}

void put(const Mesh& shape, std::uint32_t i, int lane, TriangleLanes& lanes) {
    const auto& [a, b, c] = shape.triangles[i];
    put(lanes.a, lane, shape.vertices[a]);
    put(lanes.b, lane, shape.vertices[b]);
    put(lanes.c, lane, shape.vertices[c]);
}

constexpr ClusterKind kind_of(const Spheres& /*shape*/) { return ClusterKind::spheres; }
constexpr ClusterKind kind_of(const Mesh& /*shape*/) { return ClusterKind::triangles; }

template <class Primitives, class PrimitiveLanes>
void append(const Primitives& shape, std::uint32_t object, std::vector<PrimitiveLanes>& packets,
            Clusters& all) {
    const std::size_t count = count_of(shape);
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(count);
    parallel_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            keys[i] = {morton_code(bounds_of(shape, i).centre()), static_cast<std::uint32_t>(i)};
        }
    });
    parallel_sort(keys);

    const std::size_t first = all.order.size();
    const std::size_t first_cluster = all.clusters.size();
    const std::size_t clusters = (count + kLanes - 1) / kLanes;
    all.order.resize(first + count);
    all.clusters.resize(first_cluster + clusters);
    const std::size_t first_packet = packets.size();
    packets.resize(first_packet + clusters);
    parallel_ranges(clusters, kGrain / kLanes, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            Cluster& cluster = all.clusters[first_cluster + c];
            const std::size_t from = c * kLanes;
            const std::size_t to = std::min(from + kLanes, count);
            cluster.object = object;
            cluster.first = static_cast<std::uint32_t>(first + from);
            cluster.packet = static_cast<std::uint32_t>(first_packet + c);
            cluster.count = static_cast<std::uint8_t>(to - from);
            cluster.kind = kind_of(shape);
            for (int lane = 0; lane < kLanes; ++lane) {
                const std::size_t i = std::min(from + static_cast<std::size_t>(lane), to - 1);
                all.order[first + i] = keys[i].second;
                cluster.bounds.add(bounds_of(shape, keys[i].second));
                put(shape, keys[i].second, lane, packets[first_packet + c]);
            }
        }
    });
}

}  // namespace

Clusters::Clusters(const Scene& scene) {
    for (std::uint32_t i = 0; i < scene.objects().size(); ++i) {
        const Shape& shape = scene.objects()[i].shape;
        if (const auto* balls = std::get_if<Spheres>(&shape)) append(*balls, i, spheres, *this);
        if (const auto* mesh = std::get_if<Mesh>(&shape)) append(*mesh, i, triangles, *this);
    }
}

}  // namespace ink
