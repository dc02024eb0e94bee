#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "base/vec.h"
#include "lines/curve.h"
#include "lines/parabola.h"

namespace ink {

struct FitSettings {
    double tolerance = 0.1;  ///< largest distance of a point from its curve, pixels
    /// A line that turns by more than this between two neighbouring points, beyond what its curve
    /// on both sides explains, has a corner there. The error of crossings moves the measured angle
    /// by a degree or two; smaller corners pass for round within the tolerance.
    double corner_deg = 22.0;
};

/// Fits piecewise cubic curves to polylines whose points have a small error: least squares, as few
/// pieces as the tolerance allows, one tangent where two of them meet, corners kept. After
/// Schneider, An Algorithm for Automatically Fitting Digitized Curves, Graphics Gems 1990, but with
/// free tangents at corners and ends, and with pieces that reach as far as they can and then share
/// the error alike.
class CurveFitter {
  public:
    explicit CurveFitter(const FitSettings& settings) : settings_(settings) {}

    /// `cuts` are the indices, ascending, at which one curve ends exactly and the next one begins.
    /// Open: the first is 0 and the last points.size() - 1. Closed: the first is 0 and the last
    /// points.size(), which means 0 again. Appends one curve from each cut to the next.
    void fit(std::span<const Vec2f> points, bool closed, std::span<const std::size_t> cuts,
             std::vector<Curve>& curves);

  private:
    struct Knot {
        Vec2d point;
        bool cut = false;
        bool corner = false;  ///< the tangent jumps here, or the line ends
    };
    struct Corner {
        std::size_t after = 0;  ///< lies between this knot and the next one, or is this knot
        double excess = 0.0;    ///< radians
        std::optional<Vec2d> point{};
    };
    /// Points from one to another, with the unit tangents (forwards) that are asked for.
    struct Span {
        std::size_t first, last;
        std::optional<Vec2d> tangent1{}, tangent2{};
    };
    struct Controls {
        Vec2d first, second;
    };

    void take(std::span<const Vec2f> points, bool closed, std::span<const std::size_t> cuts);
    void find_corners();
    Corner corner_between(std::size_t from, std::size_t to) const;
    static void keep_sharpest(std::vector<Corner>& corners);
    void add_corners(std::span<const Corner> corners);
    void start_at_corner();
    std::optional<Parabola> side(std::size_t at, int direction) const;
    std::optional<Vec2d> smooth_tangent(std::size_t k) const;
    std::size_t step(std::size_t k, int direction) const;

    bool is_straight(std::size_t first, std::size_t last) const;
    void fit_between(std::size_t first, std::size_t last);
    Span span(std::size_t first, std::size_t last) const;
    std::size_t place_ends(std::size_t first, std::size_t last, double tolerance, std::size_t most);
    std::size_t farthest(std::size_t first, std::size_t last, std::size_t guess, double tolerance);
    bool fit_piece(const Span& span, double tolerance, CurvePiece& piece);
    Controls solve(const Span& span, double arc) const;
    double project(const Span& span, const Controls& controls);

    FitSettings settings_;
    bool closed_ = false;
    double mean_step_ = 0.0;          ///< between points, pixels
    std::vector<Knot> knots_;         ///< closed: the first comes again as the last
    std::vector<double> parameters_;  ///< of the points of the piece at hand, in [0, 1]
    std::vector<std::size_t> ends_, best_ends_;
    Curve curve_;
};

}  // namespace ink
