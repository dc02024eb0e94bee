#include "accel/tracer.h"

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

#include "accel/clusters.h"
#include "accel/screen_tracer.h"
#include "base/multiversion.h"

namespace ink {

namespace {

/// Camera rays like any other rays.
class PlainTileTracer final : public TileTracer {
  public:
    explicit PlainTileTracer(const Tracer& tracer) : tracer_(tracer) {}

    void enter(const ScreenBox& /*area*/) override {}
    void intersect(std::span<const PointPacket> /*points*/, std::span<const RayPacket> rays,
                   std::span<HitPacket> hits) override {
        tracer_.intersect(rays, hits, Coherence::coherent);
    }

  private:
    const Tracer& tracer_;
};

class PlainFrameTracer final : public FrameTracer {
  public:
    explicit PlainFrameTracer(const Tracer& tracer) : tracer_(tracer) {}
    std::unique_ptr<TileTracer> tile_tracer() const override {
        return std::make_unique<PlainTileTracer>(tracer_);
    }

  private:
    const Tracer& tracer_;
};

/// Two tracers that see different objects; the nearer hit counts, the first's where they are equal.
class MergedTileTracer final : public TileTracer {
  public:
    MergedTileTracer(std::unique_ptr<TileTracer> first, std::unique_ptr<TileTracer> second)
        : first_(std::move(first)), second_(std::move(second)) {}

    void enter(const ScreenBox& area) override {
        first_->enter(area);
        second_->enter(area);
    }
    void intersect(std::span<const PointPacket> points, std::span<const RayPacket> rays,
                   std::span<HitPacket> hits) override {
        others_.resize(hits.size());
        first_->intersect(points, rays, hits);
        second_->intersect(points, rays, others_);
        for (std::size_t k = 0; k < hits.size(); ++k) take_nearer(others_[k], hits[k]);
    }
    void find(const BlockRaster& raster, std::span<const PointPacket> points) override {
        first_->find(raster, points);
        second_->find(raster, points);
    }
    void resolve(std::size_t first, std::span<const PointPacket> points,
                 std::span<const RayPacket> rays, std::span<HitPacket> hits) override {
        others_.resize(hits.size());
        first_->resolve(first, points, rays, hits);
        second_->resolve(first, points, rays, others_);
        for (std::size_t k = 0; k < hits.size(); ++k) take_nearer(others_[k], hits[k]);
    }
    bool rays_travel_alone() const override {
        return first_->rays_travel_alone() && second_->rays_travel_alone();
    }
    bool reaches(const ScreenBox& box) const override {
        return first_->reaches(box) || second_->reaches(box);
    }

  private:
    INKTRACE_MULTIVERSION
    static void take_nearer(const HitPacket& other, HitPacket& hits) {
        for (int i = 0; i < kLanes; ++i) {
            const bool nearer = other.t[i] < hits.t[i];
            hits.t[i] = nearer ? other.t[i] : hits.t[i];
            hits.normal_x[i] = nearer ? other.normal_x[i] : hits.normal_x[i];
            hits.normal_y[i] = nearer ? other.normal_y[i] : hits.normal_y[i];
            hits.normal_z[i] = nearer ? other.normal_z[i] : hits.normal_z[i];
            hits.u[i] = nearer ? other.u[i] : hits.u[i];
            hits.v[i] = nearer ? other.v[i] : hits.v[i];
            hits.primitive[i] = nearer ? other.primitive[i] : hits.primitive[i];
            hits.object[i] = nearer ? other.object[i] : hits.object[i];
        }
    }

    std::unique_ptr<TileTracer> first_, second_;
    std::vector<HitPacket> others_;
};

class MergedFrameTracer final : public FrameTracer {
  public:
    MergedFrameTracer(std::unique_ptr<FrameTracer> first, std::unique_ptr<FrameTracer> second)
        : first_(std::move(first)), second_(std::move(second)) {}
    std::unique_ptr<TileTracer> tile_tracer() const override {
        return std::make_unique<MergedTileTracer>(first_->tile_tracer(), second_->tile_tracer());
    }
    bool may_see(const ScreenBox& box) const override {
        return first_->may_see(box) || second_->may_see(box);
    }

