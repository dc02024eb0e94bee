// What lies between the two ends of a located interval: contact, a contour, a rim or a crease.

#include <algorithm>
#include <cmath>

#include "lines/locate.h"
#include "lines/sample_pairs.h"

namespace ink {

namespace {

/// Whether the surface itself does not turn. Where triangles coincide, rounding chooses between
/// them, and their interpolated normals may differ without an edge.
bool one_facet(const Sample& a, const Sample& b) {
    constexpr float kOneDegree = 0.99985F;
    return dot(a.facet, b.facet) > kOneDegree;
}

/// Whether the normal is that of the surface itself, not one interpolated over a facet.
bool is_curved(const Sample& sample) {
    constexpr float kSame = 1.0F - 1e-6F;
    return dot(plane_normal(sample), sample.normal) > kSame;
}

}  // namespace

/// Cosine of the angle between a surface's normal and the ray that hit it.
float Locator::facing(const Sample& sample) const {
    return std::abs(dot(sample.normal, viewpoint_.ray_direction(sample)));
}

/// Tangent of the angle between a surface and the plane across the ray that hit it.
float Locator::slope(const Sample& sample) const {
    const float cosine = facing(sample);
    return std::sqrt(std::max(1.0F - cosine * cosine, 0.0F)) / std::max(cosine, 1e-6F);
}

float Locator::steeper_slope(const Interval& interval) const {
    return std::max(slope(interval.at_a), slope(interval.at_b));
}

/// Difference of the depths on the two sides.
float Locator::gap(const Interval& interval) const {
    const Vec3f chord = interval.at_b.position - interval.at_a.position;
    return std::abs(dot(chord, viewpoint_.ray_direction(interval.at_a)));
}

/// Distance of the two hits, seen from the viewer.
float Locator::across(const Interval& interval) const {
    const Vec3f chord = interval.at_b.position - interval.at_a.position;
    const float along = gap(interval);
    return std::sqrt(std::max(dot(chord, chord) - along * along, 0.0F));
}

/// Whether two surfaces touch at the crossing between them.
bool Locator::surfaces_meet(const Interval& interval) const {
    return planes_meet(interval) && !has_contour(interval) && !ends_before(interval);
}

/// How far the plane of b's surface lies behind that of a's, at either end.
Locator::Depths Locator::depths_between(const Interval& interval) const {
    const Sample& a = interval.at_a;
    const Sample& b = interval.at_b;
    const Vec3f ray = viewpoint_.ray_direction(a);
    const Vec3f chord = b.position - a.position;
    const auto behind_plane_of = [&](const Sample& sample) {
        const Vec3f normal = plane_normal(sample);
        return dot(normal, chord) / std::min(dot(normal, ray), -1e-6F);
    };
    return {behind_plane_of(b), behind_plane_of(a)};
}

/// Each surface goes on as its tangent plane: where they cross in between, b's lies behind a at the
/// first end and before it at the last, or the other way round.
bool Locator::planes_meet(const Interval& interval) const {
    const float contact = kPositionRounding + across(interval);
    if (gap(interval) <= contact) return true;
    const auto [at_a, at_b] = depths_between(interval);
    const float beyond = settings_.meeting_slack * (at_b - at_a);
    const auto [least, most] = std::minmax({at_a, at_b, at_a - beyond, at_b + beyond});
    return least <= contact && most >= -contact;
}

/// Whether the nearer surface could reach the other one within the interval: as it goes on now, or
/// turning away as a ball does, by twice as much as its slope tells.
bool Locator::may_meet(const Interval& interval) const {
    if (planes_meet(interval)) return true;
    const float width = across(interval);
    return gap(interval) <= kPositionRounding + width * (1.0F + 2.0F * steeper_slope(interval));
}

/// Whether the nearer surface's triangle ends on the way before its plane meets the other one's: at
/// a contour of a mesh it ends at an edge, beyond which the surface turns away.
bool Locator::ends_before(const Interval& interval) const {
    // Within one mesh, two triangles meet just where they end.
    if (!way_out_ || interval.at_a.id == interval.at_b.id || gap(interval) <= kPositionRounding ||
        steeper_slope(interval) <= settings_.steep_slope) {
        return false;
    }
    const bool a_in_front = interval.at_a.t <= interval.at_b.t;
    const Vec2f from = a_in_front ? interval.a : interval.b;
    const Vec2f way = (a_in_front ? interval.b : interval.a) - from;
    const auto [at_a, at_b] = depths_between(interval);
    const float change = a_in_front ? at_a - at_b : at_b - at_a;
    const double meets = static_cast<double>(a_in_front ? at_a : at_b) / change;
    const double ends =
        2.0 * way_out_(a_in_front ? interval.at_a : interval.at_b, from, from + way * 2.0F);
    return ends < 2.0 && ends < meets;
}

/// Whether the depths differ by more than those of one surface can that curves from one normal to
/// the other.
bool Locator::leaps(const Interval& interval) const {
    const float along = gap(interval);
    return along * (facing(interval.at_a) + facing(interval.at_b)) >
           settings_.leap * 2.0F * across(interval);
}

/// Whether the nearer surface turns away within the interval, going by how its normal turned over
/// the last step. A facet does not turn, whatever the normals between its corners do.
bool Locator::has_contour(const Interval& interval) const {
    const bool a_in_front = interval.at_a.t <= interval.at_b.t;
    const Sample& front = a_in_front ? interval.at_a : interval.at_b;
    const float before = a_in_front ? interval.before_a : interval.before_b;
    const float cosine = facing(front);
    const float now = cosine * cosine;
    if (before <= now || !is_curved(front)) return false;
    if (interval.suspicion != Suspicion::id && !leaps(interval)) return false;
    const Vec2f end = a_in_front ? interval.a : interval.b;
    const Vec2f step = end - (a_in_front ? interval.point_before_a : interval.point_before_b);
    const Vec2f across = interval.b - interval.a;
    const float stepped = std::sqrt(dot(step, step));
    const float width = std::sqrt(dot(across, across));
    return now * stepped <= settings_.contour_slack * width * (before - now);
}

bool Locator::classify(const Interval& interval, Crossing& crossing) const {
    if (interval.state == State::smooth) return false;
    const Sample& a = interval.at_a;
    const Sample& b = interval.at_b;
    crossing.edge = interval.edge;
    crossing.first = a.id;
    crossing.second = b.id;
    crossing.strength = 1.0F;
    if (interval.state == State::foreseen) {
        return cross_as_predicted(viewpoint_, settings_, *interval.prediction,
                                  {interval.a, a.id, a.t, a.ball}, {interval.b, b.id, b.t, b.ball},
                                  crossing);
    }

    crossing.point = (interval.a + interval.b) * 0.5F;
    const bool a_in_front = lies_in_front(a, b);
    crossing.nearer = a_in_front ? a.id : b.id;
    crossing.first_in_front = a_in_front;
    crossing.t = a_in_front ? a.t : b.t;
    if (interval.suspicion == Suspicion::id) {
        const bool both = a.id != kBackground && b.id != kBackground;
        crossing.type = both && surfaces_meet(interval) ? LineType::intersection
                        : ends_at_rim(interval)         ? LineType::boundary
                                                        : LineType::silhouette;
        return a.id != b.id;
    }
    if (!surfaces_meet(interval)) {
        crossing.type = ends_at_rim(interval) ? LineType::boundary : LineType::self_occlusion;
        return true;
    }
    if (!has_crease(interval) || one_facet(a, b)) return false;
    crossing.type = LineType::crease;
    crossing.strength =
        crease_strength(settings_, 2.0F * std::asin(std::min(0.5F * turn(a, b), 1.0F)));
    return true;
}

/// Whether the nearer surface ends there because it is open, and not because it turns away.
bool Locator::ends_at_rim(const Interval& interval) const {
    const Sample& a = interval.at_a;
    const Sample& b = interval.at_b;
    const bool a_in_front = lies_in_front(a, b);
    const Sample& front = a_in_front ? a : b;
    if (!std::isfinite(front.rim)) return false;
    const auto depth = static_cast<double>(front.t);
    const auto at = [&](Vec2f p) {
        return viewpoint_.origin(p) + normalize(viewpoint_.direction(p)) * depth;
    };
    const auto across = static_cast<float>(length(at(interval.b) - at(interval.a)));
    // Where the surface turns away, its slope grows without end and would make every edge near.
    const float stretch = 1.0F + std::min(slope(front), settings_.steep_slope);
    return front.rim <= settings_.rim_slack * across * stretch;
}

}  // namespace ink
