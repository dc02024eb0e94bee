#pragma once

#include <cstddef>
#include <span>

#include "base/vec.h"

namespace ink {

/// point + s tangent + s^2 bend.
struct Parabola {
    Vec2d point, tangent, bend;

    Vec2d at(double s) const { return point + tangent * s + bend * (s * s); }
    /// Signed, at s = 0: positive where the curve turns clockwise on the screen.
    double curvature() const;
};

/// A point at the distance s along a line, counted from anywhere.
struct LinePoint {
    double s;
    Vec2d point;
};

/// Least squares through at least two points of different s; two or three lie on it.
Parabola fit_parabola(std::span<const LinePoint> points);

}  // namespace ink
