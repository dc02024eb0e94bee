#include "lines/locate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "lines/sample_pairs.h"

namespace ink {

namespace {

/// Which of two neighbouring intervals to keep: the one where this is larger. A sharp corner
/// halfway between two hits shows no jump, so the turn counts as well, as if over half of `scale`.
float discontinuity(const Sample& a, const Sample& b, float scale) {
    return depth_jump(a, b) + 0.5F * scale * turn(a, b);
}

constexpr auto kRadiansPerDegree = static_cast<float>(std::numbers::pi / 180.0);

float smoothstep(float from, float to, float x) {
    const float s = std::clamp((x - from) / (to - from), 0.0F, 1.0F);
    return s * s * (3.0F - 2.0F * s);
}

bool same_surface(const Sample& a, const Sample& b) { return a.id == b.id && a.ball == b.ball; }

}  // namespace

float crease_strength(const LocateSettings& settings, float angle) {
    return smoothstep(settings.crease_min_deg * kRadiansPerDegree,
                      settings.crease_full_deg * kRadiansPerDegree, angle);
}

float least_turn(const LocateSettings& settings) {
    return 2.0F * std::sin(0.5F * settings.crease_min_deg * kRadiansPerDegree);
}

Locator::Locator(const Viewpoint& viewpoint, const LocateSettings& settings, WayOutFunction way_out)
    : viewpoint_(viewpoint),
      settings_(settings),
      way_out_(std::move(way_out)),
      least_turn_(least_turn(settings)) {
    jump_shares_.push_back(1.0F);
    for (int step = 0; step < settings.steps + settings.steep_steps; ++step) {
        jump_shares_.push_back(jump_shares_.back() *
                               (step < settings.steps ? settings.surviving_share : 1.0F));
    }
}

void Locator::locate(const SampleGrid& grid, std::span<const SuspectEdge> edges,
                     const SurfaceFunction& describe, const SampleFunction& sample,
                     std::vector<Crossing>& crossings) {
    all_.resize(edges.size());
    std::iota(all_.begin(), all_.end(), 0U);
    crossings.clear();
    locate_some(grid, edges, all_, describe, sample, crossings);
}

void Locator::locate_some(const SampleGrid& grid, std::span<const SuspectEdge> edges,
                          std::span<const std::uint32_t> some, const SurfaceFunction& describe,
                          const SampleFunction& sample, std::vector<Crossing>& crossings) {
    slits_.clear();
    start(grid, edges, some, describe);
    for (;;) {
        active_.clear();
        for (std::size_t k = 0; k < intervals_.size(); ++k) {
            if (intervals_[k].state == State::open) active_.push_back(k);
        }
        if (active_.empty()) break;
        step(sample);
    }
    drop_specks(sample);
    drop_slits(grid.spacing, sample);
    refine_steep(sample);

    Crossing crossing;
    for (const Interval& interval : intervals_) {
        if (classify(interval, crossing)) crossings.push_back(crossing);
    }
}

/// Intervals go by squares of the lattice, so that rays of a packet are close together.
void Locator::start(const SampleGrid& grid, std::span<const SuspectEdge> edges,
                    std::span<const std::uint32_t> some, const SurfaceFunction& describe) {
    constexpr int kSquare = 8;
    const int across = (grid.width + kSquare - 1) / kSquare;
    const int down = (grid.height + kSquare - 1) / kSquare;
    const auto square = [&](const SuspectEdge& edge) {
        return static_cast<std::size_t>(edge.j / kSquare * across + edge.i / kSquare);
    };
    intervals_.clear();
    if (some.empty()) return;
    bins_.assign(static_cast<std::size_t>(across * down) + 1, 0);
    for (const std::uint32_t k : some) ++bins_[square(edges[k]) + 1];
    for (std::size_t k = 1; k < bins_.size(); ++k) bins_[k] += bins_[k - 1];
    order_.resize(some.size());
    for (const std::uint32_t k : some) order_[bins_[square(edges[k])]++] = k;

    intervals_.reserve(some.size());
    for (const std::uint32_t k : order_) {
        const SuspectEdge& edge = edges[k];
        const int i = edge.i + (edge.down ? 0 : 1);
        const int j = edge.j + (edge.down ? 1 : 0);
        Interval& interval = intervals_.emplace_back();
        interval.a = grid.point(edge.i, edge.j);
        interval.b = grid.point(i, j);
        interval.at_a = grid.sample(grid.index(edge.i, edge.j));
        interval.at_b = grid.sample(grid.index(i, j));
        interval.suspicion = edge.suspicion;
        interval.edge = k;
        if (describe) {
            describe(grid.index(edge.i, edge.j), interval.at_a);
            describe(grid.index(i, j), interval.at_b);
            predict(interval);
        }
        if (interval.state == State::foreseen) continue;
        interval.first_jump = depth_jump(interval.at_a, interval.at_b);
        interval.first_gap = gap(interval);
        interval.first_turn = turn(interval.at_a, interval.at_b);
    }
}

/// Computes the crossing if that can be done. If both ends saw one ball, there is none.
void Locator::predict(Interval& interval) const {
    const bool one_surface = same_surface(interval.at_a, interval.at_b);
    if (one_surface && interval.at_a.ball) {
        interval.state = State::smooth;
        return;
    }
    if (one_surface) return;
    interval.prediction =
        predict_crossing(viewpoint_, interval.a, interval.at_a, interval.b, interval.at_b);
    if (!interval.prediction) return;
    if (!needs_check(settings_, *interval.prediction)) interval.state = State::foreseen;
}

/// One more sample on every active interval.
void Locator::step(const SampleFunction& sample) {
    points_.clear();
    for (const std::size_t k : active_) points_.push_back(next_point(intervals_[k]));
    samples_.resize(points_.size());
    sample(points_, samples_);
    for (std::size_t n = 0; n < active_.size(); ++n) {
        if (intervals_[active_[n]].prediction) {
            check(active_[n], points_[n], samples_[n]);
        } else {
            narrow(active_[n], points_[n], samples_[n]);
        }
    }
}

/// Where to look next: beside the predicted crossing, or in the middle.
Vec2f Locator::next_point(const Interval& interval) const {
    if (!interval.prediction) return (interval.a + interval.b) * 0.5F;
    const float at = checked_place(settings_, *interval.prediction);
    return interval.a + (interval.b - interval.a) * at;
}

/// Keeps a prediction that the sample beside it confirms; else what it saw tells where to go on.
void Locator::check(std::size_t k, Vec2f point, const Sample& sample) {
    Interval& interval = intervals_[k];
    const Prediction::Kind kind = interval.prediction->kind;
    const bool as_first = same_surface(sample, interval.at_a);
    const bool as_second = same_surface(sample, interval.at_b);
    const bool confirmed = kind == Prediction::Kind::first_contour    ? as_second
                           : kind == Prediction::Kind::second_contour ? as_first
                                                                      : as_first || as_second;
    if (confirmed && kind != Prediction::Kind::gap) {
        interval.state = State::foreseen;
        return;
    }
    interval.prediction.reset();
    if (!as_first && !as_second) return split(k, point, sample);
    move_end(interval, !as_second, point, sample);
}

/// Makes `point` the interval's first or second end.
void Locator::move_end(Interval& interval, bool first, Vec2f point, const Sample& sample) const {
    Sample& end = first ? interval.at_a : interval.at_b;
    const float cosine = end.id == sample.id && end.id != kBackground ? facing(end) : -1.0F;
    (first ? interval.before_a : interval.before_b) = std::copysign(cosine * cosine, cosine);
    (first ? interval.point_before_a : interval.point_before_b) = first ? interval.a : interval.b;
    (first ? interval.a : interval.b) = point;
    (first ? interval.a_moved : interval.b_moved) = true;
    end = sample;
}

void Locator::narrow(std::size_t k, Vec2f point, const Sample& sample) {
    Interval& interval = intervals_[k];
    bool keep_first_half = false;
    if (interval.suspicion == Suspicion::id) {
        if (sample.id != interval.at_a.id && sample.id != interval.at_b.id) {
            return split(k, point, sample);
        }
        keep_first_half = sample.id == interval.at_b.id;
    } else {
        if (sample.id != interval.at_a.id) return split(k, point, sample);
        const float scale = length(interval.at_b.position - interval.at_a.position);
        keep_first_half = discontinuity(interval.at_a, sample, scale) >=
                          discontinuity(sample, interval.at_b, scale);
    }
    move_end(interval, !keep_first_half, point, sample);
    ++interval.steps;
    // Neither grows again as the interval shrinks.
    if (interval.suspicion != Suspicion::id && !has_jump(interval) && !has_crease(interval)) {
        interval.state = State::smooth;
    } else if (interval.steps == settings_.steps) {
        interval.state = State::located;
    }
}

float Locator::jump_share(const Interval& interval) const {
    return jump_shares_[static_cast<std::size_t>(interval.steps)];
}

bool Locator::has_jump(const Interval& interval) const {
    if (interval.suspicion == Suspicion::id) return false;
    const float share = jump_share(interval);
    return depth_jump(interval.at_a, interval.at_b) > share * interval.first_jump ||
           gap(interval) > share * interval.first_gap;
}

/// The two sides of a sharp corner do not fit one smooth surface either: what was suspected to be a
/// jump may be a crease.
bool Locator::has_crease(const Interval& interval) const {
    const float left = turn(interval.at_a, interval.at_b);
    return left > least_turn_ &&
           left > std::max(jump_share(interval), settings_.surviving_turn) * interval.first_turn;
}

/// Another geometry lies between: its two outlines are what is seen.
void Locator::split(std::size_t k, Vec2f point, const Sample& sample) {
    Interval& first = intervals_[k];
    first.suspicion = Suspicion::id;
    ++first.steps;
    Interval second = first;
    first.b = second.a = point;
    first.at_b = second.at_a = sample;
    first.b_moved = second.a_moved = true;
    if (first.steps == settings_.steps) first.state = second.state = State::located;
    // Once is enough: two lines within one lattice spacing are all that can be told apart.
    const bool may_split = first.may_split;
    first.may_split = second.may_split = false;
    if (first.state == State::open) predict(first);
    if (!may_split) return;
    if (second.state == State::open) predict(second);
    intervals_.push_back(second);
}

/// Where all steps led to a lattice point, it may be the only one to see what it sees: a ray that
/// slipped through a crack between triangles, or met one of two coincident surfaces by rounding.
/// One more sample on its other side tells. Nothing narrower than two last intervals has a line.
void Locator::drop_specks(const SampleFunction& sample) {
    active_.clear();
    points_.clear();
    for (std::size_t k = 0; k < intervals_.size(); ++k) {
        const Interval& interval = intervals_[k];
        if (interval.state != State::located || interval.a_moved == interval.b_moved) continue;
        active_.push_back(k);
        const Vec2f step = interval.b - interval.a;
        points_.push_back(interval.a_moved ? interval.b + step : interval.a - step);
    }
    samples_.resize(points_.size());
    sample(points_, samples_);
    for (std::size_t n = 0; n < active_.size(); ++n) {
        Interval& interval = intervals_[active_[n]];
        if (is_speck(interval, samples_[n])) drop_slit(interval, interval.b_moved);
    }
}

/// Whether the sample beyond the lattice point goes on with the surface before it.
bool Locator::is_speck(const Interval& interval, const Sample& beyond) const {
    const Sample& before = interval.a_moved ? interval.at_a : interval.at_b;
    if (beyond.id != before.id) return false;
    if (interval.suspicion == Suspicion::id) return true;
    const Sample& speck = interval.a_moved ? interval.at_b : interval.at_a;
    return turn(before, beyond) < 0.5F * turn(before, speck) + 1e-3F &&
           depth_jump(before, beyond) <= 0.5F * depth_jump(before, speck) + 1e-6F;
}

/// Whether two geometries meet at a crossing: what lies between two corners of one of them, however
/// narrow, is no slit.
bool Locator::touch(const Interval& interval) const {
    return interval.suspicion == Suspicion::id && interval.at_a.id != kBackground &&
           interval.at_b.id != kBackground && planes_meet(interval);
}

/// One more sample behind each crossing tells whether the surface in front goes on there. Where
/// depths are alike, either side may be the slit.
void Locator::drop_slits(float spacing, const SampleFunction& sample) {
    active_.clear();
    points_.clear();
    const auto look_beyond = [&](std::size_t k, bool second) {
        const Interval& interval = intervals_[k];
        const Vec2f across = interval.b - interval.a;
        const Vec2f step =
            across * (settings_.slit_width * spacing / std::sqrt(dot(across, across)));
        active_.push_back(2 * k + (second ? 1 : 0));
        points_.push_back(second ? interval.b + step : interval.a - step);
    };
    for (std::size_t k = 0; k < intervals_.size(); ++k) {
        const Interval& interval = intervals_[k];
        if (interval.state != State::located || touch(interval)) continue;
        const bool second_behind = lies_in_front(interval.at_a, interval.at_b);
        look_beyond(k, second_behind);
        if (interval.suspicion != Suspicion::id && !leaps(interval)) look_beyond(k, !second_behind);
    }
    samples_.resize(points_.size());
    sample(points_, samples_);
    for (std::size_t n = 0; n < active_.size(); ++n) {
        Interval& interval = intervals_[active_[n] / 2];
        const bool second = active_[n] % 2 != 0;
        const Sample& before = second ? interval.at_a : interval.at_b;
        const Sample& within = second ? interval.at_b : interval.at_a;
        if (is_slit(viewpoint_, before, within, samples_[n], least_turn_))
            drop_slit(interval, !second);
        const bool both = n > 0 && active_[n - 1] / 2 == active_[n] / 2;
        if (both && lies_in_slit(interval, samples_[n - 1], samples_[n])) {
            interval.state = State::smooth;
        }
    }
}

void Locator::drop_slit(Interval& interval, bool first_within) {
    interval.state = State::smooth;
    // Of an interval that was split, the other end is not the lattice's.
    if (first_within && interval.may_split) slits_.push_back(interval.edge);
}

/// Whether a crossing lies in a slit: the same surface on both sides of it, of which neither of its
/// own two sides is part.
bool Locator::lies_in_slit(const Interval& interval, const Sample& beyond,
                           const Sample& on_other_side) const {
    const auto apart = [&](const Sample& side) {
        return !one_surface(viewpoint_, side, beyond, least_turn_) &&
               !one_surface(viewpoint_, side, on_other_side, least_turn_);
    };
    return one_surface(viewpoint_, beyond, on_other_side, least_turn_) && apart(interval.at_a) &&
           apart(interval.at_b);
}

/// A front surface that turns away at its contour is so steep there that a small gap behind it
/// could pass for contact.
void Locator::refine_steep(const SampleFunction& sample) {
    active_.clear();
    for (std::size_t k = 0; k < intervals_.size(); ++k) {
        Interval& interval = intervals_[k];
        if (interval.state != State::located || interval.at_a.id == kBackground ||
            interval.at_b.id == kBackground || !may_meet(interval)) {
            continue;
        }
        if (steeper_slope(interval) <= settings_.steep_slope) continue;
        active_.push_back(k);
    }
    for (int step = 0; step < settings_.steep_steps && !active_.empty(); ++step) {
        for (const std::size_t k : active_) {
            intervals_[k].may_split = false;
            intervals_[k].prediction.reset();
        }
        Locator::step(sample);
    }
}

}  // namespace ink
