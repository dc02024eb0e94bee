#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "lines/segment.h"

namespace ink::plane {

inline float length(Vec2f v) { return std::sqrt(v.x * v.x + v.y * v.y); }
inline Vec2f unit(Vec2f v) { return v * (1.0F / std::max(length(v), 1e-12F)); }
inline float dot(Vec2f a, Vec2f b) { return a.x * b.x + a.y * b.y; }
inline Vec2f left_of(Vec2f way) { return {way.y, -way.x}; }

inline Vec2f nearest_on(const Segment& s, Vec2f p) {
    const Vec2f d = s.b - s.a;
    const float squared = dot(d, d);
    if (squared == 0.0F) return s.a;
    return s.a + d * std::clamp(dot(p - s.a, d) / squared, 0.0F, 1.0F);
}

/// Segments by squares of the picture, to ask which are near a point.
class SegmentSquares {
  public:
    explicit SegmentSquares(std::span<const Segment> segments) {
        if (segments.empty()) return;
        std::vector<Vec2f> middles;
        middles.reserve(segments.size());
        for (const Segment& segment : segments) middles.push_back(middle(segment));
        lower_ = middles[0];
        Vec2f upper = lower_;
        for (const Vec2f p : middles) {
            lower_ = {std::min(lower_.x, p.x), std::min(lower_.y, p.y)};
            upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
        }
        // No more squares than a few a segment.
        const Vec2f size = upper - lower_;
        const auto few = static_cast<float>(4 * segments.size() + 4096);
        while ((size.x / side_ + 1.0F) * (size.y / side_ + 1.0F) > few) side_ *= 2.0F;
        across_ = column(upper) + 1;
        down_ = row(upper) + 1;
        std::vector<std::uint32_t> squares;
        squares.reserve(segments.size());
        for (const Vec2f p : middles) {
            squares.push_back(static_cast<std::uint32_t>(row(p) * across_ + column(p)));
        }
        // Counted two places ahead: filling moves every start to its end, the next one's start.
        starts_.assign(static_cast<std::size_t>(across_ * down_) + 2, 0);
        for (const std::uint32_t square : squares) ++starts_[square + 2];
        std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
        entries_.resize(segments.size());
        for (std::uint32_t k = 0; k < segments.size(); ++k) {
            entries_[starts_[squares[k] + 1]++] = {middles[k], k};
        }
    }

    /// Calls `visit` for every segment whose middle is within `reach` of `p`, in x and in y.
    template <class Visit>
    void near(Vec2f p, float reach, Visit visit) const {
        const Vec2f low = p - Vec2f{reach, reach};
        const Vec2f high = p + Vec2f{reach, reach};
        for (int j = std::max(row(low), 0); j <= std::min(row(high), down_ - 1); ++j) {
            for (int i = std::max(column(low), 0); i <= std::min(column(high), across_ - 1); ++i) {
                const auto square = static_cast<std::size_t>(j * across_ + i);
                for (std::uint32_t n = starts_[square]; n < starts_[square + 1]; ++n) {
                    const Entry& entry = entries_[n];
                    if (std::abs(entry.middle.x - p.x) > reach) continue;
                    if (std::abs(entry.middle.y - p.y) > reach) continue;
                    visit(entry.segment);
                }
            }
        }
    }

  private:
    struct Entry {
        Vec2f middle;
        std::uint32_t segment;
    };

    static Vec2f middle(const Segment& s) { return (s.a + s.b) * 0.5F; }
    int column(Vec2f p) const { return static_cast<int>(std::floor((p.x - lower_.x) / side_)); }
    int row(Vec2f p) const { return static_cast<int>(std::floor((p.y - lower_.y) / side_)); }

    float side_ = 16.0F;  ///< pixels
    Vec2f lower_;
    int across_ = 0, down_ = 0;          ///< squares
    std::vector<std::uint32_t> starts_;  ///< of the squares, row by row, in the entries
    std::vector<Entry> entries_;         ///< square by square
};

}  // namespace ink::plane
