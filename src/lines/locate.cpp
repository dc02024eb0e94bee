#include "lines/locate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ink {

namespace {

/// How far two hits are from lying on one smooth surface: distance of either from the plane through
/// the other at a right angle to their mean normal.
float depth_jump(const Sample& a, const Sample& b) {
    const Vec3f normals = a.normal + b.normal;
    const float size = length(normals);
    return size > 0.0F ? std::abs(dot(b.position - a.position, normals)) / size : 0.0F;
}

/// How far the normal turns between two hits, as the chord on the unit sphere: 2 sin(angle / 2).
float turn(const Sample& a, const Sample& b) { return length(b.normal - a.normal); }

/// Which of two neighbouring intervals to keep: the one where this is larger. A sharp corner
/// halfway between two hits shows no jump, so the turn counts as well, as if over half of `scale`.
float discontinuity(const Sample& a, const Sample& b, Suspicion suspicion, float scale) {
    const float turned = turn(a, b);
    return suspicion == Suspicion::depth ? depth_jump(a, b) + 0.5F * scale * turned : turned;
}

constexpr auto kRadiansPerDegree = static_cast<float>(std::numbers::pi / 180.0);

float smoothstep(float from, float to, float x) {
    const float s = std::clamp((x - from) / (to - from), 0.0F, 1.0F);
    return s * s * (3.0F - 2.0F * s);
}

}  // namespace

Locator::Locator(const Viewpoint& viewpoint, const LocateSettings& settings)
    : viewpoint_(viewpoint),
      settings_(settings),
      least_turn_(2.0F * std::sin(0.5F * settings.crease_min_deg * kRadiansPerDegree)) {}

void Locator::locate(const SampleGrid& grid, std::span<const SuspectEdge> edges,
                     const SampleFunction& sample, std::vector<Crossing>& crossings) {
    start(grid, edges);
    jump_share_ = 1.0F;
    for (int step = 0; step < settings_.steps; ++step) {
        jump_share_ *= settings_.surviving_share;
        halve(sample);
    }
    refine_steep(sample);

    crossings.clear();
    Crossing crossing;
    for (const Interval& interval : intervals_) {
        if (classify(interval, crossing)) crossings.push_back(crossing);
    }
    // Intervals that were split off came last.
    std::ranges::stable_sort(crossings, [&](const Crossing& x, const Crossing& y) {
        if (x.edge != y.edge) return x.edge < y.edge;
        return edges[x.edge].down ? x.point.y < y.point.y : x.point.x < y.point.x;
    });
}

void Locator::start(const SampleGrid& grid, std::span<const SuspectEdge> edges) {
    intervals_.clear();
    for (std::uint32_t k = 0; k < edges.size(); ++k) {
        const SuspectEdge& edge = edges[k];
        const int i = edge.i + (edge.down ? 0 : 1);
        const int j = edge.j + (edge.down ? 1 : 0);
        const Sample a = grid.sample(grid.index(edge.i, edge.j));
        const Sample b = grid.sample(grid.index(i, j));
        intervals_.push_back({grid.point(edge.i, edge.j), grid.point(i, j), a, b, edge.suspicion,
                              true, k, depth_jump(a, b), turn(a, b)});
    }
}

void Locator::halve(const SampleFunction& sample) {
    active_.clear();
    for (std::size_t k = 0; k < intervals_.size(); ++k) {
        if (!intervals_[k].smooth) active_.push_back(k);
    }
    sample_middles(sample);
    for (std::size_t n = 0; n < active_.size(); ++n) narrow(active_[n], points_[n], samples_[n]);
}

/// Samples the middle of every active interval.
void Locator::sample_middles(const SampleFunction& sample) {
    points_.clear();
    for (const std::size_t k : active_) {
        points_.push_back((intervals_[k].a + intervals_[k].b) * 0.5F);
    }
    samples_.resize(points_.size());
    sample(points_, samples_);
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
        keep_first_half = discontinuity(interval.at_a, sample, interval.suspicion, scale) >=
                          discontinuity(sample, interval.at_b, interval.suspicion, scale);
    }
    (keep_first_half ? interval.b : interval.a) = point;
    (keep_first_half ? interval.at_b : interval.at_a) = sample;
    // Neither grows again as the interval shrinks.
    interval.smooth =
        interval.suspicion != Suspicion::id && !has_jump(interval) && !has_crease(interval);
}

bool Locator::has_jump(const Interval& interval) const {
    return interval.suspicion == Suspicion::depth &&
           depth_jump(interval.at_a, interval.at_b) > jump_share_ * interval.first_jump;
}

