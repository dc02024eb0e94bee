#include "accel/screen_tracer.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <optional>
#include <vector>

#include "accel/bounds_pyramid.h"
#include "accel/candidates.h"
#include "accel/cluster_bands.h"
#include "accel/packet_store.h"
#include "accel/screen_kernels.h"
#include "accel/screen_packets.h"
#include "accel/sphere_range.h"
#include "base/parallel.h"

namespace ink {

namespace {

/// What all tiles share.
struct View {
    View(const Clusters& all, const Projection& seen_by)
        : clusters(all), projection(seen_by), basis(seen_by), pyramid(all, basis) {
        const std::size_t count = all.clusters.size();
        triangles = static_cast<std::size_t>(std::ranges::count(
            all.clusters, ClusterKind::triangles, [](const Cluster& one) { return one.kind; }));
        if (count > 0 && count <= ClusterBands::kMost) {
            bands.emplace(pyramid, count, seen_by.centre);
        }
    }

    const Clusters& clusters;
    Projection projection;
    Basis basis;
    BoundsPyramid pyramid;
    std::optional<ClusterBands> bands;  ///< if there are not too many clusters
    std::size_t triangles = 0;          ///< clusters of them

    bool triangles_only() const { return triangles == clusters.clusters.size(); }

    Window window(const ScreenBox& box) const {
        const Vec2f centre = projection.centre;
        return {box.left - centre.x, box.right - centre.x, box.top - centre.y,
                box.bottom - centre.y, kInfinity};
    }
};

/// What tracing a part of the screen took.
struct ScreenEffort {
    std::uint32_t clusters = 0;  ///< that were turned into screen form
    std::uint32_t hits = 0;
};

class ScreenTileTracer final : public TileTracer {
  public:
    explicit ScreenTileTracer(const View& view)
        : view_(view),
          candidates_(view.pyramid, view.bands ? &*view.bands : nullptr),
          store_(view.clusters, view.basis) {}

    void enter(const ScreenBox& area) override {
        candidates_.enter(view_.window(area));
        store_.enter();
        prepared_.clear();
        used_ = 0;
    }
    void intersect(std::span<const PointPacket> points, std::span<const RayPacket> rays,
                   std::span<HitPacket> hits) override;
    void find(const BlockRaster& raster, std::span<const PointPacket> points) override {
        start(raster, points);
        if (raster.packets > 0) find_fronts(lay_out(raster));
        for (std::size_t k = raster.packets; k < points.size(); ++k) find_front(fronts_[k]);
    }
    void resolve(std::size_t first, std::span<const PointPacket> points,
                 std::span<const RayPacket> rays, std::span<HitPacket> hits) override;
    void want_borders() override { store_.want_sides(); }
    void measure(std::size_t first, std::span<BorderPacket> borders) override {
        for (std::size_t k = 0; k < borders.size(); ++k) {
            ink::measure(fronts_[first + k], store_.packets(), store_.sides(), borders[k]);
        }
    }
    void want_shades() override {
        if (view_.triangles_only()) store_.want_shades();
    }
    void want_points_only() override { store_.want_points_only(); }
    void see(std::size_t first, std::span<HitPacket> hits, std::span<NormalPacket> normals,
             std::span<PlacePacket> places) override {
        const std::span<const Front> fronts = std::span(fronts_).subspan(first, hits.size());
        PlacePacket* const to = places.empty() ? nullptr : places.data();
        if (view_.triangles_only()) {
            ink::see(view_.basis, fronts, store_.shades(), hits.data(), normals.data(), to);
        } else {
            ink::see(view_.basis, fronts, store_.packets(), hits.data(), normals.data(), to);
        }
    }
    bool find_sides(std::size_t first, std::span<SidesPacket> sides) override {
        for (std::size_t k = 0; k < sides.size(); ++k) {
            ink::find_sides(fronts_[first + k], store_.packets(), sides[k]);
        }
        return true;
    }
    void identify(std::span<const PointPacket> points, std::span<const RayPacket> rays,
                  std::span<HitPacket> hits) override;
    bool needs_rays() const override { return false; }
    bool rays_travel_alone() const override { return true; }
    bool reaches(const ScreenBox& box) const override {
        return candidates_.reach(view_.window(box));
    }
    std::uint64_t reached(const ScreenBox& first, float step, int count) const override {
        if (!view_.bands) return TileTracer::reached(first, step, count);
        return view_.bands->reached(view_.window(first), step, count);
    }
    bool covers(std::uint32_t object, std::uint32_t primitive, const ScreenBox& box) override;

    /// Traces a square of the screen, unless that takes more than so many clusters.
    ScreenEffort probe(Vec2f corner, std::uint32_t most_clusters);

