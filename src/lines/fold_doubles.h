#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lines/fold_graph.h"
#include "lines/segment.h"
#include "lines/segment_squares.h"

namespace ink {

/// Where two pieces of a self-occlusion run side by side, so that their strokes touch or nearly do,
/// one of them is enough.
class FoldDoubles {
  public:
    /// `squares`: those of `lines`. `pieces`: a line's number is that of the piece it belongs to.
    /// `bridges` join pieces, each from one of its `owners` on.
    FoldDoubles(std::span<const Segment> lines, const plane::SegmentSquares& squares,
                std::span<const std::uint32_t> pieces, std::span<const Segment> bridges,
                std::span<const std::uint32_t> owners)
        : lines_(lines), squares_(squares), pieces_(pieces), bridges_(bridges), owners_(owners) {}

    /// What comes after a segment, away from its end; beyond all lines if that is not one segment.
    using NextFunction = std::function<FoldEnd(FoldEnd)>;

    /// Drops each tail as far back as it runs beside another piece, nearer than `reach` pixels.
    /// Adds to those that are `gone` already; ascending.
    std::vector<std::size_t> drop(std::span<const FoldEnd> tails, const NextFunction& next,
                                  std::span<const std::size_t> gone, float reach) const;

  private:
    std::span<const Segment> lines_;
    const plane::SegmentSquares& squares_;
    std::span<const std::uint32_t> pieces_;
    std::span<const Segment> bridges_;
    std::span<const std::uint32_t> owners_;
};

}  // namespace ink