/// The two sides of a sharp corner do not fit one smooth surface either: what was suspected to be a
/// jump may be a crease.
bool Locator::has_crease(const Interval& interval) const {
    const float left = turn(interval.at_a, interval.at_b);
    return left > least_turn_ &&
           left > std::max(jump_share_, settings_.surviving_turn) * interval.first_turn;
}

/// Another geometry lies between: its two outlines are what is seen.
void Locator::split(std::size_t k, Vec2f point, const Sample& sample) {
    intervals_[k].suspicion = Suspicion::id;
    Interval second = intervals_[k];
    intervals_[k].b = second.a = point;
    intervals_[k].at_b = second.at_a = sample;
    // Once is enough: two lines within one lattice spacing are all that can be told apart.
    const bool may_split = intervals_[k].may_split;
    intervals_[k].may_split = second.may_split = false;
    if (may_split) intervals_.push_back(second);
}

/// Tangent of the angle between a surface and the plane across the ray that hit it.
float Locator::slope(const Sample& sample) const {
    const float cosine = std::abs(dot(sample.normal, viewpoint_.ray_direction(sample.position)));
    return std::sqrt(std::max(1.0F - cosine * cosine, 0.0F)) / std::max(cosine, 1e-6F);
}

float Locator::steeper_slope(const Interval& interval) const {
    return std::max(slope(interval.at_a), slope(interval.at_b));
}

/// Difference of the depths on the two sides.
float Locator::gap(const Interval& interval) const {
    const Vec3f chord = interval.at_b.position - interval.at_a.position;
    return std::abs(dot(chord, viewpoint_.ray_direction(interval.at_a.position)));
}

/// Whether two surfaces touch at the crossing between them, going by their depths on its two sides.
bool Locator::surfaces_meet(const Interval& interval) const {
    constexpr float kRounding = 1e-6F;  // of positions, in a scene of size 1
    const float along = gap(interval);
    if (along <= kRounding) return true;
    const bool at_limb = interval.slope > 0.0F &&
                         steeper_slope(interval) > settings_.limb_growth * interval.slope &&
                         along > settings_.limb_gap * interval.gap;
    if (at_limb) return false;
    const Vec3f chord = interval.at_b.position - interval.at_a.position;
    const float across = std::sqrt(std::max(dot(chord, chord) - along * along, 0.0F));
    const float slopes = slope(interval.at_a) + slope(interval.at_b) + 1.0F;
    return along <= settings_.meeting_slack * across * slopes;
}

/// A front surface that turns away at its limb is so steep there that a small gap behind it could
/// pass for contact.
void Locator::refine_steep(const SampleFunction& sample) {
    active_.clear();
    for (std::size_t k = 0; k < intervals_.size(); ++k) {
        Interval& interval = intervals_[k];
        if (interval.smooth || interval.at_a.id == kBackground || interval.at_b.id == kBackground ||
            !surfaces_meet(interval)) {
            continue;
        }
        const float steeper = steeper_slope(interval);
        if (steeper <= settings_.steep_slope) continue;
        interval.slope = steeper;
        interval.gap = gap(interval);
        active_.push_back(k);
    }
    for (int step = 0; step < settings_.steep_steps && !active_.empty(); ++step) {
        sample_middles(sample);
        for (std::size_t n = 0; n < active_.size(); ++n) {
            intervals_[active_[n]].may_split = false;
            narrow(active_[n], points_[n], samples_[n]);
        }
    }
}

bool Locator::classify(const Interval& interval, Crossing& crossing) const {
    const Sample& a = interval.at_a;
    const Sample& b = interval.at_b;
    crossing.point = (interval.a + interval.b) * 0.5F;
    crossing.edge = interval.edge;
    crossing.first = a.id;
    crossing.second = b.id;
    const bool a_in_front = b.id == kBackground || (a.id != kBackground && a.t <= b.t);
    crossing.nearer = a_in_front ? a.id : b.id;
    crossing.t = a_in_front ? a.t : b.t;
    crossing.strength = 1.0F;
    if (interval.suspicion == Suspicion::id) {
        const bool both = a.id != kBackground && b.id != kBackground;
        crossing.type =
            both && surfaces_meet(interval) ? LineType::intersection : LineType::silhouette;
        return a.id != b.id;
    }
    if (interval.smooth) return false;
    if (!surfaces_meet(interval)) {
        crossing.type = LineType::self_occlusion;
        return true;
    }
    if (!has_crease(interval)) return false;
    const float angle = 2.0F * std::asin(std::min(0.5F * turn(a, b), 1.0F));
    crossing.type = LineType::crease;
    crossing.strength = smoothstep(settings_.crease_min_deg * kRadiansPerDegree,
                                   settings_.crease_full_deg * kRadiansPerDegree, angle);
    return true;
}

}  // namespace ink
