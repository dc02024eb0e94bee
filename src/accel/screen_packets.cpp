#include "accel/screen_packets.h"

#include <limits>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/screen_packets.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "accel/screen_forms-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

void prepare_boxes(Basis basis, const BoxLanes& boxes, BoundsPacket& packet) {
    for (int i = 0; i < kLanes; i += kStep) {
        const Triple lower = load(boxes.lower, i);
        const Triple upper = load(boxes.upper, i);
        CornerBounds bounds = CornerBounds::none();
        for (int corner = 0; corner < 8; ++corner) {
            const Triple p = to_camera(basis, {(corner & 1) != 0 ? upper.x : lower.x,
                                               (corner & 2) != 0 ? upper.y : lower.y,
                                               (corner & 4) != 0 ? upper.z : lower.z});
            bounds.add(p, pixel_at(basis, p.z));
        }
        bounds.put(i, packet);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(prepare_boxes);

namespace {

void empty_unused(std::size_t used, BoundsPacket& bounds) {
    for (std::size_t i = used; i < kLanes; ++i) {
        bounds.left[static_cast<int>(i)] = std::numeric_limits<float>::infinity();
    }
}

}  // namespace

Basis::Basis(const Projection& p)
    : rx(p.right.x),
      ry(p.right.y),
      rz(p.right.z),
      dx(p.down.x),
      dy(p.down.y),
      dz(p.down.z),
      fx(p.forward.x),
      fy(p.forward.y),
      fz(p.forward.z),
      sx(p.start.x),
      sy(p.start.y),
      sz(p.start.z),
      start_depth(p.start_depth),
      origin_step(p.origin_step),
      slope_step(p.slope_step),
      orthographic(p.orthographic()) {}

BoundsPacket BoundsPacket::none() {
    BoundsPacket bounds{};
    bounds.left.fill(std::numeric_limits<float>::infinity());
    return bounds;
}

namespace {

/// Primitives of a kind that has copies, where the cluster's copy is.
template <class PartLanes>
void prepare_copy(const Basis& basis, const Clusters& clusters, const Cluster& cluster,
                  const PartLanes& lanes, ScreenPacket& packet) {
    if (cluster.copy == kNoCopy) return prepare(basis, lanes, packet);
    prepare(basis, moved(lanes, clusters.copies[cluster.copy].motion), packet);
}

void prepare_triangles(const Basis& basis, const Clusters& clusters, const Cluster& cluster,
                       ScreenPacket& packet, PacketShades* shades) {
    const TriangleLanes& triangles = clusters.triangles[cluster.packet];
    ScreenCorners corners;
    prepare(basis, triangles, packet, corners);
    packet.has_hit_numbers = shades == nullptr;
    if (shades == nullptr) return record_hits(triangles, packet);
    const bool smooth = clusters.has_normals[cluster.object] != 0;
    prepare_shades(basis, triangles, corners,
                   smooth ? &clusters.corner_normals[cluster.packet] : nullptr, packet, *shades);
}

}  // namespace

void prepare(const Basis& basis, const Clusters& clusters, const Cluster& cluster,
             ScreenPacket& packet, PacketShades* shades) {
    packet.object = cluster.object;
    packet.kind = cluster.kind;
    packet.has_hit_numbers = true;
    const std::uint32_t first =
        cluster.copy == kNoCopy ? 0 : clusters.copies[cluster.copy].first_primitive;
    for (int lane = 0; lane < cluster.count; ++lane) {
        packet.primitive[lane] =
            first + clusters.order[cluster.first + static_cast<std::uint32_t>(lane)];
    }
    switch (cluster.kind) {
        case ClusterKind::spheres:
            prepare_copy(basis, clusters, cluster, clusters.spheres[cluster.packet], packet);
            break;
        case ClusterKind::triangles:
            prepare_triangles(basis, clusters, cluster, packet, shades);
            break;
        case ClusterKind::solids: prepare(basis, clusters.solids[cluster.packet], packet); break;
        case ClusterKind::glyphs:
            packet.shape = clusters.unit_shapes[cluster.object];
            prepare_copy(basis, clusters, cluster, clusters.glyphs[cluster.packet], packet);
            break;
    }
    empty_unused(cluster.count, packet.bounds);
}

void prefetch(const Clusters& clusters, std::uint32_t cluster, bool shades) {
    const auto ask = [](const auto& lanes) {
        constexpr std::size_t kLine = 64;
        const auto* bytes = reinterpret_cast<const char*>(&lanes);
        for (std::size_t at = 0; at < sizeof(lanes); at += kLine) __builtin_prefetch(bytes + at);
    };
    const Cluster& own = clusters.clusters[cluster];
    // They may lie on two cache lines.
    __builtin_prefetch(&clusters.order[own.first]);
    __builtin_prefetch(&clusters.order[own.first + own.count - 1U]);
    switch (own.kind) {
        case ClusterKind::spheres: return ask(clusters.spheres[own.packet]);
        case ClusterKind::triangles:
            if (shades && clusters.has_normals[own.object] != 0) {
                ask(clusters.corner_normals[own.packet]);
            }
            return ask(clusters.triangles[own.packet]);
        case ClusterKind::solids: return ask(clusters.solids[own.packet]);
        case ClusterKind::glyphs: return ask(clusters.glyphs[own.packet]);
    }
}

void prepare(const Basis& basis, const BoxLanes& boxes, std::size_t used, BoundsPacket& packet) {
    HWY_DYNAMIC_DISPATCH(prepare_boxes)(basis, boxes, packet);
    empty_unused(used, packet);
}

}  // namespace ink

#endif
