#include "lines/fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace ink {

namespace {

constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);

/// Points on each side of a knot that say where the line goes from there: enough to average the
/// error of crossings, few enough for a circle of three pixels.
constexpr int kReach = 4;

/// Share of the tolerance within which a run of points counts as straight: crossings are more exact
/// than the curves need to be.
constexpr double kStraightShare = 0.3;

double distance(Vec2d a, Vec2d b) { return length(b - a); }

Vec2d unit(Vec2d v) {
    const double size = length(v);
    return size > 0.0 ? v * (1.0 / size) : v;
}

/// From the straight line through a and b; from a if they are one.
double distance_from_line(Vec2d p, Vec2d a, Vec2d b) {
    const Vec2d along = unit(b - a);
    return along == Vec2d{} ? distance(p, a) : std::abs(cross(along, p - a));
}

}  // namespace

void CurveFitter::fit(std::span<const Vec2f> points, bool closed, std::span<const std::size_t> cuts,
                      std::vector<Curve>& curves) {
    take(points, closed, cuts);
    find_corners();
    curve_.start = to_float(knots_.front().point);
    curve_.pieces.clear();
    const auto is_break = [&](std::size_t k, bool corners_only) {
        return k + 1 == knots_.size() || knots_[k].corner || (knots_[k].cut && !corners_only);
    };
    for (std::size_t begin = 0, corner = 0; begin + 1 < knots_.size();) {
        if (begin == corner) {
            while (!is_break(++corner, true)) {
            }
        }
        std::size_t end = begin;
        const bool straight = is_straight(begin, corner);
        while (end < corner) {
            const std::size_t from = end;
            while (!is_break(++end, false)) {
            }
            if (straight) {
                curve_.pieces.push_back(
                    straight_piece(to_float(knots_[from].point), to_float(knots_[end].point)));
            } else {
                fit_between(from, end);
            }
            if (!knots_[end].cut) continue;
            const Vec2f next = curve_.pieces.back().end;
            curves.push_back(std::exchange(curve_, Curve{next, {}}));
        }
        begin = end;
    }
}

void CurveFitter::take(std::span<const Vec2f> points, bool closed,
                       std::span<const std::size_t> cuts) {
    closed_ = closed;
    knots_.clear();
    for (const Vec2f point : points) knots_.push_back({to_double(point)});
    if (closed) knots_.push_back(knots_.front());
    for (const std::size_t cut : cuts) knots_[cut].cut = true;
    if (!closed) knots_.front().corner = knots_.back().corner = true;
    double total = 0.0;
    for (std::size_t k = 1; k < knots_.size(); ++k) {
        total += distance(knots_[k - 1].point, knots_[k].point);
    }
    mean_step_ = total / static_cast<double>(knots_.size() - 1);
}

/// The next knot that way, or kNowhere beyond the end of the line or a corner.
std::size_t CurveFitter::step(std::size_t k, int direction) const {
    const std::size_t last = knots_.size() - 1;
    if (k == (direction > 0 ? last : 0)) {
        if (!closed_ || last < 2) return kNowhere;
        k = direction > 0 ? 0 : last;
    }
    return direction > 0 ? k + 1 : k - 1;
}

/// How the line comes to a knot from one side.
std::optional<Parabola> CurveFitter::side(std::size_t at, int direction) const {
    std::array<LinePoint, kReach + 1> points;
    std::size_t count = 0;
    double s = 0.0;
    for (std::size_t k = at; k != kNowhere && count < points.size(); k = step(k, direction)) {
        const Vec2d point = knots_[k].point;
        if (count > 0) s += distance(points[count - 1].point, point);
        points[count++] = {s, point};
        if (count > 1 && knots_[k].corner) break;
    }
    // Two crossings may lie next to each other, and then their error is all that they show.
    if (count < 3 || s < 1.5 * mean_step_) return std::nullopt;
    // Nor do three show a curvature.
    if (count == 3) return fit_parabola(std::array{points[0], points[2]});
    return fit_parabola({points.data(), count});
}

/// Unit tangent, forwards, of the line through a knot, from both of its sides.
std::optional<Vec2d> CurveFitter::smooth_tangent(std::size_t k) const {
    if (knots_[k].corner) return std::nullopt;
    std::array<LinePoint, 2 * kReach + 1> points;
    std::size_t count = 0;
    points[count++] = {0.0, knots_[k].point};
    for (const int direction : {-1, 1}) {
        double s = 0.0;
        Vec2d before = knots_[k].point;
        std::size_t n = k;
        for (int taken = 0; taken < kReach; ++taken) {
            n = step(n, direction);
            if (n == kNowhere) break;
            s += distance(before, knots_[n].point);
            before = knots_[n].point;
            points[count++] = {direction * s, before};
            if (knots_[n].corner) break;
        }
    }
    if (count < 3) return std::nullopt;
    const Vec2d tangent = unit(fit_parabola({points.data(), count}).tangent);
    if (tangent == Vec2d{} || !std::isfinite(tangent.x + tangent.y)) return std::nullopt;
    return tangent;
}

