#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include <hwy/highway.h>

#include "base/image.h"
#include "base/lanes.h"
#include "base/multiversion.h"

namespace ink {

// Blocks of 4 x 4 pixels from and to planes of a picture of `size`, at (x, y). Pixels beyond the
// picture's edge are left out.

template <class T>
void copy_block(Size size, int x, int y, const Lanes<T>& block, T* plane) {
    const auto width = static_cast<std::size_t>(size.width);
    T* row = plane + static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
    const T* from = block.data();
    if (x + kBlockSide <= size.width && y + kBlockSide <= size.height) {
        for (int j = 0; j < kBlockSide; ++j) {
            std::memcpy(row, from, kBlockSide * sizeof(T));
            row += width;
            from += kBlockSide;
        }
        return;
    }
    for (int j = 0; j < std::min(kBlockSide, size.height - y); ++j) {
        std::copy_n(from, std::min(kBlockSide, size.width - x), row);
        row += width;
        from += kBlockSide;
    }
}

/// Lays ink, which is a colour times alpha, over what is there: without ink, x * 1 + 0 is x.
INKTRACE_INLINE void lay_on_plane(Size size, int x, int y, const Lanes<float>& alpha,
                                  const Lanes<float>& ink, float* plane) {
    const auto width = static_cast<std::size_t>(size.width);
    float* row = plane + static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
    const int columns = std::min(kBlockSide, size.width - x);
    const int rows = std::min(kBlockSide, size.height - y);
    const auto lay = [&](int j, int i) {
        const int lane = j * kBlockSide + i;
        row[i] = row[i] * (1.0F - alpha[lane]) + ink[lane];
    };
    for (int j = 0; j < rows; ++j, row += width) {
        if (columns == kBlockSide) {
            for (int i = 0; i < kBlockSide; ++i) lay(j, i);
        } else {
            for (int i = 0; i < columns; ++i) lay(j, i);
        }
    }
}

/// copy_block of blocks side by side, row after row. Whole cache lines go to memory past the
/// caches, which otherwise read what is then overwritten; others see them after hwy::FlushStream.
template <class T>
void copy_blocks(Size size, int x, int y, std::span<const Lanes<T>* const> blocks, T* plane) {
    const auto width = static_cast<std::size_t>(size.width);
    T* row = plane + static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
    const auto whole =
        std::min(blocks.size(), static_cast<std::size_t>((size.width - x) / kBlockSide));
    // Four lanes are what every processor has.
    constexpr hwy::HWY_NAMESPACE::FixedTag<T, kBlockSide> kRow;
    constexpr std::size_t kLine = 64 / (kBlockSide * sizeof(T));  // blocks to a cache line
    constexpr std::size_t kLarge = std::size_t{1} << 20;  // a picture of less may stay in a cache
    const bool large = size.pixels() * sizeof(T) >= kLarge;
    for (int j = 0; j < std::min(kBlockSide, size.height - y); ++j, row += width) {
        const auto values = [&](std::size_t k) {
            return hwy::HWY_NAMESPACE::Load(kRow, blocks[k]->data() + j * kBlockSide);
        };
        for (std::size_t k = 0; k < whole;) {
            T* const to = row + k * kBlockSide;
            if (large && reinterpret_cast<std::uintptr_t>(to) % 64 == 0 && k + kLine <= whole) {
                for (std::size_t n = 0; n < kLine; ++n) {
                    hwy::HWY_NAMESPACE::Stream(values(k + n), kRow, to + n * kBlockSide);
                }
                k += kLine;
            } else {
                hwy::HWY_NAMESPACE::StoreU(values(k++), kRow, to);
            }
        }
    }
    if (whole == blocks.size()) return;
    copy_block(size, x + static_cast<int>(whole) * kBlockSide, y, *blocks[whole], plane);
}

/// The other way; lanes beyond the edge are left as they are.
template <class T>
void load_block(Size size, int x, int y, const T* plane, Lanes<T>& block) {
    const auto width = static_cast<std::size_t>(size.width);
    const T* row = plane + static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
    T* to = block.data();
    const bool whole = x + kBlockSide <= size.width;
    for (int j = 0; j < std::min(kBlockSide, size.height - y); ++j) {
        if (whole) {
            std::memcpy(to, row, kBlockSide * sizeof(T));
        } else {
            std::copy_n(row, size.width - x, to);
        }
        row += width;
        to += kBlockSide;
    }
}

}  // namespace ink
