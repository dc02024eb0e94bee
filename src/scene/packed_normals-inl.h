// Normals that pack_normal packed, many at a time; included once for each instruction set.

#include <cstdint>

#if defined(INKTRACE_PACKED_NORMALS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef INKTRACE_PACKED_NORMALS_INL_H
#undef INKTRACE_PACKED_NORMALS_INL_H
#else
#define INKTRACE_PACKED_NORMALS_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

template <class Floats>
struct UnpackedNormals {
    hwy::HWY_NAMESPACE::Vec<Floats> x, y, z;
};

/// Not scaled to unit length: that shifts the weights of corners a little, alike on both sides of
/// an edge, and saves three square roots. |x| + |y| + |z| is 32767.
template <class Floats>
HWY_INLINE UnpackedNormals<Floats> unpack_normals(
    Floats floats,
    hwy::HWY_NAMESPACE::Vec<hwy::HWY_NAMESPACE::Rebind<std::uint32_t, Floats>> packed) {
    namespace hn = hwy::HWY_NAMESPACE;
    constexpr hn::Rebind<std::uint32_t, Floats> kUnsigned;
    constexpr hn::Rebind<std::int32_t, Floats> kSigned;
    const auto one = hn::Set(floats, 32767.0F);
    const auto number = [&](auto bits) {
        return hn::ConvertTo(floats, hn::BitCast(kSigned, bits));
    };
    const auto x = hn::Sub(number(hn::And(packed, hn::Set(kUnsigned, 0xFFFFU))), one);
    const auto y = hn::Sub(number(hn::ShiftRight<16>(packed)), one);
    const auto z = hn::Sub(hn::Sub(one, hn::Abs(x)), hn::Abs(y));
    const auto fold = hn::Max(hn::Neg(z), hn::Zero(floats));
    return {hn::Sub(x, hn::CopySign(fold, x)), hn::Sub(y, hn::CopySign(fold, y)), z};
}

/// Whether a sum of these says where a surface faces: opposite corner normals can cancel.
constexpr float kLeastNormalSquared = 1e3F;

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
