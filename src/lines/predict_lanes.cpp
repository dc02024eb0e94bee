#include "lines/predict_lanes.h"

#include <array>
#include <cmath>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lines/predict_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// The arithmetic of predict.cpp without branches: every lane computes what any may need, and picks.

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, kLanes>;
using Floats = hn::Rebind<float, Doubles>;
using Integers = hn::Rebind<std::int32_t, Doubles>;
using Number = hn::Vec<Doubles>;
using Mask = hn::Mask<Doubles>;
constexpr Doubles kDoubles;
constexpr Floats kFloats;
constexpr Integers kIntegers;
constexpr int kStep = static_cast<int>(hn::MaxLanes(Doubles()));

HWY_INLINE Number set(double value) { return hn::Set(kDoubles, value); }
HWY_INLINE Number load(const Lanes<float>& lanes, int first) {
    return hn::PromoteTo(kDoubles, hn::LoadU(kFloats, lanes.data() + first));
}
HWY_INLINE void store(Number value, int first, Lanes<float>& lanes) {
    hn::StoreU(hn::DemoteTo(kFloats, value), kFloats, lanes.data() + first);
}
HWY_INLINE Number one() { return set(1.0); }
HWY_INLINE Number pick(Mask mask, Number yes, Number no) { return hn::IfThenElse(mask, yes, no); }

