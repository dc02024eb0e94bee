#pragma once

#include <cstddef>
#include <vector>

#include "base/vec.h"

namespace ink {

/// A cubic Bezier from where the piece before it ends.
struct CurvePiece {
    Vec2f control1, control2, end;  ///< pixels
    bool straight = false;          ///< the controls lie on the straight way
};

struct Curve {
    Vec2f start;
    std::vector<CurvePiece> pieces;

    Vec2f end() const { return pieces.empty() ? start : pieces.back().end; }
};

/// A straight piece.
CurvePiece straight_piece(Vec2f from, Vec2f to);

/// Whether a curve's controls lie on its chord, so near that no one can see the difference.
bool is_straight(Vec2f start, const CurvePiece& piece);

/// The point at u in [0, 1] of a piece that begins at `start`.
Vec2d point_at(Vec2f start, const CurvePiece& piece, double u);

/// The same way backwards.
Curve reversed(const Curve& curve);

/// A curve that can be cut at shares of its length.
class MeasuredCurve {
  public:
    explicit MeasuredCurve(const Curve& curve);

    double length() const { return marks_.back().length; }
    /// From one share of the length to another, in [0, 1], `from` < `to`. Parts that meet share the
    /// point exactly, and together are the whole curve.
    Curve part(double from, double to) const;

  private:
    /// A place on the curve, and the length up to there.
    struct Mark {
        double length;
        double place;  ///< the piece's index plus the parameter within it
    };
    double place_of(double share) const;

    const Curve& curve_;
    std::vector<Mark> marks_;
};

}  // namespace ink
