// What putting primitives into screen form shares; included once for each instruction set.

#include <array>
#include <limits>
#include <tuple>

#include "accel/screen_packets.h"
#include "accel/side_by_side-inl.h"

#if defined(INKTRACE_SCREEN_FORMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef INKTRACE_SCREEN_FORMS_INL_H
#undef INKTRACE_SCREEN_FORMS_INL_H
#else
#define INKTRACE_SCREEN_FORMS_INL_H
#endif

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

/// Of corners on the screen, and the least of their depths.
struct CornerBounds {
    Double left, top, right, bottom, depth;

    static HWY_INLINE CornerBounds none() {
        const Double infinity = number(std::numeric_limits<double>::infinity());
        return {infinity, infinity, hn::Neg(infinity), hn::Neg(infinity), infinity};
    }
    /// A corner in camera space, where a pixel is that wide.
    HWY_INLINE void add(const Triple& corner, Double pixel) {
        const Double scale = hn::Div(number(1.0), pixel);
        const Double u = hn::Mul(corner.x, scale);
        const Double v = hn::Mul(corner.y, scale);
        left = hn::Min(left, u);
        right = hn::Max(right, u);
        top = hn::Min(top, v);
        bottom = hn::Max(bottom, v);
        depth = hn::Min(depth, corner.z);
    }
    HWY_INLINE void put(int i, BoundsPacket& bounds) const {
        put_bounds(rounded(left), rounded(right), rounded(top), rounded(bottom), rounded(depth), i,
                   bounds);
    }
};

/// A form's numbers for all sixteen lanes, as they are computed.
using FormLanes = std::array<Lanes<float>, std::tuple_size_v<FormNumbers>>;
/// Likewise what hits need.
using HitLanes = std::array<Lanes<float>, std::tuple_size_v<HitNumbers>>;

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
