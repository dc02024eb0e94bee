#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lines/segment.h"

namespace ink {

/// The end of a self-occlusion: a segment, and which of its ends nothing goes on from.
struct FoldTail {
    std::uint32_t fold;
    bool at_b;
};

/// Where two pieces of a self-occlusion run side by side, so that their strokes touch, one of them
/// is enough.
class FoldDoubles {
  public:
    /// `folds`: the self-occlusions among `lines`. `pieces`: a line's number is that of the piece
    /// it belongs to. `bridges` join pieces, each from one of its `owners` on.
    FoldDoubles(std::span<const Segment> lines, std::span<const std::uint32_t> folds,
                std::span<const std::uint32_t> pieces, std::span<const Segment> bridges,
                std::span<const std::uint32_t> owners);

    /// What comes after a segment, away from its end; beyond all lines if that is not one segment.
    using NextFunction = std::function<FoldTail(FoldTail)>;

    /// Drops each tail as far back as it runs beside another piece, nearer than `reach` pixels.
    /// Adds to those that are `gone` already; ascending.
    std::vector<std::size_t> drop(std::span<const FoldTail> tails, const NextFunction& next,
                                  std::span<const std::size_t> gone, float reach) const;

  private:
    std::span<const Segment> lines_;
    std::span<const std::uint32_t> folds_, pieces_;
    std::vector<Segment> drawn_;          ///< the folds, then the bridges
    std::vector<std::uint32_t> numbers_;  ///< of the fold, or that at which a bridge starts
};

}  // namespace ink
