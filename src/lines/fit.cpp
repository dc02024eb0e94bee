#include "lines/fit.h"

#include <algorithm>
#include <numbers>
#include <utility>

namespace ink {

namespace {

/// Share of the tolerance within which a run of points counts as straight.
constexpr double kStraightShare = 0.6;

}  // namespace

void CurveFitter::fit(std::span<const Vec2f> points, bool closed, std::span<const std::size_t> cuts,
                      std::span<const std::size_t> corners, std::vector<Curve>& curves) {
    line_.take(points, closed, cuts);
    for (const std::size_t cut : corners) line_.mark_corner(cut);
    line_.add_corners(line_.corners(kCornerDeg * std::numbers::pi / 180.0));
    const std::span<const Knot> knots = line_.knots();
    curve_.start = to_float(knots.front().point);
    curve_.pieces.clear();
    const auto is_break = [&](std::size_t k, bool corners_only) {
        return k + 1 == knots.size() || knots[k].corner || (knots[k].cut && !corners_only);
    };
    for (std::size_t begin = 0, corner = 0; begin + 1 < knots.size();) {
        if (begin == corner) {
            while (!is_break(++corner, true)) {
            }
        }
        std::size_t end = begin;
        const bool straight =
            line_.is_straight(begin, corner, kStraightShare * settings_.tolerance);
        while (end < corner) {
            const std::size_t from = end;
            while (!is_break(++end, false)) {
            }
            if (straight) {
                curve_.pieces.push_back(
                    straight_piece(to_float(knots[from].point), to_float(knots[end].point)));
            } else {
                fit_between(from, end);
            }
            if (!knots[end].cut) continue;
            const Vec2f next = curve_.pieces.back().end;
            curves.push_back(std::exchange(curve_, Curve{next, {}}));
        }
        begin = end;
    }
}

bool CurveFitter::fit_piece(std::size_t first, std::size_t last, double tolerance,
                            CurvePiece& piece) {
    return fitter_.fit({line_.knots().subspan(first, last - first + 1), line_.smooth_tangent(first),
                        line_.smooth_tangent(last)},
                       tolerance, piece);
}

/// Curves from one corner or cut to the next.
void CurveFitter::fit_between(std::size_t first, std::size_t last) {
    CurvePiece piece;
    if (fit_piece(first, last, settings_.tolerance, piece)) {
        curve_.pieces.push_back(piece);
        return;
    }
    std::size_t count = place_ends(first, last, settings_.tolerance, last - first);
    best_ends_ = ends_;
    // The last piece is mostly short. With a smaller tolerance and no more pieces, all fit better.
    double lower = 0.0;
    double upper = settings_.tolerance;
    for (int k = 0; k < 3 && count < last - first; ++k) {
        const double middle = 0.5 * (lower + upper);
        const bool enough = place_ends(first, last, middle, count) <= count;
        (enough ? upper : lower) = middle;
        if (enough) best_ends_ = ends_;
    }
    std::size_t begin = first;
    for (const std::size_t end : best_ends_) {
        fit_piece(begin, end, settings_.tolerance, piece);
        curve_.pieces.push_back(piece);
        begin = end;
    }
}

/// Ends of pieces, each as far as the tolerance allows, into `ends_`. Gives up after `most` of
/// them; returns their number, or more than `most`.
std::size_t CurveFitter::place_ends(std::size_t first, std::size_t last, double tolerance,
                                    std::size_t most) {
    ends_.clear();
    std::size_t guess = 2 * KnotLine::kReach;
    for (std::size_t begin = first; begin < last;) {
        if (ends_.size() == most) return most + 1;
        const std::size_t end = farthest(begin, last, guess, tolerance);
        guess = end - begin;
        ends_.push_back(end);
        begin = end;
    }
    return ends_.size();
}

/// The farthest knot that one piece can reach, looking about `guess` knots ahead first.
std::size_t CurveFitter::farthest(std::size_t first, std::size_t last, std::size_t guess,
                                  double tolerance) {
    CurvePiece piece;
    std::size_t good = first + 1;
    std::size_t bad = last + 1;
    for (std::size_t reach = std::max<std::size_t>(guess, 2); good < last && bad > last;
         reach *= 2) {
        const std::size_t end = std::min(first + reach, last);
        if (end <= good) continue;
        (fit_piece(first, end, tolerance, piece) ? good : bad) = end;
    }
    while (bad > good + 1 + (good - first) / 16) {
        const std::size_t middle = good + (bad - good) / 2;
        if (middle > last) break;
        (fit_piece(first, middle, tolerance, piece) ? good : bad) = middle;
    }
    return good;
}

}  // namespace ink
