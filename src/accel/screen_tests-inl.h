// Tests of primitives against a front's rays; included once for each instruction set.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "accel/screen_kernels.h"
#include "accel/screen_lanes-inl.h"

#if defined(INKTRACE_SCREEN_TESTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef INKTRACE_SCREEN_TESTS_INL_H
#undef INKTRACE_SCREEN_TESTS_INL_H
#else
#define INKTRACE_SCREEN_TESTS_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

/// Bounds of one primitive.
struct Reach {
    float left, right, top, bottom, depth;

    HWY_INLINE Reach(const BoundsPacket& bounds, int lane)
        : left(bounds.left[lane]),
          right(bounds.right[lane]),
          top(bounds.top[lane]),
          bottom(bounds.bottom[lane]),
          depth(bounds.depth[lane]) {}
};

// ---- The nearest hit ----

/// What a primitive is called while it is tested.
struct Name {
    const ScreenPacket* packets;
    std::uint32_t winner;

    std::uint64_t rank(std::uint32_t of) const {
        const ScreenPacket& packet = packets[of / kLanes];
        return static_cast<std::uint64_t>(packet.object) << 32U |
               packet.primitive[static_cast<int>(of % kLanes)];
    }
};

/// Lanes where two surfaces coincide: the lower one counts.
HWY_INLINE void settle(Number depth, Mask around, Name name, int i, Front& front) {
    alignas(64) float depths[kStep];
    hn::Store(depth, kFloats, depths);
    for (LaneBits lanes = bits_of(around); lanes != 0; lanes &= lanes - 1) {
        const int lane = std::countr_zero(lanes);
        if (name.rank(name.winner) >= name.rank(front.winner[i + lane])) continue;
        front.depth[i + lane] = depths[lane];
        front.winner[i + lane] = name.winner;
    }
}

/// Takes the hits that lie in front of what there is; `slack`: how near to it they count as one
/// with it. There is no branch that depends on what is hit, except where surfaces coincide: a wrong
/// guess costs as much as the test.
HWY_INLINE void keep_nearer(Number depth, Mask covered, float slack, Name name, int i,
                            Front& front) {
    const auto before = load(front.depth, i);
    const auto hit = hn::And(covered, hn::Le(depth, hn::Add(before, set(slack))));
    const auto nearer = hn::And(hit, hn::Lt(depth, hn::Sub(before, set(slack))));
    const auto around = hn::AndNot(nearer, hit);
    store(hn::IfThenElse(nearer, depth, before), front.depth, i);
    const auto winners = hn::IfThenElse(hn::RebindMask(kWords, nearer),
                                        hn::Set(kWords, name.winner), load(front.winner, i));
    store(winners, front.winner, i);
    if (HWY_UNLIKELY(!hn::AllFalse(kFloats, around))) settle(depth, around, name, i, front);
}

/// The same of one lane.
HWY_INLINE void keep_nearer(float depth, bool covered, float slack, Name name, int lane,
                            Front& front) {
    const float before = front.depth[lane];
    const std::uint32_t winner = front.winner[lane];
    const bool nearer = covered & (depth < before - slack);
    front.depth[lane] = nearer ? depth : before;
    front.winner[lane] = nearer ? name.winner : winner;
    const bool around = covered & !nearer & (depth <= before + slack);
    if (HWY_UNLIKELY(around) && name.rank(name.winner) < name.rank(winner)) {
        front.depth[lane] = depth;
        front.winner[lane] = name.winner;
    }
}

// ---- Spheres ----

struct SphereTest {
    SphereForm form;
    float origin_step, slope_step;

    HWY_INLINE Mask may_cover(Mask cells, Number /*left*/, Number /*top*/, const Reach& /*reach*/,
                              float /*extent*/) const {
        return cells;
    }

    HWY_INLINE void operator()(Name name, Front& front) const {
        const auto origin = set(origin_step);
        const auto slope = set(slope_step);
        for (int i = 0; i < kLanes; i += kStep) {
            const auto qx = load(front.x, i);
            const auto qy = load(front.y, i);
            const auto dx = hn::Sub(qx, set(form.u));
            const auto dy = hn::Sub(qy, set(form.v));
            const auto across =
                hn::Mul(dx, hn::Add(hn::Mul(set(form.a), dx), hn::Mul(set(form.b), dy)));
            const auto h =
                hn::Sub(set(form.f), hn::Add(across, hn::Mul(set(form.c), hn::Mul(dy, dy))));
            const auto covered = hn::Gt(h, hn::Zero(kFloats));
            const auto along_x =
                hn::Mul(hn::Mul(qx, slope), hn::Sub(set(form.x), hn::Mul(qx, origin)));
            const auto along_y =
                hn::Mul(hn::Mul(qy, slope), hn::Sub(set(form.y), hn::Mul(qy, origin)));
            const auto m = hn::Add(hn::Add(set(form.z), along_x), along_y);
            const auto depth = hn::Mul(hn::Sub(m, hn::Sqrt(hn::Max(h, hn::Zero(kFloats)))),
                                       load(front.foreshortening, i));
            keep_nearer(depth, covered, 0.0F, name, i, front);
        }
    }
};