/// How much the line turns from one knot to another one soon after it, beyond its curves there.
CurveFitter::Corner CurveFitter::corner_between(std::size_t from, std::size_t to) const {
    Corner corner{from};
    const auto before = side(from, -1);
    const auto after = side(to, 1);
    if (!before || !after) return corner;
    const Vec2d in = unit(before->tangent * -1.0);
    const Vec2d out = unit(after->tangent);
    const double angle = std::atan2(cross(in, out), dot(in, out));
    const double gap = distance(knots_[from].point, knots_[to].point);
    corner.excess = std::abs(angle - 0.5 * gap * (after->curvature() - before->curvature()));
    // On a circle of a pixel or two the curvature explains the turn only roughly.
    constexpr double kUnexplained = 0.6;
    if (corner.excess < kUnexplained * std::abs(angle)) corner.excess = 0.0;
    // Where the two tangents meet, if that is between the knots.
    const double sine = cross(in, out);
    const Vec2d across = after->point - before->point;
    const double ahead = cross(across, out) / sine;
    const double behind = cross(across, in) / sine;
    if (ahead > 0.02 * gap && -behind > 0.02 * gap && ahead < 2.0 * gap && -behind < 2.0 * gap) {
        corner.point = before->point + in * ahead;
    }
    return corner;
}

/// Windows that reach over a corner see something of it, too: drops what is near a sharper one.
void CurveFitter::keep_sharpest(std::vector<Corner>& corners) {
    constexpr std::size_t kSame = 2;  // knots, between which there is one corner at most
    constexpr double kEcho = 0.5;     // of the sharper one, within reach of its windows
    std::vector<Corner> kept;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const auto yields_to = [&](const Corner& other) {
            const std::size_t apart = other.after > corners[k].after
                                          ? other.after - corners[k].after
                                          : corners[k].after - other.after;
            const bool sharper = other.excess > corners[k].excess;
            return sharper && (apart <= kSame ||
                               (apart <= kReach + 1 && corners[k].excess < kEcho * other.excess));
        };
        const auto begin = corners.begin() + static_cast<std::ptrdiff_t>(k);
        const auto before = std::min<std::size_t>(k, kReach + 1);
        const auto after = std::min<std::size_t>(corners.size() - k, kReach + 2);
        if (std::none_of(begin - static_cast<std::ptrdiff_t>(before),
                         begin + static_cast<std::ptrdiff_t>(after), yields_to)) {
            kept.push_back(corners[k]);
        }
    }
    corners = std::move(kept);
}

void CurveFitter::find_corners() {
    const std::size_t last = knots_.size() - 1;
    if (last < 3) return;
    const double least = settings_.corner_deg * std::numbers::pi / 180.0;
    std::vector<Corner> corners;
    for (std::size_t k = 0; k < last; ++k) {
        Corner corner;
        if (knots_[k].cut) {
            const std::size_t from = step(k, -1);
            if (from == kNowhere) continue;
            corner = corner_between(from, k + 1);
            corner.after = k;
            corner.point.reset();
        } else if (!knots_[k + 1].cut) {
            corner = corner_between(k, k + 1);
        }
        if (corner.excess > least) corners.push_back(corner);
    }
    keep_sharpest(corners);
    if (corners.empty()) return;
    add_corners(corners);
    start_at_corner();
}

void CurveFitter::add_corners(std::span<const Corner> corners) {
    std::vector<Knot> knots;
    knots.reserve(knots_.size() + corners.size());
    auto corner = corners.begin();
    for (std::size_t k = 0; k < knots_.size(); ++k) {
        knots.push_back(knots_[k]);
        if (corner == corners.end() || corner->after != k) continue;
        if (corner->point) {
            knots.push_back({*corner->point, false, true});
        } else {
            knots.back().corner = true;
        }
        ++corner;
    }
    knots_ = std::move(knots);
    if (closed_ && knots_.front().corner) knots_.back().corner = true;
}

/// A closed line without junctions may start anywhere: at a corner it needs no other break.
void CurveFitter::start_at_corner() {
    const auto inner = [](const Knot& knot) { return knot.cut; };
    if (!closed_ || std::count_if(knots_.begin() + 1, knots_.end() - 1, inner) > 0) return;
    knots_.pop_back();
    knots_.front().cut = false;
    const auto first = std::ranges::find_if(knots_, &Knot::corner);
    std::ranges::rotate(knots_, first);
    knots_.front().cut = true;
    knots_.push_back(knots_.front());
}

bool CurveFitter::is_straight(std::size_t first, std::size_t last) const {
    const Vec2d a = knots_[first].point;
    const Vec2d b = knots_[last].point;
    const double most = kStraightShare * settings_.tolerance;
    if (distance(a, b) == 0.0) return false;
    for (std::size_t k = first + 1; k < last; ++k) {
        if (distance_from_line(knots_[k].point, a, b) > most) return false;
    }
    return true;
}

CurveFitter::Span CurveFitter::span(std::size_t first, std::size_t last) const {
    return {first, last, smooth_tangent(first), smooth_tangent(last)};
}

