#include "shading/shadows.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "shading/secondary_rays.h"

namespace ink {

namespace {

constexpr int kFewRays = 12;   ///< that tell whether a point may lie in the penumbra
constexpr int kRimRays = 8;    ///< of them, along the rim of the light
constexpr int kManyRays = 56;  ///< more of them there
/// Of lights that have no size, in radians: that of a lamp with a shade.
constexpr float kUsualRadius = 0.06F;

/// Rays towards the points of a light, one packet for each of its points.
struct LightRays {
    std::vector<RayPacket> rays;
    std::vector<Lanes<float>> reach;
    std::vector<Lanes<std::int32_t>> blocked;
};

/// A light's half axes, of a size that it may have been given for soft shadows.
LightSource with_size(LightSource light, ShadowMode mode) {
    const float least = mode == ShadowMode::soft ? kUsualRadius : 0.0F;
    if (mode == ShadowMode::hard) {
        light.side = light.up = {};
    } else if (!light.has_size() && !light.is_disc) {
        light.side = normalize(std::abs(light.from.z) < 0.9F ? cross({0, 0, 1}, light.from)
                                                             : cross({1, 0, 0}, light.from)) *
                     least;
        light.up = cross(light.from, light.side);
    }
    return light;
}

/// Point k of those looked at first: most lie on the rim, where shadows begin.
Vec2f first_point(int k, float turn) {
    if (k >= kRimRays) return disc_point(k - kRimRays, kFewRays - kRimRays, turn);
    const float angle = 6.28318531F * (static_cast<float>(k) / kRimRays + turn);
    return {0.99F * std::cos(angle), 0.99F * std::sin(angle)};
}

/// Turns `rays`, which start at the surface, towards a point of the light.
void aim(const LightSource& light, const Lanes<float>& turns, int k, int n, RayPacket& rays,
         Lanes<float>& reach) {
    for (int i = 0; i < kLanes; ++i) {
        const Vec2f p = !light.has_size() ? Vec2f{}
                        : n == kFewRays   ? first_point(k, turns[i])
                                          : disc_point(k, n, turns[i]);
        Vec3f to = light.from + light.side * p.x + light.up * p.y;
        if (light.is_disc) to = to - Vec3f{rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]};
        const float distance = length(to);
        const float scale = distance > 0.0F ? 1.0F / distance : 0.0F;
        rays.dir_x[i] = scale > 0.0F ? to.x * scale : 0.0F;
        rays.dir_y[i] = scale > 0.0F ? to.y * scale : 0.0F;
        rays.dir_z[i] = scale > 0.0F ? to.z * scale : 1.0F;
        reach[i] = light.is_disc ? distance : kInfinity;
    }
}

}  // namespace

void Shadows::visible(const LightSource& all, const SurfacePacket& surface,
                      Lanes<float>& visible) const {
    const LightSource light = with_size(all, mode_);
    RayPacket start;
    lift_off(surface, start);
    Lanes<float> turns;
    for (int i = 0; i < kLanes; ++i) {
        turns[i] = screen_noise(surface.points.x[i], surface.points.y[i]);
        // A surface that faces away is dark without a ray.
        const Vec3f n{surface.normals.x[i], surface.normals.y[i], surface.normals.z[i]};
        const Vec3f p{start.origin_x[i], start.origin_y[i], start.origin_z[i]};
        const Vec3f to = light.is_disc ? light.from - p : light.from;
        const float reach = std::max(length(light.side), length(light.up));
        if (dot(n, to) <= -reach) start.active[i] = 0;
    }
    const int few = light.has_size() ? kFewRays : 1;
    Lanes<std::int32_t> seen{};
    LightRays batch;
    const auto count = [&](int first, int last, int n) {
        const auto size = static_cast<std::size_t>(last - first);
        batch.rays.assign(size, start);
        batch.reach.resize(size);
        batch.blocked.resize(size);
        for (std::size_t k = 0; k < size; ++k) {
            aim(light, turns, first + static_cast<int>(k), n, batch.rays[k], batch.reach[k]);
        }
        tracer_.occluded(batch.rays, batch.reach, batch.blocked);
        for (const Lanes<std::int32_t>& blocked : batch.blocked) {
            for (int i = 0; i < kLanes; ++i) seen[i] += blocked[i] == 0 ? 1 : 0;
        }
    };
    count(0, few, few);
    for (int i = 0; i < kLanes; ++i) {
        const bool lit = start.active[i] != 0;
        visible[i] = lit ? static_cast<float>(seen[i]) / static_cast<float>(few) : 0.0F;
        if (seen[i] == 0 || seen[i] == few) start.active[i] = 0;
    }
    const auto is_active = [](std::int32_t active) { return active != 0; };
    if (few == 1 || std::ranges::none_of(start.active, is_active)) return;
    seen.fill(0);
    count(0, kManyRays, kManyRays);
    for (int i = 0; i < kLanes; ++i) {
        if (start.active[i] == 0) continue;
        visible[i] = static_cast<float>(seen[i]) / static_cast<float>(kManyRays);
    }
}

}  // namespace ink
