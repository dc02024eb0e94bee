#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace ink {

/// Deflate makes data at most 1032 times as small; what announces more is damaged.
constexpr std::size_t kMostInflation = 1040;

/// Unpacks a zlib stream that must fill `out` exactly; false where it is damaged or does not.
bool inflate_exactly(std::string_view packed, std::span<char> out);

}  // namespace ink
