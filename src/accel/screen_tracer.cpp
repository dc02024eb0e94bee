#include "accel/screen_tracer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "accel/screen_kernels.h"
#include "accel/screen_packets.h"
#include "base/parallel.h"

namespace ink {

namespace {

/// Screen bounds of all clusters, sixteen a packet, and above them levels of packets whose lanes
/// bound a packet of the level below each. The last level is a single packet.
class BoundsPyramid {
  public:
    BoundsPyramid(const Clusters& clusters, const Projection& projection, int threads);

    /// Calls `found(cluster, depth)` for each cluster that reaches into the window.
    template <class Found>
    void search(const Window& window, const Found& found) const {
        if (!levels_.empty()) search(levels_.size() - 1, 0, window, found);
    }

    void copy(std::uint32_t cluster, BoundsPacket& to, int lane) const {
        const BoundsPacket& from = levels_[0][cluster / kLanes];
        const int own = static_cast<int>(cluster % kLanes);
        to.left[lane] = from.left[own];
        to.right[lane] = from.right[own];
        to.top[lane] = from.top[own];
        to.bottom[lane] = from.bottom[own];
        to.depth[lane] = from.depth[own];
    }

  private:
    template <class Found>
    void search(std::size_t level, std::size_t packet, const Window& window,
                const Found& found) const {
        const BoundsPacket& bounds = levels_[level][packet];
        for (LaneBits lanes = overlap(bounds, window); lanes != 0; lanes &= lanes - 1) {
            const int lane = std::countr_zero(lanes);
            const std::size_t child = packet * kLanes + static_cast<std::size_t>(lane);
            if (level == 0) {
                found(static_cast<std::uint32_t>(child), bounds.depth[lane]);
            } else {
                search(level - 1, child, window, found);
            }
        }
    }

    std::vector<std::vector<BoundsPacket>> levels_;
};

std::size_t packets_for(std::size_t count) { return (count + kLanes - 1) / kLanes; }

void set_union(const BoundsPacket& of, BoundsPacket& packet, int lane) {
    packet.left[lane] = *std::ranges::min_element(of.left);
    packet.top[lane] = *std::ranges::min_element(of.top);
    packet.right[lane] = *std::ranges::max_element(of.right);
    packet.bottom[lane] = *std::ranges::max_element(of.bottom);
    packet.depth[lane] = *std::ranges::min_element(of.depth);
}

BoundsPyramid::BoundsPyramid(const Clusters& clusters, const Projection& projection, int threads) {
    const std::size_t count = clusters.clusters.size();
    if (count == 0) return;
    levels_.emplace_back(packets_for(count));
    constexpr std::size_t kChunk = 256;  // packets that a thread does in one go
    const auto for_packets = [&](std::vector<BoundsPacket>& level, const auto& body) {
        parallel_for((level.size() + kChunk - 1) / kChunk, threads,
                     [&](std::size_t i, std::size_t) {
                         for (std::size_t k = i * kChunk;
                              k < std::min((i + 1) * kChunk, level.size()); ++k) {
                             body(k, level[k]);
                         }
                     });
    };
    for_packets(levels_[0], [&](std::size_t k, BoundsPacket& packet) {
        const std::size_t first = k * kLanes;
        const std::size_t used = std::min<std::size_t>(kLanes, count - first);
        std::array<Bounds3f, kLanes> boxes;
        for (std::size_t i = 0; i < used; ++i) boxes[i] = clusters.clusters[first + i].bounds;
        prepare(projection, std::span(boxes).first(used), packet);
    });
    while (levels_.back().size() > 1) {
        std::vector<BoundsPacket> above(packets_for(levels_.back().size()));
        const std::vector<BoundsPacket>& below = levels_.back();
        for_packets(above, [&](std::size_t k, BoundsPacket& packet) {
            packet = BoundsPacket::none();
            for (std::size_t i = k * kLanes; i < std::min((k + 1) * kLanes, below.size()); ++i) {
                set_union(below[i], packet, static_cast<int>(i % kLanes));
            }
        });
        levels_.push_back(std::move(above));
    }
}

/// What all tiles share.
struct View {
    const Clusters& clusters;
    Projection projection;
    BoundsPyramid pyramid;

    Window window(const ScreenBox& box) const {
        const Vec2f centre = projection.centre;
        return {box.left - centre.x, box.right - centre.x, box.top - centre.y,
                box.bottom - centre.y, kInfinity};
    }
};

/// Where surfaces of several objects coincide, rounding would choose between them anew at every
/// pixel. So each object lies a hair behind the one before it: enough to outweigh rounding, in a
/// scene of size 1, and less than the thousandth of a pixel of a large picture. After so many
/// objects it begins anew.
constexpr float kSetBack = 1e-6F;
constexpr std::uint32_t kSetBacks = 16;

void set_back(float by, SpherePacket& packet) {
    for (SphereForm& form : packet.forms) form.z += by;
}

void set_back(float by, TrianglePacket& packet) {
    for (TriangleForm& form : packet.forms) {
        form.z += by;
        form.far += by;
    }
}

class ScreenTileTracer final : public TileTracer {
  public:
    explicit ScreenTileTracer(const View& view) : view_(view) {}

    void enter(const ScreenBox& area) override;
    void intersect(std::span<const PointPacket> points, std::span<const RayPacket> rays,
                   std::span<HitPacket> hits) override;
    void identify(std::span<const PointPacket> points, std::span<const RayPacket> rays,
                  std::span<HitPacket> hits) override;
    bool needs_rays() const override { return false; }
    bool reaches(const ScreenBox& box) const override;

