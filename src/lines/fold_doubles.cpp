#include "lines/fold_doubles.h"

#include <algorithm>
#include <cmath>

#include "lines/segment_squares.h"

namespace ink {

std::vector<std::size_t> FoldDoubles::drop(std::span<const FoldEnd> tails, const NextFunction& next,
                                           std::span<const std::size_t> gone, float reach) const {
    using plane::dot;
    using plane::unit;
    std::vector<std::uint8_t> dropped(lines_.size());
    for (const std::size_t k : gone) dropped[k] = 1;
    const plane::SegmentSquares bridge_squares(bridges_);
    const auto is_double = [&](std::uint32_t k) {
        constexpr float kAlike = 0.7F;  // of directions
        constexpr float kBeyond = 0.2F;
        const Vec2f middle = (lines_[k].a + lines_[k].b) * 0.5F;
        const Vec2f way = unit(lines_[k].b - lines_[k].a);
        const auto doubles = [&](const Segment& other) {
            const Vec2f beside = plane::nearest_on(other, middle) - middle;
            // Not past its end.
            const bool abreast = std::abs(dot(unit(beside), way)) < kBeyond;
            const Vec2f other_way = unit(other.b - other.a);
            return abreast && std::abs(dot(other_way, way)) > kAlike &&
                   plane::length(beside) < reach;
        };
        bool found = false;
        const float near = reach + 1.0F;  // of its middle
        squares_.near(middle, near, [&](std::uint32_t n) {
            found = found || (lines_[n].type == LineType::self_occlusion &&
                              pieces_[n] != pieces_[k] && dropped[n] == 0 && doubles(lines_[n]));
        });
        bridge_squares.near(middle, near, [&](std::uint32_t n) {
            found = found || (pieces_[owners_[n]] != pieces_[k] && doubles(bridges_[n]));
        });
        return found;
    };
    for (FoldEnd tail : tails) {
        while (tail.fold < lines_.size() && dropped[tail.fold] == 0 && is_double(tail.fold)) {
            dropped[tail.fold] = 1;
            tail = next(tail);
        }
    }
    std::vector<std::size_t> all;
    for (std::size_t k = 0; k < dropped.size(); ++k) {
        if (dropped[k] != 0) all.push_back(k);
    }
    return all;
}

}  // namespace ink
