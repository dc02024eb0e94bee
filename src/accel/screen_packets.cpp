#include "accel/screen_packets.h"

#include <cmath>
#include <limits>
#include <tuple>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/screen_packets.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Positions are computed in double precision, then rounded once.
using Doubles = hn::CappedTag<double, kLanes>;
using Halves = hn::Rebind<float, Doubles>;  ///< as many floats
constexpr Doubles kDoubles;
constexpr Halves kHalves;
constexpr int kStep = static_cast<int>(hn::MaxLanes(Doubles()));
using Double = hn::Vec<Doubles>;
using Half = hn::Vec<Halves>;

/// Bounds grow by this much, pixels, which is more than positions are rounded by.
constexpr float kSlack = 1e-2F;
/// Likewise for depths; the scene reaches over 2.
constexpr float kDepthSlack = 1e-5F;

HWY_INLINE Double number(double value) { return hn::Set(kDoubles, value); }
HWY_INLINE Half number_f(float value) { return hn::Set(kHalves, value); }
HWY_INLINE Double load(const Lanes<float>& lanes, int i) {
    return hn::PromoteTo(kDoubles, hn::LoadU(kHalves, lanes.data() + i));
}
HWY_INLINE void put(Half value, Lanes<float>& lanes, int i) {
    hn::StoreU(value, kHalves, lanes.data() + i);
}
HWY_INLINE Half rounded(Double value) { return hn::DemoteTo(kHalves, value); }
HWY_INLINE void put(Double value, Lanes<float>& lanes, int i) { put(rounded(value), lanes, i); }

struct Triple {
    Double x, y, z;
};