/// Curves from one corner or cut to the next.
void CurveFitter::fit_between(std::size_t first, std::size_t last) {
    CurvePiece piece;
    if (fit_piece(span(first, last), settings_.tolerance, piece)) {
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
        fit_piece(span(begin, end), settings_.tolerance, piece);
        curve_.pieces.push_back(piece);
        begin = end;
    }
}

/// Ends of pieces, each as far as the tolerance allows, into `ends_`. Gives up after `most` of
/// them; returns their number, or more than `most`.
std::size_t CurveFitter::place_ends(std::size_t first, std::size_t last, double tolerance,
                                    std::size_t most) {
    ends_.clear();
    std::size_t guess = 2 * kReach;
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
        (fit_piece(span(first, end), tolerance, piece) ? good : bad) = end;
    }
    while (bad > good + 1 + (good - first) / 16) {
        const std::size_t middle = good + (bad - good) / 2;
        if (middle > last) break;
        (fit_piece(span(first, middle), tolerance, piece) ? good : bad) = middle;
    }
    return good;
}

/// False if no cubic found stays within the tolerance; the piece is then the best one.
bool CurveFitter::fit_piece(const Span& span, double tolerance, CurvePiece& piece) {
    parameters_.clear();
    double arc = 0.0;
    for (std::size_t k = span.first; k <= span.last; ++k) {
        if (k > span.first) arc += distance(knots_[k - 1].point, knots_[k].point);
        parameters_.push_back(arc);
    }
    for (double& u : parameters_) u /= arc > 0.0 ? arc : 1.0;

    constexpr int kMostSteps = 24;
    Controls controls = solve(span, arc);
    double error = project(span, controls);
    for (int k = 1; k <= kMostSteps; ++k) {
        const double before = error;
        controls = solve(span, arc);
        error = project(span, controls);
        if (error <= tolerance) break;
        // At the rate of the last step, will the rest of them do?
        if (error * std::pow(error / before, kMostSteps - k) > tolerance) break;
    }
    piece = {to_float(controls.first), to_float(controls.second),
             to_float(knots_[span.last].point)};
    piece.straight = ink::is_straight(to_float(knots_[span.first].point), piece);
    return error <= tolerance;
}

/// The controls that bring the curve, at the present parameters, nearest to the points. Each is
/// free, or free to move along a tangent.
CurveFitter::Controls CurveFitter::solve(const Span& span, double arc) const {
    const Vec2d start = knots_[span.first].point;
    const Vec2d end = knots_[span.last].point;
    // Unknowns: how far the first control moves from the start along the directions 0 and 1, the
    // second from the end along 2 and 3. One that is bound to a tangent has one direction.
    const Vec2d chord = (end - start) * (1.0 / 3.0);
    std::array<Vec2d, 4> direction{{{1.0, 0.0}, {0.0, 1.0}, {1.0, 0.0}, {0.0, 1.0}}};
    std::array<double, 4> wished{chord.x, chord.y, -chord.x, -chord.y};
    if (span.tangent1) {
        direction[0] = *span.tangent1;
        direction[1] = {};
        wished[0] = arc / 3.0;
        wished[1] = 0.0;
    }
    if (span.tangent2) {
        direction[2] = *span.tangent2 * -1.0;
        direction[3] = {};
        wished[2] = arc / 3.0;
        wished[3] = 0.0;
    }
    // Keeps what the points leave open near a straight way; small against what they do not.
    constexpr double kRidge = 1e-3;
    std::array<std::array<double, 5>, 4> rows{};
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
            knots_[span.first + k].point - start * (v * v * v + near1) - end * (u * u * u + near2);
        std::array<Vec2d, 4> column;
        for (std::size_t i = 0; i < 4; ++i) column[i] = direction[i] * (i < 2 ? near1 : near2);
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = i; j < 4; ++j) rows[i][j] += dot(column[i], column[j]);
            rows[i][4] += dot(column[i], rest);
        }
    }
    // The matrix is symmetric and, thanks to the ridge, positive definite: no pivoting.
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
    // A control that moves backwards or far makes a loop or a kink.
    const auto tame = [&](std::size_t i, bool bound) {
        const double size = std::hypot(x[i], x[i + 1]);
        if (bound && x[i] < 0.02 * arc) x[i] = wished[i];
        const double most = 0.9 * arc;
        if (size <= most) return;
        x[i] *= most / size;
        x[i + 1] *= most / size;
    };
    tame(0, span.tangent1.has_value());
    tame(2, span.tangent2.has_value());
    return {start + direction[0] * x[0] + direction[1] * x[1],
            end + direction[2] * x[2] + direction[3] * x[3]};
}

/// Moves each point's parameter to the nearest place on the curve by a step of Newton's method;
/// returns the largest distance.
double CurveFitter::project(const Span& span, const Controls& controls) {
    const Vec2d p0 = knots_[span.first].point;
    const Vec2d p3 = knots_[span.last].point;
    const Vec2d a = controls.first - p0;
    const Vec2d b = controls.second - controls.first;
    const Vec2d c = p3 - controls.second;
    double worst = 0.0;
    for (std::size_t k = 1; k + 1 < parameters_.size(); ++k) {
        const Vec2d point = knots_[span.first + k].point;
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