// ---- Triangles ----

HWY_INLINE Number line_value(const TriangleForm& form, std::size_t k, Number qx, Number qy) {
    return hn::Sub(hn::Mul(set(form.dx[k]), hn::Sub(qy, set(form.y[k]))),
                   hn::Mul(set(form.dy[k]), hn::Sub(qx, set(form.x[k]))));
}

/// Share of its terms that an edge's value may be rounded by.
constexpr float kRounding = 1e-6F;

struct TriangleTest {
    TriangleForm form;

    /// Those of the cells that are not beyond an edge, by that corner of their points which lies
    /// farthest inside.
    HWY_INLINE Mask may_cover(Mask cells, Number left, Number top, const Reach& reach,
                              float extent) const {
        // No edge is longer than the bounds, and no cell that is reached begins farther from an
        // end of one.
        const float width = reach.right - reach.left;
        const float height = reach.bottom - reach.top;
        const float slack = kRounding * (width * (height + extent) + height * (width + extent));
        for (std::size_t k = 0; k < 3; ++k) {
            const float most = (std::max(form.dx[k], 0.0F) - std::min(form.dy[k], 0.0F)) * extent;
            cells = hn::And(cells, hn::Ge(line_value(form, k, left, top), set(-(most + slack))));
        }
        return cells;
    }

    HWY_INLINE void operator()(Name name, Front& front) const {
        for (int i = 0; i < kLanes; i += kStep) {
            const auto qx = load(front.x, i);
            const auto qy = load(front.y, i);
            const auto e0 = line_value(form, 0, qx, qy);
            const auto e1 = line_value(form, 1, qx, qy);
            const auto e2 = line_value(form, 2, qx, qy);
            const auto covered = hn::Ge(hn::Min(hn::Min(e0, e1), e2), hn::Zero(kFloats));
            const auto rise = line_value(form, 3, qx, qy);
            const auto facing =
                hn::Add(hn::Add(set(form.w), hn::Mul(set(form.wx), qx)), hn::Mul(set(form.wy), qy));
            const auto plane = hn::Add(set(form.z), hn::Div(rise, facing));
            const auto depth = hn::Min(hn::Max(plane, set(form.near)), set(form.far));
            keep_nearer(depth, covered, kCoincident, name, i, front);
        }
    }
};

/// The same at one point of the front, whose lines are told side by side.
HWY_INLINE void test_point(const FormNumbers& numbers, Name name, int point, Front& front) {
    const TriangleForm form = triangle_form(numbers);
    const float qx = front.x[point];
    const float qy = front.y[point];
    const auto lines = TriangleLines(numbers).at(qx, qy);
    std::uint8_t inside[8];
    hn::StoreMaskBits(kFour, hn::Ge(lines, hn::Zero(kFour)), inside);
    constexpr unsigned kEdges = 0b111U;
    const float facing = (form.w + form.wx * qx) + form.wy * qy;
    const float plane = form.z + hn::ExtractLane(lines, 3) / facing;
    const float not_before = plane > form.near ? plane : form.near;
    const float depth = not_before < form.far ? not_before : form.far;
    keep_nearer(depth, (inside[0] & kEdges) == kEdges, kCoincident, name, point, front);
}

// ---- Glyphs ----

/// Moves the rays' points to those nearest to the origin, where they are of the shape's size, and
/// returns how far.
HWY_INLINE Number approach(LocalRays& rays) {
    const auto s = hn::Neg(hn::Div(dot(rays.p, rays.d), not_zero(dot(rays.d, rays.d))));
    rays.p = along(rays.p, rays.d, s);
    return s;
}

struct LocalHit {
    Number s;
    Mask covered;
};

HWY_INLINE LocalHit meet_ball(LocalRays rays) {
    const auto to_origin = approach(rays);
    const auto rest = hn::Sub(set(1.0F), dot(rays.p, rays.p));
    const auto covered = hn::Gt(rest, hn::Zero(kFloats));
    const auto half = hn::Sqrt(hn::Max(rest, hn::Zero(kFloats)));
    const auto speed = hn::Sqrt(dot(rays.d, rays.d));
    return {hn::Sub(to_origin, hn::Div(half, not_zero(speed))), covered};
}

/// The part of rays within |x| <= 1 along one axis.
struct Slab {
    Number lo, hi;
    HWY_INLINE Slab(Number p, Number d) {
        const auto scale = hn::Div(set(1.0F), not_zero(d));
        const auto a = hn::Mul(hn::Sub(set(-1.0F), p), scale);
        const auto b = hn::Mul(hn::Sub(set(1.0F), p), scale);
        lo = hn::Min(a, b);
        hi = hn::Max(a, b);
    }
};