struct Vector {
    Number x, y, z;
};
HWY_INLINE Vector operator+(const Vector& a, const Vector& b) {
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Vector operator-(const Vector& a, const Vector& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vector operator*(const Vector& a, Number s) {
    return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}
HWY_INLINE Number dot(const Vector& a, const Vector& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vector cross(const Vector& a, const Vector& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
            hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE Number length(const Vector& a) { return hn::Sqrt(dot(a, a)); }

// Where seven digits are enough, a root and a division of floats take a quarter of the time.
HWY_INLINE Number rough_length(const Vector& a) {
    return hn::PromoteTo(kDoubles, hn::Sqrt(hn::DemoteTo(kFloats, dot(a, a))));
}
HWY_INLINE Number rough_ratio(Number a, Number b) {
    return hn::PromoteTo(kDoubles, hn::Div(hn::DemoteTo(kFloats, a), hn::DemoteTo(kFloats, b)));
}

HWY_INLINE Vector field_at(const Viewpoint::Affine& field, Number x, Number y) {
    const auto constant = [](Vec3d v) { return Vector{set(v.x), set(v.y), set(v.z)}; };
    return constant(field.at_zero) + constant(field.dx) * x + constant(field.dy) * y;
}

struct Ray {
    Vector origin, direction;
};
HWY_INLINE Ray ray_at(const Ray& first, const Ray& step, Number s) {
    return {first.origin + step.origin * s, first.direction + step.direction * s};
}

struct Ball {
    Vector centre;
    Number radius;
};
HWY_INLINE Ball load(const BallLanes& lanes, int first) {
    return {{load(lanes.x, first), load(lanes.y, first), load(lanes.z, first)},
            load(lanes.radius, first)};
}

struct Passage {
    Number nearest, inside;
};
HWY_INLINE Passage pass(const Ball& ball, const Ray& ray) {
    const Vector to_centre = ball.centre - ray.origin;
    const Vector across = cross(to_centre, ray.direction);
    const Number squared = hn::Mul(ball.radius, ball.radius);
    return {dot(to_centre, ray.direction),
            hn::Sub(hn::Mul(squared, dot(ray.direction, ray.direction)), dot(across, across))};
}
HWY_INLINE Number entry(const Passage& passage) {
    return hn::Sub(passage.nearest, hn::Sqrt(hn::Max(passage.inside, set(0.0))));
}
/// Whether a ray enters one ball no nearer than another, or than that one's contour where it passes
/// it. Not of unit length: the order does not depend on it. Of two roots that are compared, one is
/// taken.
HWY_INLINE Mask enters_behind(const Passage& passage, Mask at_contour, const Passage& other) {
    const Number zero = set(0.0);
    const Number inside = hn::Max(passage.inside, zero);
    const Number other_inside = pick(at_contour, zero, hn::Max(other.inside, zero));
    const Number behind = hn::Sub(passage.nearest, other.nearest);
    const Number root = hn::Sqrt(other_inside);
    const Number least = hn::Add(behind, root);
    return hn::And(hn::Ge(least, zero), hn::Ge(hn::Mul(least, least), inside));
}

/// The root of a parabola with these values at 0, 1/2 and 1, whose signs at 0 and 1 differ. Two
/// forms lose no digits; the direction in which it passes through zero tells which is between.
HWY_INLINE Number root_between(Number at_0, Number middle, Number at_1) {
    const Number zero = set(0.0);
    const Number b = hn::Sub(hn::Sub(hn::Mul(set(4.0), middle), hn::Mul(set(3.0), at_0)), at_1);
    const Number a = hn::Sub(hn::Sub(at_1, at_0), b);
    const Number root =
        hn::Sqrt(hn::Max(hn::Sub(hn::Mul(b, b), hn::Mul(hn::Mul(set(4.0), a), at_0)), zero));
    const Number q = hn::Mul(set(-0.5), hn::Add(b, hn::CopySign(root, b)));
    const Mask small = hn::Xor(hn::Lt(b, zero), hn::Le(at_0, zero));
    const Number divisor = pick(small, q, a);
    const Number s = hn::Div(pick(small, at_0, q), pick(hn::Ne(divisor, zero), divisor, one()));
    return hn::Min(hn::Max(s, zero), one());
}

/// Zero where a ray meets the plane normal . (x - centre) = height on the ball.
HWY_INLINE Number off_ball(const Ray& ray, const Ball& ball, const Vector& normal, Number height) {
    const Vector from_centre = ray.origin - ball.centre;
    const Number fall = dot(normal, ray.direction);
    const Vector at_plane =
        from_centre * fall + ray.direction * hn::Sub(height, dot(normal, from_centre));
    const Number rim = hn::Mul(ball.radius, fall);
    return hn::Sub(dot(at_plane, at_plane), hn::Mul(rim, rim));
}

HWY_INLINE Number number(Prediction::Kind kind) { return set(static_cast<double>(kind)); }

HWY_INLINE void predict(const Viewpoint& viewpoint, const EdgeLanes& edges, int i,
                        PredictionLanes& predictions) {
    const Number zero = set(0.0);
    const Number half = set(0.5);
    const auto ray = [&](Number x, Number y) {
        return Ray{field_at(viewpoint.origin, x, y), field_at(viewpoint.direction, x, y)};
    };
    const Ray ray_0 = ray(load(edges.ax, i), load(edges.ay, i));
    const Ray ray_1 = ray(load(edges.bx, i), load(edges.by, i));
    const Ray step{ray_1.origin - ray_0.origin, ray_1.direction - ray_0.direction};
    const Ray middle = ray_at(ray_0, step, half);
    const Number length_0 = rough_length(ray_0.direction);
    const Number length_1 = rough_length(ray_1.direction);
    const Ball a = load(edges.first, i);
    const Ball b = load(edges.second, i);
    const Mask first = hn::Gt(a.radius, zero);
    const Mask second = hn::Gt(b.radius, zero);
    const Passage a_0 = pass(a, ray_0);
    const Passage a_1 = pass(a, ray_1);
    const Passage b_0 = pass(b, ray_0);
    const Passage b_1 = pass(b, ray_1);
    // Whether it is a ball's outer side that was seen.
    const auto shows = [&](const Passage& passage, Number t, const Ball& ball, Number length) {
        constexpr double kRounding = 1e-3;  // of the radius
        const Number slack = hn::Mul(hn::Mul(set(kRounding), ball.radius), length);
        return hn::And(hn::Gt(passage.inside, zero),
                       hn::Lt(hn::Mul(t, length), hn::Add(passage.nearest, slack)));
    };
    const Mask first_shows = shows(a_0, load(edges.first.t, i), a, length_0);
    const Mask second_shows = shows(b_1, load(edges.second.t, i), b, length_1);
    const Mask a_ends = hn::And(first, hn::Le(a_1.inside, zero));
    const Mask b_begins = hn::And(second, hn::Le(b_0.inside, zero));
    const Number end =
        pick(a_ends, root_between(a_0.inside, pass(a, middle).inside, a_1.inside), one());
    const Number begin =
        pick(b_begins, root_between(b_0.inside, pass(b, middle).inside, b_1.inside), zero);

    // Where each ends, and where not, at the edge's ends: which of the two is in front there.
    const Ray ray_begin = ray_at(ray_0, step, begin);
    const Ray ray_end = ray_at(ray_0, step, end);
    const Passage b_begin = pass(b, ray_begin);
    const Passage a_end = pass(a, ray_end);
    const Mask second_first = enters_behind(pass(a, ray_begin), b_begins, b_begin);
    const Mask first_last = enters_behind(pass(b, ray_end), a_ends, a_end);

    const Vector normal = b.centre - a.centre;
    const Number height =
        hn::Mul(half, hn::Sub(hn::Add(dot(normal, normal), hn::Mul(a.radius, a.radius)),
                              hn::Mul(b.radius, b.radius)));
    const auto off_seam = [&](const Ray& r) { return off_ball(r, a, normal, height); };
    const Number seam_begin = off_seam(ray_begin);
    const Number seam_end = off_seam(ray_end);
    const Ray ray_between = ray_at(ray_0, step, hn::Mul(half, hn::Add(begin, end)));
    const Number seam_way = root_between(seam_begin, off_seam(ray_between), seam_end);
    const Number seam_at = hn::Add(begin, hn::Mul(hn::Sub(end, begin), seam_way));
    // Where both spheres' seams, in front and behind, lie on the edge, or none does, it is
    // searched.
    const Mask one_seam = hn::Xor(hn::Gt(seam_begin, zero), hn::Gt(seam_end, zero));

    const Mask both = hn::And(first, second);
    const Mask ends_first = hn::And(a_ends, hn::Or(hn::Not(second), first_last));
    const Mask begins_second = hn::And(b_begins, hn::Or(hn::Not(first), second_first));
    const Number none = set(PredictionLanes::kNone);
    Number kind = pick(one_seam, number(Prediction::Kind::seam), set(PredictionLanes::kSearch));
    kind = pick(hn::Or(second_first, first_last), none, kind);
    kind = pick(both, kind, none);
    kind = pick(ends_first, number(Prediction::Kind::first_contour), kind);
    kind = pick(begins_second, number(Prediction::Kind::second_contour), kind);
    const Mask gap = hn::And(both, hn::Lt(end, begin));
    kind = pick(gap, number(Prediction::Kind::gap), kind);
    kind =
        pick(hn::Or(hn::AndNot(first_shows, first), hn::AndNot(second_shows, second)), none, kind);

    Number at = pick(ends_first, end, seam_at);
    at = pick(begins_second, begin, at);
    at = pick(gap, hn::Mul(half, hn::Add(end, begin)), at);
    const Ray ray_there = ray_at(ray_0, step, at);
    const Passage a_there = pass(a, ray_there);
    Number t = pick(ends_first, a_end.nearest, entry(a_there));
    t = pick(begins_second, b_begin.nearest, t);
    t = pick(gap, hn::Min(a_there.nearest, pass(b, ray_there).nearest), t);
    t = hn::Div(t, length(ray_there.direction));
    const Number smaller = pick(both, hn::Min(a.radius, b.radius), hn::Max(a.radius, b.radius));
    const Vector across = step.origin + step.direction * rough_ratio(t, length_0);
    store(at, i, predictions.at);
    store(t, i, predictions.t);
    store(rough_ratio(hn::Mul(smaller, smaller), dot(across, across)), i,
          predictions.squared_radius);
    hn::StoreU(hn::DemoteTo(kIntegers, kind), kIntegers, predictions.kind.data() + i);
}

void predict_edges(const Viewpoint& viewpoint, const EdgeLanes& edges,
                   PredictionLanes& predictions) {
    for (int i = 0; i < kLanes; i += kStep) predict(viewpoint, edges, i, predictions);
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(predict_edges);

void predict_crossings(const Viewpoint& viewpoint, const EdgeLanes& edges,
                       PredictionLanes& predictions) {
    HWY_DYNAMIC_DISPATCH(predict_edges)(viewpoint, edges, predictions);
}

}  // namespace ink

#endif
