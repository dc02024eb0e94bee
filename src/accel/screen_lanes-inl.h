// What the kernels of camera rays share; included once for each instruction set.

#include <bit>
#include <cstdint>
#include <cstring>

#include "accel/screen_kernels.h"

#if defined(INKTRACE_SCREEN_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef INKTRACE_SCREEN_LANES_INL_H
#undef INKTRACE_SCREEN_LANES_INL_H
#else
#define INKTRACE_SCREEN_LANES_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kLanes>;
using Indices = hn::Rebind<std::uint32_t, Floats>;
using Integers = hn::Rebind<std::int32_t, Floats>;
constexpr Floats kFloats;
constexpr Indices kIndices;
constexpr Integers kIntegers;
constexpr int kStep = static_cast<int>(hn::MaxLanes(Floats()));
using Vector = hn::Vec<Floats>;
using Mask = hn::Mask<Floats>;

template <class T>
HWY_INLINE auto load(const Lanes<T>& lanes, int first) {
    return hn::Load(hn::CappedTag<T, kLanes>(), lanes.data() + first);
}

HWY_INLINE Vector set(float value) { return hn::Set(kFloats, value); }

HWY_INLINE LaneBits bits(Mask mask) {
#if HWY_TARGET <= HWY_AVX3
    return static_cast<LaneBits>(mask.raw);
#endif
    alignas(8) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kFloats, mask, bytes);
    return bytes[0] | static_cast<LaneBits>(bytes[1]) << 8U;
}

/// A lane's numbers.
template <class Form>
HWY_INLINE Form form_of(const ScreenPacket& packet, int lane) {
    Form form;
    std::memcpy(&form, packet.forms[static_cast<std::size_t>(lane)].data(), sizeof(form));
    return form;
}

struct Vectors {
    Vector x, y, z;
};

HWY_INLINE Vector dot(const Vectors& a, const Vectors& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vectors along(const Vectors& o, const Vectors& d, Vector s) {
    return {hn::Add(o.x, hn::Mul(s, d.x)), hn::Add(o.y, hn::Mul(s, d.y)),
            hn::Add(o.z, hn::Mul(s, d.z))};
}
/// A number that can be divided by.
HWY_INLINE Vector not_zero(Vector v) {
    const auto tiny = hn::Lt(hn::Abs(v), set(1e-30F));
    return hn::IfThenElse(tiny, set(1e-30F), v);
}

/// Rays in the coordinates of a unit shape: p + s d; see GlyphForm.
struct LocalRays {
    Vectors p, d;
};

HWY_INLINE LocalRays local_rays(const GlyphForm& form, Vector qx, Vector qy) {
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
