// What the kernels of camera rays share; included once for each instruction set.

#include <cstring>

#include "accel/screen_kernels.h"
#include "base/lanes-inl.h"

#if defined(INKTRACE_SCREEN_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef INKTRACE_SCREEN_LANES_INL_H
#undef INKTRACE_SCREEN_LANES_INL_H
#else
#define INKTRACE_SCREEN_LANES_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

/// A lane's numbers.
template <class Form>
HWY_INLINE Form form_of(const ScreenPacket& packet, int lane) {
    Form form;
    std::memcpy(&form, packet.forms[static_cast<std::size_t>(lane)].data(), sizeof(form));
    return form;
}

HWY_INLINE Vectors along(const Vectors& o, const Vectors& d, Number s) {
    return {hn::Add(o.x, hn::Mul(s, d.x)), hn::Add(o.y, hn::Mul(s, d.y)),
            hn::Add(o.z, hn::Mul(s, d.z))};
}
/// A number that can be divided by.
HWY_INLINE Number not_zero(Number v) {
    const auto tiny = hn::Lt(hn::Abs(v), set(1e-30F));
    return hn::IfThenElse(tiny, set(1e-30F), v);
}

/// Rays in the coordinates of a unit shape: p + s d; see GlyphForm.
struct LocalRays {
    Vectors p, d;
};

HWY_INLINE LocalRays local_rays(const GlyphForm& form, Number qx, Number qy) {
    const auto dx = hn::Sub(qx, set(form.u));
    const auto dy = hn::Sub(qy, set(form.v));
    const auto own = [&](std::size_t k) {
        return hn::Add(hn::Mul(set(form.right[k]), dx), hn::Mul(set(form.down[k]), dy));
    };
    LocalRays rays{{own(0), own(1), own(2)}, {}};
    rays.d =
        along({set(form.ahead[0]), set(form.ahead[1]), set(form.ahead[2])}, rays.p, set(form.turn));
    return rays;
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
