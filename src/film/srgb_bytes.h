#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/lanes.h"
#include "shading/shading.h"

namespace ink {

/// From linear light to the nearest sRGB byte, by one look-up.
///
/// Floats are cut into intervals so short that the byte changes at most once in each: 128 an octave
/// between 2^-13, below which it is 0, and 1. An entry is the byte at the interval's start, times
/// 2^16, plus what carries into it from where the byte changes on.
struct SrgbBytes {
    static constexpr unsigned kShift = 16;
    static constexpr std::int32_t kWithin = (1 << kShift) - 1;
    static constexpr auto kFirst = std::bit_cast<std::int32_t>(0x1p-13F);
    static constexpr auto kOne = std::bit_cast<std::int32_t>(1.0F);
    static constexpr std::size_t kEntries = ((kOne - kFirst) >> kShift) + 1;

    std::array<std::int32_t, kEntries> entries;

    SrgbBytes();
};

/// Pixels R, G, B, A with straight alpha, from linear light times alpha.
void encode_bytes(const ColorPacket& linear, Lanes<std::uint32_t>& bytes);
/// The same of as many blocks as there is room for, unless they are null.
void encode_bytes(const ColorPacket* const* linear, std::span<Lanes<std::uint32_t>> bytes);

}  // namespace ink
