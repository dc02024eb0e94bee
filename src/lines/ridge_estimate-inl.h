#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "base/multiversion.h"
#include "base/vec.h"
#include "lines/ridges.h"

namespace ink {

using NormalDerivatives = std::array<Vec3f, RidgeEstimator::kDerivatives>;

INKTRACE_INLINE float smoothstep(float from, float to, float x) {
    const float s = std::min(std::max((x - from) / (to - from), 0.0F), 1.0F);
    return s * s * (3.0F - 2.0F * s);
}

/// What the derivatives of the normal on screen tell. Without branches, so that loops over it
/// vectorise.
INKTRACE_INLINE RidgeEstimate ridge_from(const NormalDerivatives& d,
                                         const RidgeSettings& settings) {
    const auto& [x, y, xx, xy, yy, xxx, xxy, xyy, yyy] = d;

    // Q^T Q, whose larger eigenvalue is q1^2.
    const float a = dot(x, x);
    const float b = dot(x, y);
    const float c = dot(y, y);
    const float half = 0.5F * (a - c);
    const float root = std::sqrt(half * half + b * b);
    const float largest = 0.5F * (a + c) + root;
    const float q1 = std::sqrt(largest);
    // Where the two singular values are alike, there is no direction t1: ridges fade out there.
    constexpr float kLeastDifference = 0.3F;
    constexpr float kFullDifference = 0.6F;
    const float difference = 2.0F * root / largest;
    const bool turns = q1 > settings.least;
    const bool has_direction = difference > kLeastDifference;
    const float tx = half >= 0.0F ? half + root : b;
    const float ty = half >= 0.0F ? b : root - half;
    const float size = std::sqrt(tx * tx + ty * ty);
    const float u = tx / size;
    const float v = ty / size;

    // Derivatives along t1 and, at a right angle to it, t2 = (-v, u).
    const Vec3f nt = x * u + y * v;
    const Vec3f ns = y * u - x * v;
    const Vec3f ntt = xx * (u * u) + xy * (2 * u * v) + yy * (v * v);
    const Vec3f nts = xx * (-u * v) + xy * (u * u - v * v) + yy * (u * v);
    const Vec3f nss = xx * (v * v) + xy * (-2 * u * v) + yy * (u * u);
    const Vec3f nttt =
        xxx * (u * u * u) + xxy * (3 * u * u * v) + xyy * (3 * u * v * v) + yyy * (v * v * v);
    const Vec3f ntts = xxx * (-u * u * v) + xxy * (u * u * u - 2 * u * v * v) +
                       xyy * (2 * u * u * v - v * v * v) + yyy * (u * v * v);

    // g = D_t1 (q1^2) = 2 n_t . n_tt, and its derivatives, along which t1 turns at a rate w.
    const float gap = 2.0F * root;
    const float g = 2.0F * dot(nt, ntt);
    const float turned = 2.0F * (dot(ns, ntt) + 2.0F * dot(nt, nts));
    const float wt = (dot(ntt, ns) + dot(nt, nts)) / gap;
    const float ws = (dot(nts, ns) + dot(nt, nss)) / gap;
    const float gt = 2.0F * (dot(ntt, ntt) + dot(nt, nttt)) + wt * turned;
    const float gs = 2.0F * (dot(nts, ntt) + dot(nt, ntts)) + ws * turned;
    const float strength = smoothstep(settings.least, settings.full, q1) *
                           smoothstep(kLeastDifference, kFullDifference, difference);
    RidgeEstimate result;
    result.slope = turns && has_direction ? g : 0.0F;
    result.along = {turns && has_direction ? u : 0.0F, turns && has_direction ? v : 0.0F};
    result.gradient = {turns && has_direction ? gt * u - gs * v : 0.0F,
                       turns && has_direction ? gt * v + gs * u : 0.0F};
    result.bend = turns && has_direction ? gt : 0.0F;
    result.strength = turns && has_direction ? strength : 0.0F;
    return result;
}

}  // namespace ink
