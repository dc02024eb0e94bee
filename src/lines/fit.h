#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/vec.h"
#include "lines/curve.h"
#include "lines/knots.h"
#include "lines/piece_fitter.h"

namespace ink {

struct FitSettings {
    double tolerance = 0.1;  ///< largest distance of a point from its curve, pixels
};

/// Fits piecewise cubic curves to polylines whose points have a small error: least squares, as few
/// pieces as the tolerance allows, one tangent where two of them meet, free ones at corners and
/// ends. Pieces reach as far as they can and then share the error alike.
class CurveFitter {
  public:
    explicit CurveFitter(const FitSettings& settings) : settings_(settings) {}

    /// `cuts` are the indices, ascending, at which one curve ends exactly and the next one begins.
    /// Open: the first is 0 and the last points.size() - 1. Closed: the first is 0 and the last
    /// points.size(), which means 0 again. Appends one curve from each cut to the next.
    void fit(std::span<const Vec2f> points, bool closed, std::span<const std::size_t> cuts,
             std::vector<Curve>& curves) {
        fit(points, closed, cuts, {}, curves);
    }
    /// The same where some of the cuts are known to be corners.
    void fit(std::span<const Vec2f> points, bool closed, std::span<const std::size_t> cuts,
             std::span<const std::size_t> corners, std::vector<Curve>& curves);

  private:
    void fit_between(std::size_t first, std::size_t last);
    std::size_t place_ends(std::size_t first, std::size_t last, double tolerance, std::size_t most);
    std::size_t farthest(std::size_t first, std::size_t last, std::size_t guess, double tolerance);
    bool fit_piece(std::size_t first, std::size_t last, double tolerance, CurvePiece& piece);

    FitSettings settings_;
    KnotLine line_;
    PieceFitter fitter_;
    std::vector<std::size_t> ends_, best_ends_;
    Curve curve_;
};

}  // namespace ink
