#include "accel/peeled_tracer.h"

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

namespace ink {

namespace {

bool is_solid(const Shape& shape) {
    if (std::holds_alternative<Mesh>(shape)) return false;
    const auto* glyphs = std::get_if<Glyphs>(&shape);
    if (glyphs == nullptr) return true;
    switch (glyphs->shape.kind) {
        case GlyphKind::ellipsoid:
        case GlyphKind::box:
        case GlyphKind::torus:
        case GlyphKind::superellipsoid: return true;
        case GlyphKind::frustum: return glyphs->shape.capped;
        case GlyphKind::disc:
        case GlyphKind::rectangle:
        case GlyphKind::gaussian:
        case GlyphKind::waves: return false;
    }
    return false;
}

/// Surfaces this near to each other touch; scene units, in a scene of size 1.
constexpr float kTouching = 2e-6F;

class PeeledTileTracer final : public TileTracer {
  public:
    PeeledTileTracer(const Tracer& tracer, const std::vector<bool>& solid,
                     std::unique_ptr<TileTracer> front, int layer)
        : tracer_(tracer), solid_(solid), front_(std::move(front)), layer_(layer) {}

    void enter(const ScreenBox& area) override { front_->enter(area); }
    bool reaches(const ScreenBox& box) const override { return front_->reaches(box); }
    void intersect(std::span<const PointPacket> /*points*/, std::span<const RayPacket> rays,
                   std::span<HitPacket> hits) override {
        for (std::size_t k = 0; k < rays.size(); ++k) {
            tracer_.cross(rays[k], crossed_);
            hits[k] = HitPacket::miss();
            for (int lane = 0; lane < kLanes; ++lane) peel(rays[k], lane, hits[k]);
        }
    }

  private:
    enum class Side : std::uint8_t { entry, sheet, exit };

    void peel(const RayPacket& rays, int lane, HitPacket& hits);
    Side side(const SurfaceHit& hit, Vec3f dir) const {
        if (!solid_[hit.object]) return Side::sheet;
        return dot(hit.normal, dir) < 0.0F ? Side::entry : Side::exit;
    }

    const Tracer& tracer_;
    const std::vector<bool>& solid_;  ///< objects
    std::unique_ptr<TileTracer> front_;
    int layer_;
    SurfaceHits crossed_;
};

/// Walks along the ray and counts how many solids it is in.
void PeeledTileTracer::peel(const RayPacket& rays, int lane, HitPacket& hits) {
    std::vector<SurfaceHit>& list = crossed_[static_cast<std::size_t>(lane)];
    const Vec3f dir{rays.dir_x[lane], rays.dir_y[lane], rays.dir_z[lane]};
    // Where one solid ends on the next, the ray does not come out between them.
    const auto order = [&](const SurfaceHit& hit) {
        return side(hit, dir) == Side::entry ? hit.t - kTouching : hit.t;
    };
    std::ranges::sort(list, [&](const SurfaceHit& a, const SurfaceHit& b) {
        return std::tuple(order(a), a.object, a.primitive) <
               std::tuple(order(b), b.object, b.primitive);
    });
    int inside = 0;
    int surfaces = 0;
    const SurfaceHit* sheet = nullptr;
    for (const SurfaceHit& hit : list) {
        const Side own = side(hit, dir);
        // A ray through the edge of two triangles may hit both.
        const bool again = own == Side::sheet && sheet != nullptr && sheet->object == hit.object &&
                           hit.t - sheet->t < kTouching;
        if (own == Side::sheet) sheet = &hit;
        if (own == Side::exit) inside = std::max(inside - 1, 0);
        const bool bare = inside == 0 && !again;
        if (own == Side::entry) ++inside;
        if (!bare || surfaces++ != layer_) continue;
        hits.t[lane] = hit.t;
        hits.normal_x[lane] = hit.normal.x;
        hits.normal_y[lane] = hit.normal.y;
        hits.normal_z[lane] = hit.normal.z;
        hits.u[lane] = hit.u;
        hits.v[lane] = hit.v;
        hits.primitive[lane] = hit.primitive;
        hits.object[lane] = hit.object;
        return;
    }
}

class PeeledFrameTracer final : public FrameTracer {
  public:
    PeeledFrameTracer(const Scene& scene, const Tracer& tracer, const FrameTracer& front, int layer)
        : tracer_(tracer), front_(front), layer_(layer) {
        for (const Object& object : scene.objects()) solid_.push_back(is_solid(object.shape));
    }
    std::unique_ptr<TileTracer> tile_tracer() const override {
        return std::make_unique<PeeledTileTracer>(tracer_, solid_, front_.tile_tracer(), layer_);
    }

  private:
    const Tracer& tracer_;
    const FrameTracer& front_;
    int layer_;
    std::vector<bool> solid_;
};

}  // namespace

std::unique_ptr<FrameTracer> make_peeled_frame(const Scene& scene, const Tracer& tracer,
                                               const FrameTracer& front, int layer) {
    return std::make_unique<PeeledFrameTracer>(scene, tracer, front, layer);
}

}  // namespace ink
