#pragma once

#include <cstdint>

namespace ink {

/// How far a pixel's centre is from the nearest side of the triangle that it sees, and which way
/// that runs, as far as its ink depends on it: the distance in the upper 16 bits, in shares of some
/// greatest one, the lesser part of the unit normal in the lower.
struct BorderCode {
    static constexpr float kSteps = 65535.0F;
    static constexpr float kMostNarrow = 0.70710678F;
    static constexpr std::uint32_t kNone = 0xFFFF0000U;  ///< as far as can be told, or more
};

}  // namespace ink