  private:
    std::unique_ptr<FrameTracer> first_, second_;
};

bool on_screen(const Object& object) { return has_screen_form(object.shape); }

/// Embree's hierarchy, built when it is first asked for.
class LazyEmbree {
  public:
    LazyEmbree(const Scene& scene, ObjectFilter wanted)
        : scene_(scene), wanted_(std::move(wanted)) {}

    const Tracer& get() const {
        std::call_once(built_,
                       [&] { tracer_ = make_embree_tracer(scene_, PacketWidth::widest, wanted_); });
        return *tracer_;
    }

  private:
    const Scene& scene_;
    ObjectFilter wanted_;
    mutable std::once_flag built_;
    mutable std::unique_ptr<Tracer> tracer_;
};

class SceneTracer final : public Tracer {
  public:
    explicit SceneTracer(const Scene& scene)
        : scene_(scene),
          clusters_(scene),
          all_(scene, {}),
          others_(scene, [](const Object& object) { return !on_screen(object); }) {}

    void intersect(std::span<const RayPacket> rays, std::span<HitPacket> hits,
                   Coherence coherence) const override {
        all_.get().intersect(rays, hits, coherence);
    }

    void cross(const RayPacket& rays, SurfaceHits& hits) const override {
        all_.get().cross(rays, hits);
    }

    void occluded(std::span<const RayPacket> rays, std::span<const Lanes<float>> reach,
                  std::span<Lanes<std::int32_t>> blocked) const override {
        all_.get().occluded(rays, reach, blocked);
    }

    std::unique_ptr<FrameTracer> frame(const Projection& projection, int threads) const override {
        const auto objects = std::span(scene_.objects());
        if (!projection.sees_all() || std::ranges::none_of(objects, on_screen)) {
            return all_.get().frame(projection, threads);
        }
        auto screen = make_suited_screen_tracer(clusters_, projection);
        if (!screen) return all_.get().frame(projection, threads);
        if (std::ranges::all_of(objects, on_screen)) return screen;
        return std::make_unique<MergedFrameTracer>(std::move(screen),
                                                   others_.get().frame(projection, threads));
    }

  private:
    const Scene& scene_;
    Clusters clusters_;
    LazyEmbree all_, others_;
};

}  // namespace

void Tracer::cross(const RayPacket& rays, SurfaceHits& hits) const {
    constexpr float kStep = 1e-5F;  // in a scene of size 1
    for (auto& list : hits) list.clear();
    RayPacket rest = rays;
    Lanes<float> behind{};
    HitPacket found;
    const auto any_left = [&] {
        return std::ranges::any_of(rest.active, [](auto active) { return active != 0; });
    };
    while (any_left()) {
        intersect({&rest, 1}, {&found, 1}, Coherence::incoherent);
        for (int i = 0; i < kLanes; ++i) {
            if (found.object[i] == kNoObject) rest.active[i] = 0;
            if (rest.active[i] == 0) continue;
            const float t = behind[i] + found.t[i];
            hits[static_cast<std::size_t>(i)].push_back(
                {t,
                 {found.normal_x[i], found.normal_y[i], found.normal_z[i]},
                 found.u[i],
                 found.v[i],
                 found.primitive[i],
                 found.object[i]});
            behind[i] = t + kStep;
            rest.origin_x[i] = rays.origin_x[i] + behind[i] * rays.dir_x[i];
            rest.origin_y[i] = rays.origin_y[i] + behind[i] * rays.dir_y[i];
            rest.origin_z[i] = rays.origin_z[i] + behind[i] * rays.dir_z[i];
        }
    }
}

std::unique_ptr<FrameTracer> Tracer::frame(const Projection& /*projection*/,
                                           int /*threads*/) const {
    return std::make_unique<PlainFrameTracer>(*this);
}

std::unique_ptr<Tracer> make_tracer(const Scene& scene) {
    return std::make_unique<SceneTracer>(scene);
}

}  // namespace ink
