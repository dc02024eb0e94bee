#include "render/block_mean.h"

#include <array>
#include <cstddef>

#include "base/multiversion.h"

namespace ink {

namespace {

constexpr std::size_t kSide = kBlockSide;

/// One channel. Sums go over a pixel's points row by row, as for a single pixel, so that both give
/// the same bits.
template <std::size_t q>
INKTRACE_INLINE void mean_of_channel(const std::array<const Lanes<float>*, q * q>& blocks,
                                     Lanes<float>& __restrict mean) {
    constexpr float kWeight = 1.0F / static_cast<float>(q * q);
    std::array<float, kSide * kSide> sums{};
    for (std::size_t j = 0; j < q * kSide; ++j) {
        std::array<float, q * kSide> row;
        for (std::size_t i = 0; i < q * kSide; ++i) {
            const Lanes<float>& block = *blocks[j / kSide * q + i / kSide];
            row[i] = block.data()[j % kSide * kSide + i % kSide] * kWeight;
        }
        for (std::size_t s = 0; s < q; ++s) {
            for (std::size_t x = 0; x < kSide; ++x) sums[j / q * kSide + x] += row[x * q + s];
        }
    }
    for (std::size_t k = 0; k < sums.size(); ++k) mean.data()[k] = sums[k];
}

template <std::size_t q>
INKTRACE_INLINE void mean_of(std::span<const ColorPacket* const> blocks, ColorPacket& mean) {
    for (const auto channel :
         {&ColorPacket::r, &ColorPacket::g, &ColorPacket::b, &ColorPacket::a}) {
        std::array<const Lanes<float>*, q * q> planes;
        for (std::size_t n = 0; n < q * q; ++n) planes[n] = &(blocks[n]->*channel);
        mean_of_channel<q>(planes, mean.*channel);
    }
}

INKTRACE_MULTIVERSION
void mean_of_4(std::span<const ColorPacket* const> blocks, ColorPacket& mean) {
    mean_of<2>(blocks, mean);
}
INKTRACE_MULTIVERSION
void mean_of_9(std::span<const ColorPacket* const> blocks, ColorPacket& mean) {
    mean_of<3>(blocks, mean);
}
INKTRACE_MULTIVERSION
void mean_of_16(std::span<const ColorPacket* const> blocks, ColorPacket& mean) {
    mean_of<4>(blocks, mean);
}

}  // namespace

ColorPacket mean_of_blocks(std::span<const ColorPacket* const> blocks, int q) {
    ColorPacket mean;
    if (q == 2) mean_of_4(blocks, mean);
    if (q == 3) mean_of_9(blocks, mean);
    if (q == 4) mean_of_16(blocks, mean);
    return mean;
}

}  // namespace ink
