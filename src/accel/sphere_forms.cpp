#include "accel/screen_packets.h"

#include <array>
#include <limits>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/sphere_forms.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "accel/screen_forms-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

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

void lay_spheres(Basis basis, const SphereLanes& spheres, ScreenPacket& packet) {
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

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(lay_spheres);

void prepare(const Basis& basis, const SphereLanes& spheres, ScreenPacket& packet) {
    HWY_DYNAMIC_DISPATCH(lay_spheres)(basis, spheres, packet);
}

}  // namespace ink

#endif
