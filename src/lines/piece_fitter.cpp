#include "lines/piece_fitter.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ink {

namespace {

/// A system of four linear equations; the right side is the fifth column.
using Equations = std::array<std::array<double, 5>, 4>;

/// Of equations whose matrix is symmetric, of which the upper half is read, and positive definite:
/// no pivoting.
std::array<double, 4> solution(Equations& rows) {
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < i; ++j) rows[i][j] = rows[j][i];
    }
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = i + 1; j < 4; ++j) {
            const double factor = rows[j][i] / rows[i][i];
            for (std::size_t c = i; c < 5; ++c) rows[j][c] -= factor * rows[i][c];
        }
    }
    std::array<double, 4> x{};
    for (std::size_t i = 4; i-- > 0;) {
        double value = rows[i][4];
        for (std::size_t j = i + 1; j < 4; ++j) value -= rows[i][j] * x[j];
        x[i] = value / rows[i][i];
    }
    return x;
}

}  // namespace

bool PieceFitter::fit(const PieceTask& task, double tolerance, CurvePiece& piece) {
    const double arc = spread_parameters(task);
    constexpr int kMostSteps = 6;  // more would save a node in twenty, and take twice the time
    Controls controls = solve(task, arc);
    double error = project(task, controls);
    for (int k = 1; k <= kMostSteps; ++k) {
        const double before = error;
        controls = solve(task, arc);
        error = project(task, controls);
        if (error <= tolerance) break;
        // At the rate of the last step, will the rest of them do?
        if (error * std::pow(error / before, kMostSteps - k) > tolerance) break;
    }
    piece = {to_float(controls.first), to_float(controls.second),
             to_float(task.knots.back().point)};
    piece.straight = is_straight(to_float(task.knots.front().point), piece);
    return error <= tolerance;
}

/// By the length along the points, which is returned.
double PieceFitter::spread_parameters(const PieceTask& task) {
    parameters_.assign(1, 0.0);
    for (std::size_t k = 1; k < task.knots.size(); ++k) {
        const double step = length(task.knots[k].point - task.knots[k - 1].point);
        parameters_.push_back(parameters_.back() + step);
    }
    const double arc = parameters_.back();
    for (double& u : parameters_) u /= arc > 0.0 ? arc : 1.0;
    return arc;
}

/// The controls that bring the curve, at the present parameters, nearest to the points. Each is
/// free, or free to move along a tangent.
PieceFitter::Controls PieceFitter::solve(const PieceTask& task, double arc) const {
    const Vec2d start = task.knots.front().point;
    const Vec2d end = task.knots.back().point;
    // Unknowns: how far the first control moves from the start along the directions 0 and 1, the
    // second from the end along 2 and 3. One that is bound to a tangent has one direction.
    const Vec2d chord = (end - start) * (1.0 / 3.0);
    std::array<Vec2d, 4> direction{{{1.0, 0.0}, {0.0, 1.0}, {1.0, 0.0}, {0.0, 1.0}}};
    std::array<double, 4> wished{chord.x, chord.y, -chord.x, -chord.y};
    if (task.tangent1) {
        direction[0] = *task.tangent1;
        direction[1] = {};
        wished[0] = arc / 3.0;
        wished[1] = 0.0;
    }
    if (task.tangent2) {
        direction[2] = *task.tangent2 * -1.0;
        direction[3] = {};
        wished[2] = arc / 3.0;
        wished[3] = 0.0;
    }
    // Keeps what the points leave open near a straight way; small against what they do not.
    constexpr double kRidge = 1e-3;
    Equations rows{};
    for (std::size_t i = 0; i < 4; ++i) {
        rows[i][i] = kRidge;
        rows[i][4] = kRidge * wished[i];
    }
    for (std::size_t k = 1; k + 1 < parameters_.size(); ++k) {
        const double u = parameters_[k];
        const double v = 1.0 - u;
        const double near1 = 3.0 * u * v * v;
        const double near2 = 3.0 * u * u * v;
        const Vec2d rest =
            task.knots[k].point - start * (v * v * v + near1) - end * (u * u * u + near2);
        std::array<Vec2d, 4> column;
        for (std::size_t i = 0; i < 4; ++i) column[i] = direction[i] * (i < 2 ? near1 : near2);
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = i; j < 4; ++j) rows[i][j] += dot(column[i], column[j]);
            rows[i][4] += dot(column[i], rest);
        }
    }
    std::array<double, 4> x = solution(rows);
    // A control that moves backwards or far makes a loop or a kink.
    const auto tame = [&](std::size_t i, bool bound) {
        const double size = std::hypot(x[i], x[i + 1]);
        if (bound && x[i] < 0.02 * arc) x[i] = wished[i];
        const double most = 0.9 * arc;
        if (size <= most) return;
        x[i] *= most / size;
        x[i + 1] *= most / size;
    };
    tame(0, task.tangent1.has_value());
    tame(2, task.tangent2.has_value());
    return {start + direction[0] * x[0] + direction[1] * x[1],
            end + direction[2] * x[2] + direction[3] * x[3]};
}

/// Moves each point's parameter to the nearest place on the curve by a step of Newton's method;
/// returns the largest distance.
double PieceFitter::project(const PieceTask& task, const Controls& controls) {
    const Vec2d p0 = task.knots.front().point;
    const Vec2d p3 = task.knots.back().point;
    const Vec2d a = controls.first - p0;
    const Vec2d b = controls.second - controls.first;
    const Vec2d c = p3 - controls.second;
    double worst = 0.0;
    for (std::size_t k = 1; k + 1 < parameters_.size(); ++k) {
        const Vec2d point = task.knots[k].point;
        double u = parameters_[k];
        for (int pass = 0; pass < 2; ++pass) {
            const double v = 1.0 - u;
            const Vec2d at = p0 * (v * v * v) + controls.first * (3.0 * u * v * v) +
                             controls.second * (3.0 * u * u * v) + p3 * (u * u * u);
            const Vec2d off = at - point;
            if (pass == 1) {
                worst = std::max(worst, dot(off, off));
                break;
            }
            const Vec2d speed = (a * (v * v) + b * (2.0 * u * v) + c * (u * u)) * 3.0;
            const Vec2d bend = ((b - a) * v + (c - b) * u) * 6.0;
            const double slope = dot(speed, speed) + dot(off, bend);
            if (slope > 0.0) u = std::clamp(u - dot(off, speed) / slope, 0.0, 1.0);
        }
        parameters_[k] = u;
    }
    return std::sqrt(worst);
}

}  // namespace ink