HWY_INLINE Triple load(const Points& points, int i) {
    return {load(points.x, i), load(points.y, i), load(points.z, i)};
}
HWY_INLINE Double weigh(const Triple& v, double x, double y, double z) {
    return hn::Add(hn::Add(hn::Mul(v.x, number(x)), hn::Mul(v.y, number(y))),
                   hn::Mul(v.z, number(z)));
}
/// A vector's parts right, down and forward.
HWY_INLINE Triple turned(const Basis& b, const Triple& v) {
    return {weigh(v, b.rx, b.ry, b.rz), weigh(v, b.dx, b.dy, b.dz), weigh(v, b.fx, b.fy, b.fz)};
}
/// A point's place right, down and forward from the start.
HWY_INLINE Triple to_camera(const Basis& b, const Triple& p) {
    return turned(
        b, {hn::Sub(p.x, number(b.sx)), hn::Sub(p.y, number(b.sy)), hn::Sub(p.z, number(b.sz))});
}
HWY_INLINE Triple sum(const Triple& a, const Triple& b) {
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Triple difference(const Triple& a, const Triple& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Triple cross(const Triple& a, const Triple& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
            hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE Double dot(const Triple& a, const Triple& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
/// Width of a pixel at a depth.
HWY_INLINE Double pixel_at(const Basis& b, Double depth) {
    return hn::Add(number(b.origin_step), hn::Mul(depth, number(b.slope_step)));
}

HWY_INLINE void put_bounds(Half left, Half right, Half top, Half bottom, Half depth, int i,
                           BoundsPacket& bounds) {
    const Half slack = number_f(kSlack);
    put(hn::Sub(left, slack), bounds.left, i);
    put(hn::Add(right, slack), bounds.right, i);
    put(hn::Sub(top, slack), bounds.top, i);
    put(hn::Add(bottom, slack), bounds.bottom, i);
    put(hn::Sub(depth, number_f(kDepthSlack)), bounds.depth, i);
}

/// A form's numbers for all sixteen lanes, as they are computed.
using FormLanes = std::array<Lanes<float>, std::tuple_size_v<FormNumbers>>;
/// Likewise what hits need.
using HitLanes = std::array<Lanes<float>, std::tuple_size_v<HitNumbers>>;

/// The first `count` numbers, a multiple of four, lane by lane.
template <std::size_t kNumbers>
HWY_INLINE void lay_side_by_side(const std::array<Lanes<float>, kNumbers>& form, std::size_t count,
                                 std::array<std::array<float, kNumbers>, kLanes>& forms) {
    using Four = hn::FixedTag<float, 4>;
    constexpr Four kFour;
    for (std::size_t k = 0; k < count; k += 4) {
        for (std::size_t lane = 0; lane < kLanes; lane += 4) {
            const auto a = hn::Load(kFour, form[k].data() + lane);
            const auto b = hn::Load(kFour, form[k + 1].data() + lane);
            const auto c = hn::Load(kFour, form[k + 2].data() + lane);
            const auto d = hn::Load(kFour, form[k + 3].data() + lane);
            const auto ac_low = hn::InterleaveLower(kFour, a, c);
            const auto ac_high = hn::InterleaveUpper(kFour, a, c);
            const auto bd_low = hn::InterleaveLower(kFour, b, d);
            const auto bd_high = hn::InterleaveUpper(kFour, b, d);
            hn::StoreU(hn::InterleaveLower(kFour, ac_low, bd_low), kFour, &forms[lane][k]);
            hn::StoreU(hn::InterleaveUpper(kFour, ac_low, bd_low), kFour, &forms[lane + 1][k]);
            hn::StoreU(hn::InterleaveLower(kFour, ac_high, bd_high), kFour, &forms[lane + 2][k]);
            hn::StoreU(hn::InterleaveUpper(kFour, ac_high, bd_high), kFour, &forms[lane + 3][k]);
        }
    }
}

// ---- Spheres ----

/// The outline of a sphere at C (from the eye) with radius r is the conic where
/// (C . D)^2 = (|C|^2 - r^2) |D|^2 for D = (x, y, 1). Taken about its centre,
/// C.z (C.x, C.y) / (C.z^2 - r^2), nothing cancels.
HWY_INLINE void prepare_perspective(const Basis& basis, const SphereLanes& spheres,
                                    BoundsPacket& bounds, FormLanes& form) {
    const double pixels = 1.0 / basis.slope_step;
    const double step2 = basis.slope_step * basis.slope_step;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto [x, y, z] = to_camera(basis, load(spheres.centre, i));
        const Double r = load(spheres.radius, i);
        const Double r2 = hn::Mul(r, r);
        const Double depth = hn::Add(z, number(basis.start_depth));
        const Double ahead = hn::Sub(hn::Mul(depth, depth), r2);
        const Double a = hn::Add(hn::Mul(y, y), ahead);
        const Double c = hn::Add(hn::Mul(x, x), ahead);
        const Double tangent = hn::Add(hn::Mul(x, x), a);  // squared length of one from the eye
        const Double across = hn::Mul(hn::Div(depth, ahead), number(pixels));
        const Double reach = hn::Mul(hn::Div(r, ahead), number(pixels));
        const Double u = hn::Mul(x, across);
        const Double v = hn::Mul(y, across);
        const Double width = hn::Mul(reach, hn::Sqrt(c));
        const Double height = hn::Mul(reach, hn::Sqrt(a));
        put(u, form[0], i);
        put(v, form[1], i);
        put(hn::Mul(a, number(step2)), form[2], i);
        put(hn::Mul(hn::Mul(x, y), number(-2.0 * step2)), form[3], i);
        put(hn::Mul(c, number(step2)), form[4], i);
        put(hn::Div(hn::Mul(r2, tangent), ahead), form[5], i);
        put(x, form[6], i);
        put(y, form[7], i);
        put(z, form[8], i);
        put_bounds(rounded(hn::Sub(u, width)), rounded(hn::Add(u, width)),
                   rounded(hn::Sub(v, height)), rounded(hn::Add(v, height)), rounded(hn::Sub(z, r)),
                   i, bounds);
    }
}

HWY_INLINE void prepare_orthographic(const Basis& basis, const SphereLanes& spheres,
                                     BoundsPacket& bounds, FormLanes& form) {
    const double pixels = 1.0 / basis.origin_step;
    const Double step2 = number(basis.origin_step * basis.origin_step);
    for (int i = 0; i < kLanes; i += kStep) {
        const auto [x, y, z] = to_camera(basis, load(spheres.centre, i));
        const Double r = load(spheres.radius, i);
        const Double u = hn::Mul(x, number(pixels));
        const Double v = hn::Mul(y, number(pixels));
        const Double reach = hn::Mul(r, number(pixels));
        put(u, form[0], i);
        put(v, form[1], i);
        put(step2, form[2], i);
        put(hn::Zero(kDoubles), form[3], i);
        put(step2, form[4], i);
        put(hn::Mul(r, r), form[5], i);
        put(x, form[6], i);
        put(y, form[7], i);
        put(z, form[8], i);
        put_bounds(rounded(hn::Sub(u, reach)), rounded(hn::Add(u, reach)),
                   rounded(hn::Sub(v, reach)), rounded(hn::Add(v, reach)), rounded(hn::Sub(z, r)),
                   i, bounds);
    }
}

void prepare_spheres(Basis basis, const SphereLanes& spheres, ScreenPacket& packet) {
    FormLanes form;
    if (basis.orthographic) {
        prepare_orthographic(basis, spheres, packet.bounds, form);
    } else {
        prepare_perspective(basis, spheres, packet.bounds, form);
    }
    lay_side_by_side(form, 12, packet.forms);
    const HitLanes hit{spheres.centre.x, spheres.centre.y, spheres.centre.z};
    lay_side_by_side(hit, 4, packet.hit);
}

// ---- Triangles ----

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

/// Edge from corner `a` to corner `b`, its inside on the left if `side` is 1, else -1.
HWY_INLINE void lay_edge(const Corner& a, const Corner& b, Half side, int i, Lanes<float>* edge) {
    const auto swap = hn::Or(hn::Lt(b.u, a.u), hn::And(hn::Eq(b.u, a.u), hn::Lt(b.v, a.v)));
    const Half sign = hn::IfThenElse(swap, hn::Neg(side), side);
    const Half x0 = hn::IfThenElse(swap, b.u, a.u);
    const Half y0 = hn::IfThenElse(swap, b.v, a.v);
    const Half x1 = hn::IfThenElse(swap, a.u, b.u);
    const Half y1 = hn::IfThenElse(swap, a.v, b.v);
    put(x0, edge[0], i);
    put(y0, edge[1], i);
    put(hn::Mul(sign, hn::Sub(x1, x0)), edge[2], i);
    put(hn::Mul(sign, hn::Sub(y1, y0)), edge[3], i);
}

/// Brings the corner that comes first on the screen to the front, so that triangles with the same
/// corners compute the same plane in whatever order these are given.
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

HWY_INLINE void lay_plane(const Basis& basis, const Corner& a, const Corner& b, const Corner& c,
                          int i, Lanes<float>* plane) {
    const Triple n = cross(difference(b.p, a.p), difference(c.p, a.p));
    // The ray at depth a.z is this far from corner a, a pixel of q.
    const Double step = pixel_at(basis, a.p.z);
    put(a.u, plane[0], i);
    put(a.v, plane[1], i);
    put(a.p.z, plane[2], i);
    put(hn::Neg(hn::Mul(step, n.x)), plane[3], i);
    put(hn::Neg(hn::Mul(step, n.y)), plane[4], i);
    put(n.z, plane[5], i);
    put(hn::Mul(n.x, number(basis.slope_step)), plane[6], i);
    put(hn::Mul(n.y, number(basis.slope_step)), plane[7], i);
}

void prepare_triangles(Basis basis, const TriangleLanes& triangles, ScreenPacket& packet) {
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
        const Half side = hn::IfThenElse(hn::Lt(rounded_area, hn::Zero(kHalves)), number_f(-1.0F),
                                         number_f(1.0F));
        lay_edge(a, b, side, i, &form[0]);
        lay_edge(b, c, side, i, &form[4]);
        lay_edge(c, a, side, i, &form[8]);
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
        order(b, c);
        order(a, b);
        lay_plane(basis, a, b, c, i, &form[12]);
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

// ---- Glyphs ----

/// The cube that holds a unit shape, or the square in its middle, on the screen.
HWY_INLINE void bound_glyphs(const Basis& basis, bool flat, const Triple& c, const Triple& x,
                             const Triple& y, const Triple& z, int i, ScreenPacket& packet) {
    const Double infinity = number(std::numeric_limits<double>::infinity());
    Double left = infinity;
    Double top = infinity;
    Double right = hn::Neg(infinity);
    Double bottom = right;
    Double depth = infinity;
    Double width = infinity;  // of a pixel, at the corner where it is least
    for (int corner = 0; corner < (flat ? 4 : 8); ++corner) {
        Triple p = (corner & 1) != 0 ? sum(c, x) : difference(c, x);
        p = (corner & 2) != 0 ? sum(p, y) : difference(p, y);
        if (!flat) p = (corner & 4) != 0 ? sum(p, z) : difference(p, z);
        const Double pixel = pixel_at(basis, p.z);
        const Double scale = hn::Div(number(1.0), pixel);
        const Double u = hn::Mul(p.x, scale);
        const Double v = hn::Mul(p.y, scale);
        left = hn::Min(left, u);
        right = hn::Max(right, u);
        top = hn::Min(top, v);
        bottom = hn::Max(bottom, v);
        depth = hn::Min(depth, p.z);
        width = hn::Min(width, pixel);
    }
    // A corner beside the eye has no place on the screen.
    const auto beside = hn::Le(width, number(1e-6 * basis.origin_step));
    left = hn::IfThenElse(beside, hn::Neg(infinity), left);
    top = hn::IfThenElse(beside, hn::Neg(infinity), top);
    right = hn::IfThenElse(beside, infinity, right);
    bottom = hn::IfThenElse(beside, infinity, bottom);
    put_bounds(rounded(left), rounded(right), rounded(top), rounded(bottom), rounded(depth), i,
               packet.bounds);
}

void prepare_glyphs(Basis basis, const GlyphLanes& glyphs, ScreenPacket& packet) {
    FormLanes form;
    HitLanes hit;
    const bool flat =
        packet.shape.kind == GlyphKind::disc || packet.shape.kind == GlyphKind::rectangle;
    for (int i = 0; i < kLanes; i += kStep) {
        const Triple x = load(glyphs.x_axis, i);
        const Triple y = load(glyphs.y_axis, i);
        const Triple z = load(glyphs.z_axis, i);
        const Triple yz = cross(y, z);
        const Double scale = hn::Div(number(1.0), dot(x, yz));  // infinite without a volume
        const std::array<Triple, 3> cofactors{yz, cross(z, x), cross(x, y)};
        const Triple c = to_camera(basis, load(glyphs.origin, i));
        const Double pixel = pixel_at(basis, c.z);
        const Double u = hn::Div(c.x, pixel);
        const Double v = hn::Div(c.y, pixel);
        put(u, form[0], i);
        put(v, form[1], i);
        put(c.z, form[2], i);
        auto finite = hn::Eq(pixel, pixel);
        for (std::size_t k = 0; k < 3; ++k) {
            const Triple row{hn::Mul(cofactors[k].x, scale), hn::Mul(cofactors[k].y, scale),
                             hn::Mul(cofactors[k].z, scale)};
            const Triple own = turned(basis, row);
            const Double ahead = hn::Add(
                own.z,
                hn::Mul(hn::Add(hn::Mul(own.x, u), hn::Mul(own.y, v)), number(basis.slope_step)));
            put(hn::Mul(own.x, pixel), form[3 + k], i);
            put(hn::Mul(own.y, pixel), form[6 + k], i);
            put(ahead, form[9 + k], i);
            put(row.x, hit[3 * k], i);
            put(row.y, hit[3 * k + 1], i);
            put(row.z, hit[3 * k + 2], i);
            const Double size = hn::Add(hn::Add(hn::Abs(row.x), hn::Abs(row.y)), hn::Abs(row.z));
            finite = hn::And(finite, hn::Lt(size, number(1e30)));
        }
        put(hn::Div(number(basis.slope_step), pixel), form[12], i);
        bound_glyphs(basis, flat, c, turned(basis, x), turned(basis, y), turned(basis, z), i,
                     packet);
        const Half kept = rounded(hn::IfThenElseZero(finite, number(1.0)));  // to a mask of floats
        put(hn::IfThenElse(hn::Gt(kept, hn::Zero(kHalves)),
                           hn::LoadU(kHalves, packet.bounds.left.data() + i),
                           number_f(std::numeric_limits<float>::infinity())),
            packet.bounds.left, i);
    }
    lay_side_by_side(form, 16, packet.forms);
    lay_side_by_side(hit, 12, packet.hit);
}

// ---- Boxes ----

void prepare_boxes(Basis basis, const BoxLanes& boxes, BoundsPacket& packet) {
    for (int i = 0; i < kLanes; i += kStep) {
        const Triple lower = load(boxes.lower, i);
        const Triple upper = load(boxes.upper, i);
        const Double infinity = number(std::numeric_limits<double>::infinity());
        Double left = infinity;
        Double top = infinity;
        Double depth = infinity;
        Double right = hn::Neg(infinity);
        Double bottom = right;
        for (int corner = 0; corner < 8; ++corner) {
            const Triple p = to_camera(basis, {(corner & 1) != 0 ? upper.x : lower.x,
                                               (corner & 2) != 0 ? upper.y : lower.y,
                                               (corner & 4) != 0 ? upper.z : lower.z});
            const Double scale = hn::Div(number(1.0), pixel_at(basis, p.z));
            const Double u = hn::Mul(p.x, scale);
            const Double v = hn::Mul(p.y, scale);
            left = hn::Min(left, u);
            right = hn::Max(right, u);
            top = hn::Min(top, v);
            bottom = hn::Max(bottom, v);
            depth = hn::Min(depth, p.z);
        }
        put_bounds(rounded(left), rounded(right), rounded(top), rounded(bottom), rounded(depth), i,
                   packet);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(prepare_boxes);
HWY_EXPORT(prepare_glyphs);
HWY_EXPORT(prepare_spheres);
HWY_EXPORT(prepare_triangles);
HWY_EXPORT(record_solids);
HWY_EXPORT(record_triangles);

namespace {

void empty_unused(std::size_t used, BoundsPacket& bounds) {
    for (std::size_t i = used; i < kLanes; ++i) {
        bounds.left[static_cast<int>(i)] = std::numeric_limits<float>::infinity();
    }
}

}  // namespace

Basis::Basis(const Projection& p)
    : rx(p.right.x),
      ry(p.right.y),
      rz(p.right.z),
      dx(p.down.x),
      dy(p.down.y),
      dz(p.down.z),
      fx(p.forward.x),
      fy(p.forward.y),
      fz(p.forward.z),
      sx(p.start.x),
      sy(p.start.y),
      sz(p.start.z),
      start_depth(p.start_depth),
      origin_step(p.origin_step),
      slope_step(p.slope_step),
      orthographic(p.orthographic()) {}

BoundsPacket BoundsPacket::none() {
    BoundsPacket bounds{};
    bounds.left.fill(std::numeric_limits<float>::infinity());
    return bounds;
}

void prepare(const Basis& basis, const Clusters& clusters, const Cluster& cluster,
             ScreenPacket& packet) {
    packet.object = cluster.object;
    packet.kind = cluster.kind;
    switch (cluster.kind) {
        case ClusterKind::spheres: {
            const SphereLanes& spheres = clusters.spheres[cluster.packet];
            if (cluster.copy == kNoCopy) {
                HWY_DYNAMIC_DISPATCH(prepare_spheres)(basis, spheres, packet);
            } else {
                HWY_DYNAMIC_DISPATCH(prepare_spheres)
                (basis, moved(spheres, clusters.copies[cluster.copy].motion), packet);
            }
            break;
        }
        case ClusterKind::triangles: {
            const TriangleLanes& triangles = clusters.triangles[cluster.packet];
            HWY_DYNAMIC_DISPATCH(prepare_triangles)(basis, triangles, packet);
            HWY_DYNAMIC_DISPATCH(record_triangles)(triangles, packet);
            break;
        }
        case ClusterKind::solids: {
            const SolidLanes& faces = clusters.solids[cluster.packet];
            HWY_DYNAMIC_DISPATCH(prepare_triangles)(basis, faces.triangles, packet);
            HWY_DYNAMIC_DISPATCH(record_solids)(faces.normal, packet);
            break;
        }
        case ClusterKind::glyphs:
            packet.shape = clusters.unit_shapes[cluster.object];
            if (cluster.copy == kNoCopy) {
                HWY_DYNAMIC_DISPATCH(prepare_glyphs)
                (basis, clusters.glyphs[cluster.packet], packet);
            } else {
                HWY_DYNAMIC_DISPATCH(prepare_glyphs)
                (basis,
                 moved(clusters.glyphs[cluster.packet], clusters.copies[cluster.copy].motion),
                 packet);
            }
            break;
    }
    empty_unused(cluster.count, packet.bounds);
    const std::uint32_t first =
        cluster.copy == kNoCopy ? 0 : clusters.copies[cluster.copy].first_primitive;
    for (int lane = 0; lane < cluster.count; ++lane) {
        packet.primitive[lane] =
            first + clusters.order[cluster.first + static_cast<std::uint32_t>(lane)];
    }
}

void prefetch(const Clusters& clusters, std::uint32_t cluster) {
    const auto ask = [](const auto& lanes) {
        constexpr std::size_t kLine = 64;
        const auto* bytes = reinterpret_cast<const char*>(&lanes);
        for (std::size_t at = 0; at < sizeof(lanes); at += kLine) __builtin_prefetch(bytes + at);
    };
    const Cluster& own = clusters.clusters[cluster];
    switch (own.kind) {
        case ClusterKind::spheres: return ask(clusters.spheres[own.packet]);
        case ClusterKind::triangles: return ask(clusters.triangles[own.packet]);
        case ClusterKind::solids: return ask(clusters.solids[own.packet]);
        case ClusterKind::glyphs: return ask(clusters.glyphs[own.packet]);
    }
}

void prepare(const Basis& basis, const BoxLanes& boxes, std::size_t used, BoundsPacket& packet) {
    HWY_DYNAMIC_DISPATCH(prepare_boxes)(basis, boxes, packet);
    empty_unused(used, packet);
}

}  // namespace ink

#endif
