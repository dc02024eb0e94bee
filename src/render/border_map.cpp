#include "render/border_map.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/multiversion.h"
#include "lines/ink_kernels.h"

namespace ink {

namespace {

/// False if all are out of reach.
INKTRACE_MULTIVERSION
bool encode(const BorderPacket& borders, float reach, Lanes<std::uint32_t>& codes) {
    std::int32_t near = 0;
    for (int i = 0; i < kLanes; ++i) near |= borders.distance[i] < reach ? 1 : 0;
    if (near == 0) return false;
    const float steps = BorderCode::kSteps / reach;
    constexpr float kNarrowSteps = BorderCode::kSteps / BorderCode::kMostNarrow;
    for (int i = 0; i < kLanes; ++i) {
        const float distance = std::min(borders.distance[i] * steps, BorderCode::kSteps);
        const float narrow = std::min(std::abs(borders.nx[i]), std::abs(borders.ny[i]));
        const float narrow_steps = std::min(narrow * kNarrowSteps, BorderCode::kSteps);
        const auto high = static_cast<std::uint32_t>(static_cast<std::int32_t>(distance + 0.5F));
        const auto low = static_cast<std::uint32_t>(static_cast<std::int32_t>(narrow_steps + 0.5F));
        codes[i] = high << 16U | low;
    }
    return true;
}

}  // namespace

BorderMap::BorderMap(Size size, float reach, bool depths)
    : size_(size),
      reach_(reach),
      blocks_across_((size.width + kBlockSide - 1) / kBlockSide),
      seen_(static_cast<std::size_t>(blocks_across_) *
            static_cast<std::size_t>((size.height + kBlockSide - 1) / kBlockSide)),
      codes_(seen_.size()),
      depths_(depths ? seen_.size() : 0) {}

void BorderMap::put(int x, int y, const BorderPacket& borders, const Lanes<float>& t) {
    if (x < 0 || y < 0 || x >= size_.width || y >= size_.height) return;
    const std::size_t k = block(x, y);
    if (!encode(borders, reach_, codes_[k])) return;
    seen_[k] = 1;
    if (!depths_.empty()) depths_[k] = t;
}

LaneBits BorderMap::ink(int x, int y, LaneBits seeing, const RowBands& bands,
                        std::span<Lanes<float>> alphas) const {
    LaneBits inked = 0;
    for (LaneBits left = seeing; left != 0; left &= left - 1) {
        const int k = std::countr_zero(left);
        const bool any = ink_borders(codes(x + k * kBlockSide, y), reach_, bands.half[k],
                                     bands.opacity, alphas[static_cast<std::size_t>(k)]);
        inked |= any ? LaneBits{1} << k : 0U;
    }
    return inked;
}

}  // namespace ink
