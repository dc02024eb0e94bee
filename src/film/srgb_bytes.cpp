#include "film/srgb_bytes.h"

#include <cmath>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "film/srgb_bytes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

/// Floats above zero are in the order of their bits.
HWY_INLINE Integer srgb_byte(const SrgbBytes& table, Number linear) {
    const auto bits = hn::BitCast(kIntegers, linear);
    const auto first = hn::Set(kIntegers, SrgbBytes::kFirst);
    const auto clamped = hn::Min(hn::Max(bits, first), hn::Set(kIntegers, SrgbBytes::kOne));
    const auto above = hn::Sub(clamped, first);
    const auto entry =
        hn::GatherIndex(kIntegers, table.entries.data(), hn::ShiftRight<SrgbBytes::kShift>(above));
    const auto within = hn::And(above, hn::Set(kIntegers, SrgbBytes::kWithin));
    return hn::ShiftRight<SrgbBytes::kShift>(hn::Add(entry, within));
}

/// The three channels of a pixel, R lowest. Grey takes one look-up.
HWY_INLINE Integer srgb_bytes(const SrgbBytes& table, Number r, Number g, Number b) {
    const auto red = srgb_byte(table, r);
    const bool grey = hn::AllTrue(kFloats, hn::And(hn::Eq(r, g), hn::Eq(g, b)));
    const auto green = grey ? red : srgb_byte(table, g);
    const auto blue = grey ? red : srgb_byte(table, b);
    return hn::Or(hn::Or(red, hn::ShiftLeft<8>(green)), hn::ShiftLeft<16>(blue));
}

HWY_INLINE void encode_block(const SrgbBytes& table, const ColorPacket& linear,
                             Lanes<std::uint32_t>& bytes) {
    const auto zero = hn::Zero(kFloats);
    const auto one = set(1.0F);
    for (int i = 0; i < kLanes; i += kStep) {
        const auto a = load(linear.a, i);
        auto r = load(linear.r, i);
        auto g = load(linear.g, i);
        auto b = load(linear.b, i);
        if (!hn::AllTrue(kFloats, hn::Eq(a, one))) {
            const auto seen = hn::Gt(a, zero);
            const auto scale = hn::IfThenElseZero(seen, hn::Div(one, hn::IfThenElse(seen, a, one)));
            r = hn::Mul(r, scale);
            g = hn::Mul(g, scale);
            b = hn::Mul(b, scale);
        }
        const auto alpha = hn::ConvertTo(
            kIntegers, hn::Add(hn::Mul(hn::Min(hn::Max(a, zero), one), set(255.0F)), set(0.5F)));
        const auto pixel = hn::Or(srgb_bytes(table, r, g, b), hn::ShiftLeft<24>(alpha));
        store(hn::BitCast(kWords, pixel), bytes, i);
    }
}

void encode(const SrgbBytes& table, const ColorPacket* const* linear,
            std::span<Lanes<std::uint32_t>> bytes) {
    for (Lanes<std::uint32_t>& block : bytes) {
        if (*linear != nullptr) encode_block(table, **linear, block);
        ++linear;
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

namespace {

/// IEC 61966-2-1.
double to_linear(double display) {
    return display <= 0.04045 ? display / 12.92 : std::pow((display + 0.055) / 1.055, 2.4);
}

/// Bits of the smallest float whose nearest byte is `byte` > 0.
std::int32_t first_bits(int byte) {
    const double edge = to_linear((byte - 0.5) / 255.0);
    auto nearest = static_cast<float>(edge);
    if (static_cast<double>(nearest) < edge) nearest = std::nextafter(nearest, 1.0F);
    return std::bit_cast<std::int32_t>(nearest);
}

}  // namespace

SrgbBytes::SrgbBytes() {
    int byte = 0;
    std::int32_t next = first_bits(1);
    for (std::size_t k = 0; k < kEntries; ++k) {
        const std::int32_t start = kFirst + static_cast<std::int32_t>(k << kShift);
        entries[k] = byte << kShift;
        if (byte == 255 || next - start > kWithin) continue;
        entries[k] += (1 << kShift) - (next - start);
        if (++byte < 255) next = first_bits(byte + 1);
    }
}

HWY_EXPORT(encode);

void encode_bytes(const ColorPacket* const* linear, std::span<Lanes<std::uint32_t>> bytes) {
    static const SrgbBytes kTable;
    HWY_DYNAMIC_DISPATCH(encode)(kTable, linear, bytes);
}

void encode_bytes(const ColorPacket& linear, Lanes<std::uint32_t>& bytes) {
    const ColorPacket* const one = &linear;
    encode_bytes(&one, {&bytes, 1});
}

}  // namespace ink

#endif
