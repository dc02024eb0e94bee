#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "base/vec.h"
#include "lines/parabola.h"

namespace ink {

/// A point of a line that a curve is fitted to.
struct Knot {
    Vec2d point;
    bool cut = false;     ///< one curve ends here exactly and the next one begins
    bool corner = false;  ///< the tangent jumps here, or the line ends
};

/// A line that turns by more than this between two neighbouring points, beyond what its curves on
/// both sides explain, has a corner there. The error of crossings moves the measured angle by a
/// degree or two; smaller corners pass for round within the tolerance of curves.
inline constexpr double kCornerDeg = 22.0;

/// Points along a line, known with a small error, and what they tell about the line: where it has
/// corners, and its tangents elsewhere.
class KnotLine {
  public:
    struct Corner {
        std::size_t after = 0;  ///< lies between this knot and the next one
        double excess = 0.0;    ///< radians of its turn that curves do not explain
        bool at_cut = false;
        std::optional<Vec2d> point{};  ///< nothing: it is the knot `after` itself
    };

    /// See CurveFitter::fit.
    void take(std::span<const Vec2f> points, bool closed, std::span<const std::size_t> cuts);
    /// Where the line turns by more than this, in radians, in the order along it. At a cut, a
    /// corner is the cut.
    std::vector<Corner> corners(double least_turn) const;
    /// Makes knots of corners. A closed line without cuts then starts at one of them.
    void add_corners(std::span<const Corner> corners);
    /// Makes a corner of a cut.
    void mark_corner(std::size_t cut);

    /// A closed line's first knot comes again as the last.
    std::span<const Knot> knots() const { return knots_; }
    std::size_t last() const { return knots_.size() - 1; }
    /// Unit tangent, forwards, of the line through a knot, from both of its sides; nothing at a
    /// corner.
    std::optional<Vec2d> smooth_tangent(std::size_t k) const;
    /// Whether all knots between two lie this near to the straight line through those.
    bool is_straight(std::size_t first, std::size_t last, double most) const;

    /// Points on each side of a knot that say where the line goes from there: enough to average the
    /// error of crossings, few enough for a circle of three pixels.
    static constexpr int kReach = 4;

  private:
    bool starts_anywhere() const;  ///< closed, without cuts but its start
    std::size_t step(std::size_t k, int direction) const;
    std::optional<Parabola> side(std::size_t at, int direction) const;
    Corner corner_between(std::size_t from, std::size_t to) const;
    static void keep_sharpest(std::vector<Corner>& corners, std::size_t round);
    void start_at_corner();

    bool closed_ = false;
    double mean_step_ = 0.0;  ///< between points, pixels
    std::vector<Knot> knots_;
};

}  // namespace ink
