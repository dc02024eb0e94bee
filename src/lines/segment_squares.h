#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
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
    SegmentSquares(std::span<const Segment> segments, float reach)
        : reach_(reach), side_(6.4F * reach) {
        entries_.reserve(segments.size());
        for (std::uint32_t k = 0; k < segments.size(); ++k) {
            entries_.emplace_back(square((segments[k].a + segments[k].b) * 0.5F), k);
        }
        std::ranges::sort(entries_);
    }

    /// Calls `visit` for every segment that may come within the reach of `p`.
    template <class Visit>
    void near(Vec2f p, Visit visit) const {
        for (const float dy : {-reach_, reach_}) {
            for (const float dx : {-reach_, reach_}) {
                const std::uint64_t key = square({p.x + dx, p.y + dy});
                const bool seen_before = (dx > 0.0F && key == square({p.x - reach_, p.y + dy})) ||
                                         (dy > 0.0F && key == square({p.x + dx, p.y - reach_}));
                if (seen_before) continue;
                auto at = std::ranges::lower_bound(entries_, std::pair{key, 0U});
                for (; at != entries_.end() && at->first == key; ++at) visit(at->second);
            }
        }
    }

  private:
    std::uint64_t square(Vec2f p) const {
        const auto at = [this](float x) {
            return static_cast<std::uint32_t>(static_cast<int>(std::floor(x / side_)) + (1 << 30));
        };
        return static_cast<std::uint64_t>(at(p.y)) << 32U | at(p.x);
    }

    float reach_, side_;  ///< a square is larger than the reach and a segment together
    std::vector<std::pair<std::uint64_t, std::uint32_t>> entries_;
};

}  // namespace ink::plane