HWY_INLINE LocalHit meet_box(const LocalRays& rays) {
    const Slab x(rays.p.x, rays.d.x);
    const Slab y(rays.p.y, rays.d.y);
    const Slab z(rays.p.z, rays.d.z);
    const auto entry = hn::Max(hn::Max(x.lo, y.lo), z.lo);
    const auto exit = hn::Min(hn::Min(x.hi, y.hi), z.hi);
    return {entry, hn::Le(entry, exit)};
}

/// Between its two planes the lateral surface encloses where x^2 + y^2 - r(z)^2 < 0, with
/// r(z) = middle + slope z.
HWY_INLINE LocalHit meet_frustum(LocalRays rays, float slope, float middle, bool capped) {
    const auto to_origin = approach(rays);
    const auto& [p, d] = rays;
    const Slab slab(p.z, d.z);
    const auto radius = hn::Add(set(middle), hn::Mul(set(slope), p.z));
    const auto growth = hn::Mul(set(slope), d.z);
    const auto a = hn::Sub(hn::Add(hn::Mul(d.x, d.x), hn::Mul(d.y, d.y)), hn::Mul(growth, growth));
    const auto b = hn::Sub(hn::Add(hn::Mul(p.x, d.x), hn::Mul(p.y, d.y)), hn::Mul(radius, growth));
    const auto c = hn::Sub(hn::Add(hn::Mul(p.x, p.x), hn::Mul(p.y, p.y)), hn::Mul(radius, radius));
    const auto rest = hn::Sub(hn::Mul(b, b), hn::Mul(a, c));
    // Of rays along the axis of a cylinder nothing is left: they run beside it for ever.
    const auto real = hn::Gt(rest, hn::Zero(kFloats));
    const auto root = hn::Sqrt(hn::Max(rest, hn::Zero(kFloats)));
    // The sum of b and root of one sign loses no digits; the other crossing follows from c.
    const auto sum = hn::Neg(hn::Add(b, hn::CopySign(root, b)));
    const auto one = hn::Div(sum, not_zero(a));
    const auto two = hn::Div(c, not_zero(sum));
    const auto first = hn::Min(one, two);
    const auto second = hn::Max(one, two);
    const auto within = [&](Number s) {
        const auto z = hn::Add(p.z, hn::Mul(s, d.z));
        const auto r = hn::Add(set(middle), hn::Mul(set(slope), z));
        return hn::And(hn::And(hn::Ge(s, slab.lo), hn::Le(s, slab.hi)),
                       hn::Ge(r, hn::Zero(kFloats)));
    };
    const auto on_first = hn::And(real, within(first));
    const auto on_second = hn::And(real, within(second));
    auto s = hn::IfThenElse(on_first, first, second);
    auto covered = hn::Or(on_first, on_second);
    if (capped) {
        const auto at = along(p, d, slab.lo);
        const auto r = hn::Add(set(middle), hn::Mul(set(slope), at.z));
        const auto inside =
            hn::Lt(hn::Add(hn::Mul(at.x, at.x), hn::Mul(at.y, at.y)), hn::Mul(r, r));
        s = hn::IfThenElse(inside, slab.lo, s);
        covered = hn::Or(covered, inside);
    }
    return {hn::Add(to_origin, s), covered};
}

HWY_INLINE LocalHit meet_plane(const LocalRays& rays, bool round) {
    const auto s = hn::Neg(hn::Div(rays.p.z, not_zero(rays.d.z)));
    const auto at = along(rays.p, rays.d, s);
    const auto one = set(1.0F);
    const auto in_disc = hn::Le(hn::Add(hn::Mul(at.x, at.x), hn::Mul(at.y, at.y)), one);
    const auto in_square = hn::And(hn::Le(hn::Abs(at.x), one), hn::Le(hn::Abs(at.y), one));
    return {s, round ? in_disc : in_square};
}

template <GlyphKind kKind>
struct GlyphTest {
    GlyphForm form;
    float slope, middle;
    bool capped;

    HWY_INLINE Mask may_cover(Mask cells, Number /*left*/, Number /*top*/, const Reach& /*reach*/,
                              float /*extent*/) const {
        return cells;
    }

    HWY_INLINE LocalHit meet(const LocalRays& rays) const {
        if constexpr (kKind == GlyphKind::ellipsoid) return meet_ball(rays);
        if constexpr (kKind == GlyphKind::box) return meet_box(rays);
        if constexpr (kKind == GlyphKind::frustum) {
            return meet_frustum(rays, slope, middle, capped);
        }
        if constexpr (kKind == GlyphKind::disc) return meet_plane(rays, true);
        if constexpr (kKind == GlyphKind::rectangle) return meet_plane(rays, false);
    }

    HWY_INLINE void operator()(Name name, Front& front) const {
        constexpr bool kRound = kKind == GlyphKind::ellipsoid || kKind == GlyphKind::frustum;
        for (int i = 0; i < kLanes; i += kStep) {
            const LocalRays rays = local_rays(form, load(front.x, i), load(front.y, i));
            const LocalHit hit = meet(rays);
            const auto depth = hn::Add(set(form.z), hit.s);
            keep_nearer(depth, hit.covered, kRound ? 0.0F : kCoincident, name, i, front);
        }
    }
};

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
