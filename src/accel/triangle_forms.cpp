#include "accel/screen_packets.h"

#include <array>
#include <limits>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/triangle_forms.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "accel/screen_forms-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

/// A corner: right, down and forward from the start, and on the screen.
struct Corner {
    Triple p;
    Half u, v;
};

HWY_INLINE Corner project(const Basis& basis, const Points& points, int i) {
    const Triple p = to_camera(basis, load(points, i));
    const Double scale = basis.orthographic ? number(1.0 / basis.origin_step)
                                            : hn::Div(number(1.0 / basis.slope_step),
                                                      hn::Add(p.z, number(basis.start_depth)));
    return {p, rounded(hn::Mul(p.x, scale)), rounded(hn::Mul(p.y, scale))};
}

HWY_INLINE void keep(const Corner& corner, int i, ScreenCorners::Corner& to) {
    put(corner.u, to.u, i);
    put(corner.v, to.v, i);
    put(corner.p.z, to.depth, i);
}

/// Edge k of a TriangleForm from corner `a` to corner `b`, its inside on the left if `side` is 1,
/// else -1.
HWY_INLINE void lay_edge(const Corner& a, const Corner& b, Half side, int i, std::size_t k,
                         FormLanes& form) {
    const auto swap = hn::Or(hn::Lt(b.u, a.u), hn::And(hn::Eq(b.u, a.u), hn::Lt(b.v, a.v)));
    const Half sign = hn::IfThenElse(swap, hn::Neg(side), side);
    const Half x0 = hn::IfThenElse(swap, b.u, a.u);
    const Half y0 = hn::IfThenElse(swap, b.v, a.v);
    const Half x1 = hn::IfThenElse(swap, a.u, b.u);
    const Half y1 = hn::IfThenElse(swap, a.v, b.v);
    put(x0, form[k], i);
    put(y0, form[4 + k], i);
    put(hn::Mul(sign, hn::Sub(x1, x0)), form[8 + k], i);
    put(hn::Mul(sign, hn::Sub(y1, y0)), form[12 + k], i);
}

/// Brings the corner that comes first on the screen to the front.
HWY_INLINE void order(Corner& first, Corner& second) {
    const auto swap = hn::Or(hn::Lt(second.u, first.u),
                             hn::And(hn::Eq(second.u, first.u), hn::Lt(second.v, first.v)));
    const auto wide = hn::Gt(hn::PromoteTo(kDoubles, hn::IfThenElseZero(swap, number_f(1.0F))),
                             hn::Zero(kDoubles));
    const auto exchange = [](auto mask, auto& a, auto& b) {
        const auto old = a;
        a = hn::IfThenElse(mask, b, a);
        b = hn::IfThenElse(mask, old, b);
    };
    exchange(swap, first.u, second.u);
    exchange(swap, first.v, second.v);
    exchange(wide, first.p.x, second.p.x);
    exchange(wide, first.p.y, second.p.y);
    exchange(wide, first.p.z, second.p.z);
}

/// Triangles with the same corners, of which the first one comes first on the screen, compute the
/// same plane: where the other two change places, all that a depth is the ratio of changes its
/// sign.
HWY_INLINE void lay_plane(const Basis& basis, const Corner& a, const Corner& b, const Corner& c,
                          int i, FormLanes& form) {
    const Triple n = cross(difference(b.p, a.p), difference(c.p, a.p));
    // The ray at depth a.z is this far from corner a, a pixel of q.
    const Double step = pixel_at(basis, a.p.z);
    put(a.u, form[3], i);
    put(a.v, form[7], i);
    put(hn::Neg(hn::Mul(step, n.y)), form[11], i);
    put(hn::Mul(step, n.x), form[15], i);
    put(a.p.z, form[16], i);
    put(n.z, form[17], i);
    put(hn::Mul(n.x, number(basis.slope_step)), form[18], i);
    put(hn::Mul(n.y, number(basis.slope_step)), form[19], i);
}