  private:
    static constexpr std::uint32_t kNotYet = 0xFFFFFFFFU;

    void find_front(Front& front);
    void start(const BlockRaster& raster, std::span<const PointPacket> points);
    template <class Visit>
    bool for_each_near(const Window& window, const Visit& visit);
    FrontRaster lay_out(const BlockRaster& raster);
    void find_fronts(const FrontRaster& raster, std::uint32_t most_clusters = kNotYet);
    std::uint32_t packet_of(std::size_t candidate);

    const View& view_;
    Candidates candidates_;
    PacketStore store_;
    std::vector<std::uint32_t> prepared_;  ///< a candidate: its place in the store, or kNotYet
    std::uint32_t used_ = 0;               ///< candidates that rays came near
    std::vector<Front> fronts_;
    // Of the cells of a raster, see FrontRaster:
    std::vector<float> farthest_;
    std::vector<std::uint32_t> front_at_;
    std::vector<std::uint8_t> dirty_;
};

void ScreenTileTracer::intersect(std::span<const PointPacket> points,
                                 std::span<const RayPacket> rays, std::span<HitPacket> hits) {
    Front front;
    for (std::size_t k = 0; k < points.size(); ++k) {
        front.start(view_.projection, points[k]);
        find_front(front);
        for (int i = 0; i < kLanes; ++i) {
            const bool hit = front.depth[i] < kInfinity && front.depth[i] > -kInfinity;
            if (hit) store_.complete(front.winner[i] / kLanes);
        }
        ink::resolve(front, rays[k], store_.packets(), hits[k]);
    }
}

void ScreenTileTracer::identify(std::span<const PointPacket> points,
                                std::span<const RayPacket> /*rays*/, std::span<HitPacket> hits) {
    Front front;
    for (std::size_t k = 0; k < points.size(); ++k) {
        front.start(view_.projection, points[k]);
        find_front(front);
        ink::identify(front, store_.packets(), hits[k]);
    }
}

void ScreenTileTracer::resolve(std::size_t first, std::span<const PointPacket> /*points*/,
                               std::span<const RayPacket> rays, std::span<HitPacket> hits) {
    for (std::size_t k = 0; k < hits.size(); ++k) {
        ink::resolve(fronts_[first + k], rays[k], store_.packets(), hits[k]);
    }
}

/// Of points on the raster it is told where they lie.
void ScreenTileTracer::start(const BlockRaster& raster, std::span<const PointPacket> points) {
    if (fronts_.size() < points.size()) fronts_.resize(points.size());
    start_cells(view_.projection, raster, store_.wants_shades(), fronts_.data());
    for (std::size_t k = raster.packets; k < points.size(); ++k) {
        fronts_[k].start(view_.projection, points[k]);
    }
}

FrontRaster ScreenTileTracer::lay_out(const BlockRaster& raster) {
    const Vec2f centre = view_.projection.centre;
    // Its points keep half a spacing off the edges of a cell; less, for rounding.
    const float inset = 0.45F * raster.spacing;
    FrontRaster fronts{raster.left() + inset - centre.x,
                       raster.top() + inset - centre.y,
                       raster.side(),
                       raster.side() - 2.0F * inset,
                       raster.across(),
                       raster.down(),
                       nullptr,
                       nullptr,
                       fronts_.data(),
                       nullptr,
                       {}};
    fronts.lay_window();
    const auto cells = static_cast<std::size_t>(fronts.cells());
    farthest_.assign(cells, -kInfinity);
    front_at_.resize(cells);
    dirty_.assign(cells, 0);
    const std::uint32_t* packet = raster.packet_at.data();
    for (int y = 0; y < fronts.down; ++y) {
        auto cell = static_cast<std::size_t>(y * fronts.stride());
        for (int x = 0; x < fronts.across; ++x, ++cell, ++packet) {
            if (*packet == BlockRaster::kNone) continue;
            front_at_[cell] = *packet;
            farthest_[cell] = kInfinity;
        }
    }
    fronts.front_at = front_at_.data();
    fronts.farthest = farthest_.data();
    fronts.dirty = dirty_.data();
    return fronts;
}

/// Cluster by cluster instead of point by point: each is looked at once, not by every block that
/// it reaches into.
void ScreenTileTracer::find_fronts(const FrontRaster& raster, std::uint32_t most_clusters) {
    for (std::size_t k = 0; used_ < most_clusters; ++k) {
        const float most = farthest_of(raster);
        if (k == candidates_.packets() && !candidates_.find_more(most)) return;
        if (!(candidates_.depth(k * kLanes) < most)) return;
        const std::size_t end = std::min((k + 1) * kLanes, candidates_.count());
        for (std::size_t i = k * kLanes; i < end; ++i) {
            if (i + 1 < end) store_.prefetch(candidates_.cluster(i + 1));
            if (!matters(candidates_.bounds(k), static_cast<int>(i % kLanes), raster)) continue;
            const std::uint32_t packet = packet_of(i);
            ink::intersect(view_.basis, store_.packets(), packet, raster);
        }
    }
}

void ScreenTileTracer::find_front(Front& front) {
    for (std::size_t k = 0;; ++k) {
        if (k == candidates_.packets() && !candidates_.find_more(front.window.farthest)) return;
        if (!(candidates_.depth(k * kLanes) < front.window.farthest)) return;
        for (LaneBits lanes = overlap(candidates_.bounds(k), front.window); lanes != 0;
             lanes &= lanes - 1) {
            const std::size_t i = k * kLanes + static_cast<std::size_t>(std::countr_zero(lanes));
            if (!(candidates_.depth(i) < front.window.farthest)) return;
            // Points may be far apart.
            const LaneBits points =
                ink::reached(candidates_.bounds(k), static_cast<int>(i % kLanes), front);
            if (points == 0) continue;
            const std::uint32_t packet = packet_of(i);
            ink::intersect(view_.basis, store_.packets(), packet, points, front);
        }
    }
}

/// Calls `visit(packet, lane)` for the primitives whose bounds lie in the window, until it returns
/// false, which comes back.
template <class Visit>
bool ScreenTileTracer::for_each_near(const Window& window, const Visit& visit) {
    for (std::size_t k = 0;; ++k) {
        if (k == candidates_.packets() && !candidates_.find_more(window.farthest)) return true;
        if (!(candidates_.depth(k * kLanes) < window.farthest)) return true;
        for (LaneBits lanes = overlap(candidates_.bounds(k), window); lanes != 0;
             lanes &= lanes - 1) {
            const std::size_t i = k * kLanes + static_cast<std::size_t>(std::countr_zero(lanes));
            const ScreenPacket& packet = store_.packets()[packet_of(i)];
            for (LaneBits near = overlap(packet.bounds, window); near != 0; near &= near - 1) {
                if (!visit(packet, std::countr_zero(near))) return false;
            }
        }
    }
}

bool ScreenTileTracer::covers(std::uint32_t object, std::uint32_t primitive, const ScreenBox& box) {
    Window window = view_.window(box);
    const auto is_own = [&](const ScreenPacket& packet, int lane) {
        return packet.object == object && packet.primitive[lane] == primitive;
    };
    const auto range = [&](const ScreenPacket& packet, int lane) {
        SphereForm form;
        std::memcpy(&form, packet.forms[static_cast<std::size_t>(lane)].data(), sizeof(form));
        return sphere_range(view_.projection, form, window);
    };
    SphereRange own;
    for_each_near(window, [&](const ScreenPacket& packet, int lane) {
        if (!is_own(packet, lane)) return true;
        if (packet.kind == ClusterKind::spheres) own = range(packet, lane);
        return false;
    });
    if (!own.covers) return false;
    window.farthest = own.farthest;
    return for_each_near(window, [&](const ScreenPacket& packet, int lane) {
        if (packet.kind != ClusterKind::spheres) return false;
        if (is_own(packet, lane)) return true;
        const SphereRange other = range(packet, lane);
        return !other.reaches || other.nearest > own.farthest;
    });
}

std::uint32_t ScreenTileTracer::packet_of(std::size_t candidate) {
    if (prepared_.size() < candidates_.count()) prepared_.resize(candidates_.count(), kNotYet);
    std::uint32_t& index = prepared_[candidate];
    if (index != kNotYet) return index;
    ++used_;
    index = store_.get(candidates_.cluster(candidate));
    // Closer than those of the cluster's box.
    store_.copy_bounds(index, candidates_.bounds(candidate / kLanes),
                       static_cast<int>(candidate % kLanes));
    return index;
}

constexpr int kProbeSide = 4;  ///< blocks

ScreenEffort ScreenTileTracer::probe(Vec2f corner, std::uint32_t most_clusters) {
    constexpr int kPoints = kBlockSide * kProbeSide;
    constexpr auto kSide = static_cast<float>(kPoints);
    constexpr std::size_t kBlocks = kProbeSide * kProbeSide;
    std::array<std::uint32_t, kBlocks> cells;
    std::iota(cells.begin(), cells.end(), 0U);
    const BlockRaster raster{0, 0, kPoints, kPoints, 1.0F, corner, cells, kBlocks};
    enter({corner.x, corner.y, corner.x + kSide, corner.y + kSide});
    fronts_.resize(kBlocks);
    start_cells(view_.projection, raster, store_.wants_shades(), fronts_.data());
    find_fronts(lay_out(raster), most_clusters);
    ScreenEffort effort{used_, 0};
    for (std::size_t k = 0; k < kBlocks; ++k) {
        effort.hits += static_cast<std::uint32_t>(
            std::ranges::count_if(fronts_[k].depth, [](float depth) { return depth < kInfinity; }));
    }
    return effort;
}

class ScreenFrameTracer final : public FrameTracer {
  public:
    ScreenFrameTracer(const Clusters& clusters, const Projection& projection)
        : view_(clusters, projection) {}

