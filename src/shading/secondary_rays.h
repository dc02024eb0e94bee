#pragma once

#include <array>
#include <cmath>

#include "accel/tracer.h"
#include "base/lanes.h"
#include "shading/lighting.h"

namespace ink {

/// How far above a surface rays that leave it start, in the scene's frame: beyond the rounding of
/// the hit, and a pixel's hundredth in pictures of a thousand.
inline constexpr float kLiftOff = 2e-5F;

/// Where rays that leave the points of surfaces start, just above them.
inline void lift_off(const SurfacePacket& surface, RayPacket& rays) {
    for (int i = 0; i < kLanes; ++i) {
        const bool hit = surface.hits.object[i] != kNoObject;
        const float t = hit ? surface.hits.t[i] : 0.0F;
        const float lift = hit ? kLiftOff : 0.0F;
        rays.origin_x[i] =
            surface.rays.origin_x[i] + t * surface.rays.dir_x[i] + lift * surface.normals.x[i];
        rays.origin_y[i] =
            surface.rays.origin_y[i] + t * surface.rays.dir_y[i] + lift * surface.normals.y[i];
        rays.origin_z[i] =
            surface.rays.origin_z[i] + t * surface.rays.dir_z[i] + lift * surface.normals.z[i];
        rays.active[i] = hit ? -1 : 0;
    }
}

/// A number in [0, 1) for each point of the screen whose neighbours differ as much as they can: the
/// R2 sequence as a dither mask (Roberts 2018), which has no low frequencies.
inline float screen_noise(float x, float y) {
    constexpr double kX = 0.7548776662466927;
    constexpr double kY = 0.5698402909980532;
    const double value = kX * std::floor(static_cast<double>(x) * 4.0) +
                         kY * std::floor(static_cast<double>(y) * 4.0);
    return static_cast<float>(value - std::floor(value));
}

/// Point k of n spread evenly over the unit disc: Vogel's spiral, turned by `turn` in [0, 1).
inline Vec2f disc_point(int k, int n, float turn) {
    constexpr float kGoldenAngle = 2.39996323F;
    const float radius = std::sqrt((static_cast<float>(k) + 0.5F) / static_cast<float>(n));
    const float angle = kGoldenAngle * static_cast<float>(k) + 6.28318531F * turn;
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace ink
