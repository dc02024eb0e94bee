#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/vec.h"

namespace ink::plane {

/// Where in the picture a few points are, by squares: to pass over most of what is far from all.
class PointMap {
  public:
    /// `point(item)` is where an item is. May be asked for points within `reach` of one.
    template <class Items, class Point>
    PointMap(const Items& items, Point point, float reach) : side_(std::max(8.0F, 2.0F * reach)) {
        Vec2f upper{-kFar, -kFar};
        for (const auto& item : items) {
            const Vec2f p = point(item);
            lower_ = {std::min(lower_.x, p.x - reach), std::min(lower_.y, p.y - reach)};
            upper = {std::max(upper.x, p.x + reach), std::max(upper.y, p.y + reach)};
        }
        if (!(lower_.x <= upper.x)) return;
        constexpr float kMost = 512.0F;  // squares across
        side_ = std::max({side_, (upper.x - lower_.x) / kMost, (upper.y - lower_.y) / kMost});
        across_ = square(upper.x, lower_.x) + 1;
        down_ = square(upper.y, lower_.y) + 1;
        marked_.assign(across_ * down_, 0);
        for (const auto& item : items) mark(point(item), reach);
    }

    /// False only if none is within the reach.
    bool may_have(Vec2f p) const {
        if (!(p.x >= lower_.x && p.y >= lower_.y)) return false;
        const std::size_t column = square(p.x, lower_.x);
        const std::size_t row = square(p.y, lower_.y);
        return column < across_ && row < down_ && marked_[row * across_ + column] != 0;
    }

  private:
    static constexpr float kFar = std::numeric_limits<float>::infinity();

    std::size_t square(float at, float from) const {
        return static_cast<std::size_t>((at - from) / side_);
    }
    void mark(Vec2f p, float reach) {
        const std::size_t right = square(p.x + reach, lower_.x);
        const std::size_t bottom = square(p.y + reach, lower_.y);
        for (std::size_t j = square(p.y - reach, lower_.y); j <= bottom; ++j) {
            for (std::size_t i = square(p.x - reach, lower_.x); i <= right; ++i) {
                marked_[j * across_ + i] = 1;
            }
        }
    }

    float side_;
    Vec2f lower_{kFar, kFar};
    std::size_t across_ = 0, down_ = 0;
    std::vector<std::uint8_t> marked_;  ///< of the squares, row by row
};

}  // namespace ink::plane
