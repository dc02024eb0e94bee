#include "film/opaque_ink.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "film/opaque_ink.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/block_rows-inl.h"
#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

constexpr std::uint32_t kAlpha = 0xFF000000U;

/// One colour of pixels, at its place among their bits.
template <int kShift>
HWY_INLINE Word mix(Word below, Number ink, Number clear, float own) {
    const auto byte = hn::And(hn::ShiftRight<kShift>(below), hn::Set(kWords, 0xFFU));
    const auto value =
        hn::Mul(hn::ConvertTo(kFloats, hn::BitCast(kIntegers, byte)), set(1.0F / 255.0F));
    const auto mixed = hn::Add(hn::Mul(value, clear), hn::Mul(ink, set(own)));
    const auto within = hn::Min(hn::Max(mixed, hn::Zero(kFloats)), set(1.0F));
    const auto rounded = hn::Add(hn::Mul(within, set(255.0F)), set(0.5F));
    return hn::ShiftLeft<kShift>(hn::BitCast(kWords, hn::ConvertTo(kIntegers, rounded)));
}

bool lay_on_opaque_rows(const Lanes<float>& alpha, Color color, std::uint32_t* pixels,
                        std::size_t stride) {
    constexpr std::size_t kSteps = kLanes / kStep;
    const auto at = [&](std::size_t k)
                        HWY_ATTR { return pixels + k * (kStep / kBlockSide) * stride; };
    auto all = hn::Set(kWords, kAlpha);
    for (std::size_t k = 0; k < kSteps; ++k) {
        all = hn::And(all, load_rows(kWords, at(k), stride));
    }
    if (!hn::AllTrue(kWords, hn::Eq(all, hn::Set(kWords, kAlpha)))) return false;
    for (std::size_t k = 0; k < kSteps; ++k) {
        const auto below = load_rows(kWords, at(k), stride);
        const auto ink = hn::Load(kFloats, alpha.data() + k * kStep);
        const auto clear = hn::Sub(set(1.0F), ink);
        const auto mixed =
            hn::Or(hn::Or(mix<0>(below, ink, clear, color.r), mix<8>(below, ink, clear, color.g)),
                   hn::Or(mix<16>(below, ink, clear, color.b), hn::Set(kWords, kAlpha)));
        const auto inked = hn::RebindMask(kWords, hn::Ne(ink, hn::Zero(kFloats)));
        store_rows(kWords, hn::IfThenElse(inked, mixed, below), at(k), stride);
    }
    return true;
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(lay_on_opaque_rows);

bool lay_on_opaque(const Lanes<float>& alpha, Color color, std::uint32_t* pixels,
                   std::size_t stride) {
    return HWY_DYNAMIC_DISPATCH(lay_on_opaque_rows)(alpha, color, pixels, stride);
}

}  // namespace ink

#endif