    std::unique_ptr<TileTracer> tile_tracer() const override {
        return std::make_unique<ScreenTileTracer>(view_);
    }

    bool may_see(const ScreenBox& box) const override {
        return !view_.bands || view_.bands->reach(view_.window(box));
    }
    bool measures_borders() const override { return true; }
    bool sees_without_rays() const override {
        return view_.triangles_only() || view_.triangles == 0;
    }

    bool is_suited(const Window& part) const;

  private:
    View view_;
};

/// Clusters that may be met for each ray that hits something. Where they are more, Embree took less
/// time on a million to ten million spheres and triangles, seen from near and far: there, where
/// primitives are smaller than pixels, it spends 0.2 to 0.5 microseconds a ray, and a cluster takes
/// 0.6.
constexpr float kMostClustersPerHit = 0.38F;

/// The part of the picture that the scene covers, q, if its box did.
Window covered(const Clusters& clusters, const Projection& projection) {
    BoundsPacket boxes;
    const Clusters::Level& top = clusters.levels.back();
    prepare(Basis(projection), top.boxes[0], top.count, boxes);
    BoundsPacket whole = BoundsPacket::none();
    set_union(boxes, whole, 0);
    // The axis is in the middle of the picture.
    const Vec2f centre = projection.centre;
    return {std::max(whole.left[0], -centre.x), std::min(whole.right[0], centre.x),
            std::max(whole.top[0], -centre.y), std::min(whole.bottom[0], centre.y), kInfinity};
}

/// By squares all over that part, the fewer the smaller it is.
bool ScreenFrameTracer::is_suited(const Window& part) const {
    constexpr float kSide = kBlockSide * kProbeSide;
    const auto [left, right, top, bottom, farthest] = part;
    const auto probes = [](float size) { return std::clamp(static_cast<int>(size) / 64, 1, 4); };
    const int across = probes(right - left);
    const int down = probes(bottom - top);
    const auto most = static_cast<std::uint32_t>(kMostClustersPerHit *
                                                 static_cast<float>(across * down) * kSide * kSide);
    const auto place = [](int i, int count, float from, float to) {
        const float middle =
            from + (to - from) * (static_cast<float>(i) + 0.5F) / static_cast<float>(count);
        return std::floor(middle - 0.5F * kSide);
    };
    std::atomic<std::uint32_t> clusters = 0;
    std::atomic<std::uint32_t> hits = 0;
    constexpr std::size_t kGrain = 4;  // squares that share a tracer
    parallel_ranges(static_cast<std::size_t>(across * down), kGrain, [&](auto begin, auto end) {
        ScreenTileTracer tile(view_);
        for (auto k = static_cast<int>(begin); k < static_cast<int>(end); ++k) {
            const std::uint32_t so_far = clusters;
            if (so_far >= most) return;
            const Vec2f corner{place(k % across, across, left, right) + view_.projection.centre.x,
                               place(k / across, down, top, bottom) + view_.projection.centre.y};
            const ScreenEffort one = tile.probe(corner, most - so_far);
            clusters += one.clusters;
            hits += one.hits;
        }
    });
    // Where there are more, a few squares may have been given up: the answer is no all the same.
    return clusters < most &&
           static_cast<float>(clusters) <= kMostClustersPerHit * static_cast<float>(hits);
}

}  // namespace

std::unique_ptr<FrameTracer> make_suited_screen_tracer(const Clusters& clusters,
                                                       const Projection& projection) {
    constexpr std::size_t kFew = 1000;  // suit everything
    if (clusters.clusters.size() <= kFew) return make_screen_tracer(clusters, projection);
    const Window part = covered(clusters, projection);
    // So many clusters a pixel never did.
    constexpr float kTooMany = 2.0F;
    const float pixels =
        std::max(part.right - part.left, 0.0F) * std::max(part.bottom - part.top, 0.0F);
    if (static_cast<float>(clusters.clusters.size()) > kTooMany * pixels) return nullptr;
    auto tracer = std::make_unique<ScreenFrameTracer>(clusters, projection);
    if (!tracer->is_suited(part)) return nullptr;
    return tracer;
}

std::unique_ptr<FrameTracer> make_screen_tracer(const Clusters& clusters,
                                                const Projection& projection) {
    return std::make_unique<ScreenFrameTracer>(clusters, projection);
}

}  // namespace ink
