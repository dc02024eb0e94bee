#pragma once

#include <cstdint>
#include <span>

#include "lines/segment_squares.h"

namespace ink::plane {

/// Lines of a picture, the last few of which join the others, with their places.
class PlacedLines {
  public:
    /// `found`: the places of the first lines, all but those that join them.
    PlacedLines(std::span<const Segment> all, std::size_t first_joining,
                const SegmentSquares& found)
        : all_(all),
          first_joining_(first_joining),
          found_(found),
          joining_(all.subspan(first_joining)) {}

    std::span<const Segment> all() const { return all_; }
    std::size_t first_joining() const { return first_joining_; }

    /// Calls `visit` for every line whose middle is within `reach` of `p`, in x and in y.
    template <class Visit>
    void near(Vec2f p, float reach, const Visit& visit) const {
        found_.near(p, reach, visit);
        const auto first = static_cast<std::uint32_t>(first_joining_);
        joining_.near(p, reach, [&](std::uint32_t k) { visit(first + k); });
    }

  private:
    std::span<const Segment> all_;
    std::size_t first_joining_;
    const SegmentSquares& found_;
    SegmentSquares joining_;
};

}  // namespace ink::plane
