#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <variant>

#include "shading/ambient.h"
#include "shading/ambient_nodes.h"
#include "shading/secondary_rays.h"

namespace ink {

namespace {

/// What pixels of a picture cover of a scene.
class Footprints {
  public:
    explicit Footprints(const Camera& camera)
        : eye_(camera.eye()), back_(camera.back()), parallel_(camera.orthographic()) {
        const Camera::RayField& field = camera.ray_field();
        pixel_ = length(parallel_ ? field.origin_dx : field.dir_dx);
    }
    /// Distance between rays of neighbouring pixels at a point, scene units.
    float at(Vec3f p) const {
        if (parallel_) return pixel_;
        return pixel_ * std::max(dot(eye_ - p, back_), 1e-6F);
    }

  private:
    Vec3f eye_, back_;
    bool parallel_;
    float pixel_;
};

/// Lanes that see the same primitive as one.
std::uint32_t same_surface(const HitPacket& hits, int lane) {
    std::uint32_t same = 0;
    for (int i = 0; i < kLanes; ++i) {
        const bool is_same =
            hits.object[i] == hits.object[lane] && hits.primitive[i] == hits.primitive[lane];
        same |= std::uint32_t{is_same} << static_cast<unsigned>(i);
    }
    return same;
}

bool has(std::uint32_t lanes, int lane) { return (lanes >> static_cast<unsigned>(lane) & 1U) != 0; }

/// Of a block of 4 x 4 pixels every other one, but for corners: those which lie between two that
/// any tile with the pixel has, also one that ends with the first row or column of the block.
constexpr std::uint32_t kBetween = 0b0100'1010'0101'0010;

/// Of a row or column of sixteen along the edge of such blocks, the same.
constexpr std::uint32_t kBetweenInStrip = 0b0010'0010'0010'0010;

/// What lies between two pixels is computed where their openness differs by more. Adds 0.0004 to
/// the error on a ribosome, and saves an eighth of the pixels.
constexpr float kAgree = 0.035F;

/// Openness of a point of a ball about half way between two others, by theirs. That of a sky that
/// is the same for both would be linear in the normal: the mean of the two belongs to the mean of
/// their normals, which is shorter. None where they differ, or where it lies elsewhere, as in a
/// curved mirror.
std::optional<float> between_two(const NormalPacket& normals, const Lanes<float>& open, int a,
                                 int middle, int b) {
    constexpr float kHalfWay = 0.999F;  // cosine of an angle
    if (std::abs(open[a] - open[b]) > kAgree) return {};
    const Vec3f sum{normals.x[a] + normals.x[b], normals.y[a] + normals.y[b],
                    normals.z[a] + normals.z[b]};
    const float size = length(sum);
    const Vec3f n{normals.x[middle], normals.y[middle], normals.z[middle]};
    if (dot(n, sum) < kHalfWay * size) return {};
    return (open[a] + open[b]) / size;
}

class SeenBake final : public AmbientOcclusion {
  public:
    SeenBake(const AmbientBake::Impl& bake, const Camera& camera, SmallBalls small)
        : bake_(bake),
          footprints_(camera),
          small_(small),
          balls_only_(std::ranges::all_of(bake.scene.objects(), [](const Object& object) {
              return std::holds_alternative<Spheres>(object.shape);
          })) {}

    void openness(const SurfacePacket& surface, Lanes<float>& open) const override {
        const PointPacket& at = surface.points;
        const bool is_block = at.x[kBlockSide] == at.x[0] && at.y[1] == at.y[0];
        find(surface.hits, surface.normals, is_block, open,
             [&](int i) { return at_other(surface, i); });
    }

    bool needs_normals_only() const override { return balls_only_; }
    void openness(const HitPacket& hits, const NormalPacket& normals, bool is_strip,
                  Lanes<float>& open) const override {
        find(hits, normals, !is_strip, open, [](int /*lane*/) { return 1.0F; });
    }

  private:
    /// `of_other(i)` tells of a lane that sees no ball.
    template <class Other>
    void find(const HitPacket& hits, const NormalPacket& normals, bool is_block, Lanes<float>& open,
              const Other& of_other) const {
        // Primitive by primitive: what there is about a ball stays in the nearest cache.
        std::uint32_t rest = (1U << kLanes) - 1U;
        while (rest != 0) {
            const int first = std::countr_zero(rest);
            const std::uint32_t own = same_surface(hits, first) & rest;
            rest &= ~own;
            if (hits.object[first] == kNoObject) {
                for_lanes(own, [&](int i) { open[i] = 1.0F; });
            } else if (std::holds_alternative<Spheres>(shape_of(hits, first))) {
                find_on_ball(hits, normals, is_block, own, open);
            } else {
                for_lanes(own, [&](int i) { open[i] = of_other(i); });
            }
        }
    }

