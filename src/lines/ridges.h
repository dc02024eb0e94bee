#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "base/vec.h"
#include "sampling/samples.h"

// Apparent ridges: Judd, Durand and Adelson, Apparent Ridges for Line Drawing, SIGGRAPH 2007. The
// view-dependent curvature matrix Q (normal change in the tangent plane for a step on screen) is
// the gradient of the normal on screen, because a unit normal changes within the tangent plane. Its
// larger singular value is q1, with direction t1 on screen; a ridge runs where q1 is maximal along
// t1.
namespace ink {

/// How strongly the normal must turn for a ridge to be drawn, in radians a pixel: no line up to
/// `least`, full strength from `full` on.
struct RidgeSettings {
    float least = 0.01F;
    float full = 0.02F;
};

/// What the normals about a point tell of the ridge next to it.
struct RidgeEstimate {
    float slope = 0.0F;     ///< derivative of q1^2 along t1, whose zero is the ridge
    Vec2f along;            ///< t1, unit; of either sense, by which `slope` has its sign
    Vec2f gradient;         ///< of `slope` on screen
    float bend = 0.0F;      ///< derivative of `slope` along t1: below zero about a maximum
    float strength = 0.0F;  ///< [0, 1]; 0: the normal turns too little, or in no direction most

    /// Distance from the point to the ridge, pixels.
    float distance() const;
};

/// Estimates ridges from normals at a fixed set of points about a centre: a cubic polynomial is
/// fitted to the normals by least squares, which is a fixed weighted sum for each derivative.
class RidgeEstimator {
  public:
    /// `offsets` from the centre (pixels), the centre itself among them or not; at least ten that
    /// lie on no cubic curve.
    RidgeEstimator(std::span<const Vec2f> offsets, const RidgeSettings& settings);

    std::size_t size() const { return weights_.size(); }

    /// Unit normals at the offsets, in the same order. Strength 0 also where no maximum is near.
    RidgeEstimate estimate(std::span<const Vec3f> normals) const;

    static constexpr std::size_t kDerivatives = 9;  ///< x, y, xx, xy, yy, xxx, xxy, xyy, yyy
    /// With which each normal goes into each derivative.
    std::span<const std::array<float, kDerivatives>> weights() const { return weights_; }

  private:
    RidgeSettings settings_;
    std::vector<std::array<float, kDerivatives>> weights_;  ///< of each normal
};

/// Whether two hits lie on one smooth piece of surface, so that their normals may be compared.
bool one_surface(const Sample& a, const Sample& b);

}  // namespace ink
