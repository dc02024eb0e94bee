#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/vec.h"
#include "lines/curve.h"
#include "lines/knots.h"

namespace ink {

/// Points that one piece of a curve is fitted to: it begins at the first and ends at the last. Unit
/// tangents, forwards, where they are asked for.
struct PieceTask {
    std::span<const Knot> knots;  ///< at least two
    std::optional<Vec2d> tangent1{}, tangent2{};
};

/// Fits single cubic Beziers by least squares, and their parameters by Newton's method, in turn:
/// Schneider, An Algorithm for Automatically Fitting Digitized Curves, Graphics Gems 1990.
class PieceFitter {
  public:
    /// False if no cubic found stays within the tolerance, pixels; the piece is then the best one.
    bool fit(const PieceTask& task, double tolerance, CurvePiece& piece);

  private:
    struct Controls {
        Vec2d first, second;
    };
    double spread_parameters(const PieceTask& task);
    Controls solve(const PieceTask& task, double arc) const;
    double project(const PieceTask& task, const Controls& controls);

    std::vector<double> parameters_;  ///< of the points, in [0, 1]
};

}  // namespace ink
