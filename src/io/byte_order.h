#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace ink {

/// Whether numbers that a file holds in this order are turned round to be read here.
constexpr bool is_foreign(std::endian order) { return order != std::endian::native; }

/// The number whose bytes, at any address, these are; `swap`: in the foreign order.
template <class T>
T load(const char* bytes, bool swap) {
    std::array<char, sizeof(T)> copy;
    std::memcpy(copy.data(), bytes, sizeof(T));
    if (swap) std::ranges::reverse(copy);
    return std::bit_cast<T>(copy);
}

}  // namespace ink
