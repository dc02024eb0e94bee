// Sixteen lanes, a vector of any length at a time: their tags, and how they are read, written and
// told apart; included once for each instruction set.

#include <cstddef>
#include <cstdint>

#include "base/lanes.h"
#include "base/vec.h"

#if defined(INKTRACE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef INKTRACE_LANES_INL_H
#undef INKTRACE_LANES_INL_H
#else
#define INKTRACE_LANES_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kLanes>;
using Integers = hn::RebindToSigned<Floats>;
using Words = hn::RebindToUnsigned<Floats>;  ///< IDs, indices, pixels
constexpr Floats kFloats;
constexpr Integers kIntegers;
constexpr Words kWords;
using Number = hn::Vec<Floats>;
using Integer = hn::Vec<Integers>;
using Word = hn::Vec<Words>;
using Mask = hn::Mask<Floats>;

/// Lanes in a vector: 4, 8 or all 16. Loops over a packet step by it.
constexpr int kStep = static_cast<int>(hn::MaxLanes(Floats()));

HWY_INLINE Number set(float value) { return hn::Set(kFloats, value); }

/// The lanes from one on that is a multiple of kStep.
template <class T>
HWY_INLINE auto load(const Lanes<T>& lanes, int first) {
    return hn::Load(hn::CappedTag<T, kLanes>(), lanes.data() + first);
}
template <class T>
HWY_INLINE void store(hn::Vec<hn::CappedTag<T, kLanes>> values, Lanes<T>& lanes, int first) {
    hn::Store(values, hn::CappedTag<T, kLanes>(), lanes.data() + first);
}

/// A bit for each lane of a vector, to be shifted to its first one.
HWY_INLINE LaneBits bits_of(Mask mask) {
#if HWY_TARGET <= HWY_AVX3
    return static_cast<LaneBits>(mask.raw);
#else
    alignas(8) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kFloats, mask, bytes);
    return static_cast<LaneBits>(bytes[0]) | static_cast<LaneBits>(bytes[1]) << 8U;
#endif
}
HWY_INLINE LaneBits bits_of(hn::Mask<Words> mask) { return bits_of(hn::RebindMask(kFloats, mask)); }

/// Vectors of three coordinates.
struct Vectors {
    Number x, y, z;
};

HWY_INLINE Vectors set(Vec3f v) { return {set(v.x), set(v.y), set(v.z)}; }
HWY_INLINE Vectors operator+(const Vectors& a, const Vectors& b) {
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Vectors operator-(const Vectors& a, const Vectors& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Number dot(const Vectors& a, const Vectors& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
            hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