void lay_triangles(Basis basis, const TriangleLanes& triangles, ScreenPacket& packet,
                   ScreenCorners& corners) {
    FormLanes form;
    for (int i = 0; i < kLanes; i += kStep) {
        Corner a = project(basis, triangles.a, i);
        Corner b = project(basis, triangles.b, i);
        Corner c = project(basis, triangles.c, i);
        // Exact: products of differences of floats.
        const auto apart = [](Half to, Half from) {
            return hn::Sub(hn::PromoteTo(kDoubles, to), hn::PromoteTo(kDoubles, from));
        };
        const Double area = hn::Sub(hn::Mul(apart(b.u, a.u), apart(c.v, a.v)),
                                    hn::Mul(apart(b.v, a.v), apart(c.u, a.u)));
        // The sign of a double survives rounding, zero does too.
        const Half rounded_area = rounded(area);
        keep(a, i, corners.a);
        keep(b, i, corners.b);
        keep(c, i, corners.c);
        put(rounded_area, corners.area, i);
        const Half side = hn::IfThenElse(hn::Lt(rounded_area, hn::Zero(kHalves)), number_f(-1.0F),
                                         number_f(1.0F));
        lay_edge(a, b, side, i, 0, form);
        lay_edge(b, c, side, i, 1, form);
        lay_edge(c, a, side, i, 2, form);
        const Half nearest = rounded(hn::Min(hn::Min(a.p.z, b.p.z), c.p.z));
        put(nearest, form[20], i);
        put(hn::Max(hn::Max(a.p.z, b.p.z), c.p.z), form[21], i);
        // Seen edge-on, it shows nothing.
        const Half left = hn::IfThenElse(hn::Eq(rounded_area, hn::Zero(kHalves)),
                                         number_f(std::numeric_limits<float>::infinity()),
                                         hn::Min(hn::Min(a.u, b.u), c.u));
        put_bounds(left, hn::Max(hn::Max(a.u, b.u), c.u), hn::Min(hn::Min(a.v, b.v), c.v),
                   hn::Max(hn::Max(a.v, b.v), c.v), nearest, i, packet.bounds);
        order(a, b);
        order(a, c);
        lay_plane(basis, a, b, c, i, form);
    }
    lay_side_by_side(form, 24, packet.forms);
}

/// With p = u (b - a) + v (c - a) and n = (b - a) x (c - a): p x (c - a) = u n, (b - a) x p = v n.
void record_triangles(const TriangleLanes& triangles, ScreenPacket& packet) {
    using Floats = hn::CappedTag<float, kLanes>;
    constexpr Floats kFloats;
    HitLanes hit;
    for (int i = 0; i < kLanes; i += static_cast<int>(hn::MaxLanes(kFloats))) {
        const auto from = [&](const Lanes<float>& lanes) {
            return hn::Load(kFloats, lanes.data() + i);
        };
        const auto keep = [&](auto value, Lanes<float>& lanes) {
            hn::Store(value, kFloats, lanes.data() + i);
        };
        const auto minor = [](auto a, auto b, auto c, auto d) {
            return hn::Sub(hn::Mul(a, b), hn::Mul(c, d));
        };
        const auto& [a, b, c] = triangles;
        const auto ex = hn::Sub(from(b.x), from(a.x));
        const auto ey = hn::Sub(from(b.y), from(a.y));
        const auto ez = hn::Sub(from(b.z), from(a.z));
        const auto fx = hn::Sub(from(c.x), from(a.x));
        const auto fy = hn::Sub(from(c.y), from(a.y));
        const auto fz = hn::Sub(from(c.z), from(a.z));
        const auto nx = minor(ey, fz, ez, fy);
        const auto ny = minor(ez, fx, ex, fz);
        const auto nz = minor(ex, fy, ey, fx);
        const auto squared = hn::Add(hn::Add(hn::Mul(nx, nx), hn::Mul(ny, ny)), hn::Mul(nz, nz));
        const auto scale =
            hn::IfThenElse(hn::Gt(squared, hn::Zero(kFloats)),
                           hn::Div(hn::Set(kFloats, 1.0F), squared), hn::Zero(kFloats));
        keep(from(a.x), hit[0]);
        keep(from(a.y), hit[1]);
        keep(from(a.z), hit[2]);
        keep(nx, hit[3]);
        keep(ny, hit[4]);
        keep(nz, hit[5]);
        keep(hn::Mul(minor(fy, nz, fz, ny), scale), hit[6]);
        keep(hn::Mul(minor(fz, nx, fx, nz), scale), hit[7]);
        keep(hn::Mul(minor(fx, ny, fy, nx), scale), hit[8]);
        keep(hn::Mul(minor(ny, ez, nz, ey), scale), hit[9]);
        keep(hn::Mul(minor(nz, ex, nx, ez), scale), hit[10]);
        keep(hn::Mul(minor(nx, ey, ny, ex), scale), hit[11]);
    }
    lay_side_by_side(hit, 12, packet.hit);
}

void record_solids(const Points& normal, ScreenPacket& packet) {
    const HitLanes hit{{{}, {}, {}, normal.x, normal.y, normal.z}};
    lay_side_by_side(hit, 8, packet.hit);
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(lay_triangles);
HWY_EXPORT(record_solids);
HWY_EXPORT(record_triangles);

void prepare(const Basis& basis, const TriangleLanes& triangles, ScreenPacket& packet,
             ScreenCorners& corners) {
    HWY_DYNAMIC_DISPATCH(lay_triangles)(basis, triangles, packet, corners);
}

void record_hits(const TriangleLanes& triangles, ScreenPacket& packet) {
    HWY_DYNAMIC_DISPATCH(record_triangles)(triangles, packet);
}

void prepare(const Basis& basis, const SolidLanes& faces, ScreenPacket& packet) {
    ScreenCorners corners;
    HWY_DYNAMIC_DISPATCH(lay_triangles)(basis, faces.triangles, packet, corners);
    HWY_DYNAMIC_DISPATCH(record_solids)(faces.normal, packet);
}

}  // namespace ink

#endif