  private:
    /// A cluster that reaches into the area.
    struct Candidate {
        float depth;
        std::uint32_t cluster;
        std::uint32_t packet = kNotYet;  ///< index into the packets of its kind
        std::uint32_t first_record = 0;
    };
    static constexpr std::uint32_t kNotYet = 0xFFFFFFFFU;

    void find_front(Front& front);
    void test(std::size_t i, Front& front);
    template <class PrimitiveLanes, class Packet>
    void test(const PrimitiveLanes& primitives, const Cluster& cluster, std::size_t i,
              std::vector<Packet>& packets, std::uint32_t& used, Front& front);

    const View& view_;
    std::vector<Candidate> candidates_;  ///< nearest first
    std::vector<BoundsPacket> bounds_;   ///< of the candidates
    // What is made of a candidate when a ray first comes near. Vectors keep their size from area to
    // area; the counts say how much of them is in use.
    std::vector<SpherePacket> spheres_;
    std::vector<TrianglePacket> triangles_;
    std::vector<HitRecord> records_;
    std::uint32_t spheres_used_ = 0, triangles_used_ = 0, records_used_ = 0;
};

void ScreenTileTracer::enter(const ScreenBox& area) {
    const Window window = view_.window(area);
    candidates_.clear();
    spheres_used_ = 0;
    triangles_used_ = 0;
    records_used_ = 0;
    view_.pyramid.search(window, [&](std::uint32_t cluster, float depth) {
        candidates_.push_back({depth, cluster});
    });
    std::ranges::sort(candidates_, [](const Candidate& a, const Candidate& b) {
        return a.depth != b.depth ? a.depth < b.depth : a.cluster < b.cluster;
    });
    bounds_.assign(packets_for(candidates_.size()), BoundsPacket::none());
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
        view_.pyramid.copy(candidates_[i].cluster, bounds_[i / kLanes],
                           static_cast<int>(i % kLanes));
    }
}

void ScreenTileTracer::intersect(std::span<const PointPacket> points,
                                 std::span<const RayPacket> rays, std::span<HitPacket> hits) {
    Front front;
    for (std::size_t k = 0; k < points.size(); ++k) {
        front.start(view_.projection, points[k]);
        find_front(front);
        resolve(front, rays[k], records_.data(), hits[k]);
    }
}

void ScreenTileTracer::identify(std::span<const PointPacket> points,
                                std::span<const RayPacket> /*rays*/, std::span<HitPacket> hits) {
    Front front;
    for (std::size_t k = 0; k < points.size(); ++k) {
        front.start(view_.projection, points[k]);
        find_front(front);
        ink::identify(front, records_.data(), hits[k]);
    }
}

bool ScreenTileTracer::reaches(const ScreenBox& box) const {
    const Window window = view_.window(box);
    return std::ranges::any_of(
        bounds_, [&](const BoundsPacket& bounds) { return overlap(bounds, window) != 0; });
}

void ScreenTileTracer::find_front(Front& front) {
    for (std::size_t k = 0; k < bounds_.size(); ++k) {
        if (!(candidates_[k * kLanes].depth < front.window.farthest)) return;
        for (LaneBits lanes = overlap(bounds_[k], front.window); lanes != 0; lanes &= lanes - 1) {
            const int lane = std::countr_zero(lanes);
            const std::size_t i = k * kLanes + static_cast<std::size_t>(lane);
            if (!(candidates_[i].depth < front.window.farthest)) return;
            test(i, front);
        }
    }
}

void ScreenTileTracer::test(std::size_t i, Front& front) {
    const Clusters& clusters = view_.clusters;
    const Cluster& cluster = clusters.clusters[candidates_[i].cluster];
    if (cluster.kind == ClusterKind::spheres) {
        test(clusters.spheres[cluster.packet], cluster, i, spheres_, spheres_used_, front);
    } else {
        test(clusters.triangles[cluster.packet], cluster, i, triangles_, triangles_used_, front);
    }
}

template <class PrimitiveLanes, class Packet>
void ScreenTileTracer::test(const PrimitiveLanes& primitives, const Cluster& cluster, std::size_t i,
                            std::vector<Packet>& packets, std::uint32_t& used, Front& front) {
    Candidate& candidate = candidates_[i];
    if (candidate.packet == kNotYet) {
        if (used == packets.size()) packets.emplace_back();
        if (records_used_ == records_.size()) records_.resize(records_.size() + kLanes);
        candidate.packet = used++;
        candidate.first_record = records_used_;
        records_used_ += kLanes;
        prepare(view_.projection, primitives, cluster.object,
                std::span(view_.clusters.order).subspan(cluster.first, cluster.count),
                packets[candidate.packet], records_.data() + candidate.first_record);
        // Closer than those of the cluster's box.
        set_union(packets[candidate.packet].bounds, bounds_[i / kLanes],
                  static_cast<int>(i % kLanes));
        set_back(kSetBack * static_cast<float>(cluster.object % kSetBacks),
                 packets[candidate.packet]);
    }
    ink::intersect(view_.projection, packets[candidate.packet], candidate.first_record, front);
}

class ScreenFrameTracer final : public FrameTracer {
  public:
    ScreenFrameTracer(const Clusters& clusters, const Projection& projection, int threads)
        : view_{clusters, projection, BoundsPyramid(clusters, projection, threads)} {}

    std::unique_ptr<TileTracer> tile_tracer() const override {
        return std::make_unique<ScreenTileTracer>(view_);
    }

  private:
    View view_;
};

}  // namespace

std::unique_ptr<FrameTracer> make_screen_tracer(const Clusters& clusters,
                                                const Projection& projection, int threads) {
    return std::make_unique<ScreenFrameTracer>(clusters, projection, threads);
}

}  // namespace ink
