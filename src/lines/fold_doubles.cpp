#include "lines/fold_doubles.h"

#include <algorithm>
#include <cmath>

#include "lines/segment_squares.h"

namespace ink {

FoldDoubles::FoldDoubles(std::span<const Segment> lines, std::span<const std::uint32_t> folds,
                         std::span<const std::uint32_t> pieces, std::span<const Segment> bridges,
                         std::span<const std::uint32_t> owners)
    : lines_(lines), folds_(folds), pieces_(pieces), numbers_(folds.begin(), folds.end()) {
    for (const std::uint32_t k : folds) drawn_.push_back(lines[k]);
    drawn_.insert(drawn_.end(), bridges.begin(), bridges.end());
    numbers_.insert(numbers_.end(), owners.begin(), owners.end());
}

std::vector<std::size_t> FoldDoubles::drop(std::span<const FoldTail> tails,
                                           const NextFunction& next,
                                           std::span<const std::size_t> gone, float reach) const {
    using plane::dot;
    using plane::unit;
    std::vector<std::uint8_t> dropped(lines_.size());
    for (const std::size_t k : gone) dropped[k] = 1;
    const plane::SegmentSquares squares(drawn_, std::max(reach, 2.5F));
    const auto is_double = [&](std::uint32_t k) {
        constexpr float kAlike = 0.7F;  // of directions
        constexpr float kBeyond = 0.2F;
        const Vec2f middle = (lines_[k].a + lines_[k].b) * 0.5F;
        const Vec2f way = unit(lines_[k].b - lines_[k].a);
        bool found = false;
        squares.near(middle, [&](std::uint32_t n) {
            const bool is_bridge = n >= folds_.size();
            if (pieces_[numbers_[n]] == pieces_[k]) return;
            if (!is_bridge && dropped[numbers_[n]] != 0) return;
            const Vec2f beside = plane::nearest_on(drawn_[n], middle) - middle;
            // Not past its end.
            const bool abreast = std::abs(dot(unit(beside), way)) < kBeyond;
            const Vec2f other_way = unit(drawn_[n].b - drawn_[n].a);
            found |=
                abreast && std::abs(dot(other_way, way)) > kAlike && plane::length(beside) < reach;
        });
        return found;
    };
    for (FoldTail tail : tails) {
        while (tail.fold < lines_.size() && dropped[tail.fold] == 0 && is_double(tail.fold)) {
            dropped[tail.fold] = 1;
            tail = next(tail);
        }
    }
    std::vector<std::size_t> all;
    for (const std::uint32_t k : folds_) {
        if (dropped[k] != 0) all.push_back(k);
    }
    return all;
}

}  // namespace ink