    /// Of lanes that see one ball. Where every point is computed, on small balls, what lies between
    /// two pixels that nearly agree is not.
    void find_on_ball(const HitPacket& hits, const NormalPacket& normals, bool is_block,
                      std::uint32_t own, Lanes<float>& open) const {
        const int any = std::countr_zero(own);
        const std::uint32_t primitive = hits.primitive[any];
        const Sphere ball = std::get<Spheres>(shape_of(hits, any)).at(primitive);
        const std::size_t ball_number = bake_.first_ball[hits.object[any]] + primitive;
        const float radius_px = ball.radius / footprints_.at(ball.centre);
        if (const auto grid = grid_of(radius_px)) {
            bake_.on_ball(ball, ball_number, *grid, own, normals, open);
            return;
        }
        const auto at_point = [&](int i) {
            return bake_.at_point(ball, ball_number, {normals.x[i], normals.y[i], normals.z[i]});
        };
        const std::uint32_t spared = is_block ? kBetween : kBetweenInStrip;
        const std::uint32_t between = bake_.strings ? 0U : own & spared;
        for_lanes(own & ~between, [&](int i) { open[i] = at_point(i); });
        for_lanes(between, [&](int i) {
            float sum = 0.0F;
            float pairs = 0.0F;
            const auto add = [&](int a, int b) {
                if (!has(own, a) || !has(own, b)) return;
                const auto found = between_two(normals, open, a, i, b);
                if (!found) return;
                sum += *found;
                pairs += 1.0F;
            };
            const bool inside = i % kBlockSide != 0 && i % kBlockSide != kBlockSide - 1;
            if (!is_block || inside) add(i - 1, i + 1);
            if (is_block && i / kBlockSide != 0 && i / kBlockSide != kBlockSide - 1) {
                add(i - kBlockSide, i + kBlockSide);
            }
            open[i] = pairs > 0.0F ? std::min(sum / pairs, 1.0F) : at_point(i);
        });
    }

    /// The grid of a ball that has nodes.
    std::optional<std::size_t> grid_of(float radius_px) const {
        if (!bake_.each_point(radius_px)) return AmbientBake::Impl::ball_grid(radius_px);
        // Of a smaller one there are more nodes than points that will be seen.
        constexpr float kLeastRadius = 0.75F;
        const bool by_nodes = small_ == SmallBalls::by_nodes && !bake_.strings;
        if (!by_nodes || radius_px <= kLeastRadius) return {};
        return AmbientBake::Impl::kCoarseBallGrid;
    }

    const Shape& shape_of(const HitPacket& hits, int i) const {
        return bake_.scene.objects()[hits.object[i]].shape;
    }

    /// Of anything but balls.
    float at_other(const SurfacePacket& surface, int i) const {
        const HitPacket& hits = surface.hits;
        const Shape& shape = shape_of(hits, i);
        const Vec3f normal{surface.normals.x[i], surface.normals.y[i], surface.normals.z[i]};
        if (const auto* mesh = std::get_if<Mesh>(&shape)) {
            const TriangleCorners corners = corners_of(*mesh, hits.primitive[i], normal);
            return bake_.on_triangle(hits, i, corners,
                                     footprints_.at(corners.point(0.3333F, 0.3333F)));
        }
        const Vec3f p{surface.rays.origin_x[i] + hits.t[i] * surface.rays.dir_x[i],
                      surface.rays.origin_y[i] + hits.t[i] * surface.rays.dir_y[i],
                      surface.rays.origin_z[i] + hits.t[i] * surface.rays.dir_z[i]};
        if (bake_.strings) return bake_.on_stick(hits.object[i], hits.primitive[i], p, normal);
        return bake_.rays.openness(p, normal,
                                   screen_noise(surface.points.x[i], surface.points.y[i]));
    }

    const AmbientBake::Impl& bake_;
    Footprints footprints_;
    SmallBalls small_;
    bool balls_only_;
};

}  // namespace

AmbientBake::AmbientBake(const Scene& scene, const Tracer& tracer, int quality,
                         const std::atomic<bool>* cancel)
    : impl_(std::make_unique<Impl>(scene, tracer, quality, cancel)) {}
AmbientBake::~AmbientBake() = default;

std::unique_ptr<AmbientOcclusion> AmbientBake::seen_by(const Camera& camera,
                                                       SmallBalls small) const {
    return std::make_unique<SeenBake>(*impl_, camera, small);
}

std::shared_ptr<const AmbientBake> AmbientCache::get(const Scene& scene, const Tracer& tracer,
                                                     int quality, const std::atomic<bool>* cancel) {
    const std::scoped_lock lock(mutex_);
    if (!bake_ || quality_ != quality) {
        bake_ = std::make_shared<AmbientBake>(scene, tracer, quality, cancel);
        quality_ = quality;
    }
    return bake_;
}

}  // namespace ink
