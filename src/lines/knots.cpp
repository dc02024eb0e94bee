#include "lines/knots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace ink {

namespace {

constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);

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

void KnotLine::take(std::span<const Vec2f> points, bool closed, std::span<const std::size_t> cuts) {
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
std::size_t KnotLine::step(std::size_t k, int direction) const {
    const std::size_t last = knots_.size() - 1;
    if (k == (direction > 0 ? last : 0)) {
        if (!closed_ || last < 2) return kNowhere;
        k = direction > 0 ? 0 : last;
    }
    return direction > 0 ? k + 1 : k - 1;
}

bool KnotLine::starts_anywhere() const {
    return closed_ && std::none_of(knots_.begin() + 1, knots_.end() - 1,
                                   [](const Knot& knot) { return knot.cut; });
}

/// How the line comes to a knot from one side.
std::optional<Parabola> KnotLine::side(std::size_t at, int direction) const {
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

std::optional<Vec2d> KnotLine::smooth_tangent(std::size_t k) const {
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
KnotLine::Corner KnotLine::corner_between(std::size_t from, std::size_t to) const {
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
/// After `round` knots a line begins again.
void KnotLine::keep_sharpest(std::vector<Corner>& corners, std::size_t round) {
    constexpr std::size_t kSame = 2;  // knots, between which there is one corner at most
    constexpr double kEcho = 0.5;     // of the sharper one, within reach of its windows
    const auto yields_to = [&](const Corner& corner, const Corner& other) {
        const std::size_t apart =
            other.after > corner.after ? other.after - corner.after : corner.after - other.after;
        const std::size_t knots = std::min(apart, round - apart);
        const bool sharper = other.excess > corner.excess;
        // Of a corner at a cut, the place is known.
        if (knots <= kSame) return corner.at_cut == other.at_cut ? sharper : other.at_cut;
        return sharper && knots <= kReach + 1 && corner.excess < kEcho * other.excess;
    };
    const std::size_t count = corners.size();
    const std::size_t window = std::min<std::size_t>(kReach + 1, count - 1);
    std::vector<Corner> kept;
    for (std::size_t k = 0; k < count; ++k) {
        bool yields = false;
        for (std::size_t n = 1; n <= window && !yields; ++n) {
            yields = yields_to(corners[k], corners[(k + n) % count]) ||
                     yields_to(corners[k], corners[(k + count - n) % count]);
        }
        if (!yields) kept.push_back(corners[k]);
    }
    corners = std::move(kept);
}

std::vector<KnotLine::Corner> KnotLine::corners(double least_turn) const {
    const std::size_t last = knots_.size() - 1;
    std::vector<Corner> corners;
    if (last < 3) return corners;
    // Where a closed line without junctions starts is no matter.
    const bool any_start = starts_anywhere();
    const auto is_cut = [&](std::size_t k) {
        return knots_[k].cut && !(any_start && (k == 0 || k == last));
    };
    for (std::size_t k = 0; k < last; ++k) {
        Corner corner;
        if (knots_[k].corner) continue;
        if (is_cut(k)) {
            const std::size_t from = step(k, -1);
            if (from == kNowhere) continue;
            corner = corner_between(from, k + 1);
            corner = {k, corner.excess, true};
        } else if (!is_cut(k + 1)) {
            corner = corner_between(k, k + 1);
        }
        if (corner.excess > least_turn) corners.push_back(corner);
    }
    if (corners.empty()) return corners;
    constexpr auto kNever = std::numeric_limits<std::size_t>::max();
    keep_sharpest(corners, closed_ ? last : kNever);
    return corners;
}

void KnotLine::mark_corner(std::size_t cut) {
    knots_[cut].corner = true;
    if (closed_ && cut == 0) knots_.back().corner = true;
}

void KnotLine::add_corners(std::span<const Corner> corners) {
    if (corners.empty()) return;
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
    start_at_corner();
}

/// A closed line without junctions may start anywhere: at a corner it needs no other break.
void KnotLine::start_at_corner() {
    if (!starts_anywhere()) return;
    knots_.pop_back();
    knots_.front().cut = false;
    const auto first = std::ranges::find_if(knots_, &Knot::corner);
    std::ranges::rotate(knots_, first);
    knots_.front().cut = true;
    knots_.push_back(knots_.front());
}

bool KnotLine::is_straight(std::size_t first, std::size_t last, double most) const {
    const Vec2d a = knots_[first].point;
    const Vec2d b = knots_[last].point;
    if (distance(a, b) == 0.0) return false;
    for (std::size_t k = first + 1; k < last; ++k) {
        if (distance_from_line(knots_[k].point, a, b) > most) return false;
    }
    return true;
}

}  // namespace ink
