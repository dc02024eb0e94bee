#include "render/line_mask.h"

#include <algorithm>
#include <cmath>

namespace ink {

namespace {

/// Bit i and those after it, and bit i and those before it.
std::uint64_t bits_from(std::size_t i) { return ~std::uint64_t{0} << i; }
std::uint64_t bits_up_to(std::size_t i) { return ~std::uint64_t{0} >> (63 - i); }

}  // namespace

void LineMask::mark(Vec2f point, float reach) {
    // Pixel i has its middle at i + 1/2.
    const auto first = [](float at) { return static_cast<int>(std::ceil(at - 0.5F)); };
    const auto last = [](float at) { return static_cast<int>(std::floor(at - 0.5F)); };
    const int bottom = std::min(last(point.y + reach), area_.y1 - 1);
    for (int y = std::max(first(point.y - reach), area_.y0); y <= bottom; ++y) {
        const float dy = static_cast<float>(y) + 0.5F - point.y;
        const float half = std::sqrt(std::max(reach * reach - dy * dy, 0.0F));
        const int left = std::max(first(point.x - half), area_.x0) - area_.x0;
        const int right = std::min(last(point.x + half), area_.x1 - 1) - area_.x0;
        if (left > right) continue;
        const auto from = static_cast<std::size_t>(left);
        const auto to = static_cast<std::size_t>(right);
        std::uint64_t* const words = row(y);
        for (std::size_t k = from / kBits; k <= to / kBits; ++k) {
            words[k] |= (k == from / kBits ? bits_from(from % kBits) : ~std::uint64_t{0}) &
                        (k == to / kBits ? bits_up_to(to % kBits) : ~std::uint64_t{0});
        }
    }
}

bool LineMask::covers(Vec2f point) const {
    const auto x = static_cast<int>(std::floor(point.x));
    const auto y = static_cast<int>(std::floor(point.y));
    if (x < area_.x0 || x >= area_.x1 || y < area_.y0 || y >= area_.y1) return false;
    const auto column = static_cast<std::size_t>(x - area_.x0);
    const std::size_t word =
        static_cast<std::size_t>(y - area_.y0) * words_across_ + column / kBits;
    return (words_[word] >> column % kBits & 1U) != 0;
}

}  // namespace ink
