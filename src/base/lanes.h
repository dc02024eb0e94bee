#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace ink {

/// Rays travel in packets of 16, one cache line a field.
inline constexpr int kLanes = 16;

/// A packet of camera rays covers a block of 4 x 4 pixels: lane i is pixel (i % 4, i / 4) of it.
inline constexpr int kBlockSide = 4;

/// One value for each ray of a packet. Loops over it vectorise.
template <class T>
struct alignas(64) Lanes : std::array<T, kLanes> {
    static Lanes filled(T value) {
        Lanes lanes;
        lanes.fill(value);
        return lanes;
    }
    T& operator[](int lane) {
        return std::array<T, kLanes>::operator[](static_cast<std::size_t>(lane));
    }
    const T& operator[](int lane) const {
        return std::array<T, kLanes>::operator[](static_cast<std::size_t>(lane));
    }
};

/// Bit i is set for lane i.
using LaneBits = std::uint32_t;

}  // namespace ink
