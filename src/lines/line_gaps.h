#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lines/placed_lines.h"
#include "lines/segment.h"

namespace ink {

/// Which gaps are closed.
struct GapSettings {
    float longest = 4.0F;         ///< widths of the line
    float longest_cells = 8.0F;   ///< or so many lattice spacings, if that is more
    float least_ahead = 0.95F;    ///< cosine between the way of an end and the way to the other
    float least_strength = 0.5F;  ///< of both lines: what fades out goes on nowhere
    /// Another line at a larger angle than this (its sine), on the way or at an end of it, is what
    /// the line ends on.
    float crossing = 0.5F;
};

/// Two creases, self-occlusions or boundaries that end on nothing and look at each other over a
/// short gap are one line that got lost: where it runs beside another, the strip between them was
/// too narrow to be seen. Returns the pieces in between. `lines`: all of the picture's that are
/// seen directly, of which some, by their indices, are `gone`; `width`: of a self-occlusion,
/// pixels. The result does not depend on their order.
std::vector<Segment> close_gaps(const plane::PlacedLines& lines, std::span<const std::size_t> gone,
                                float spacing, float width, const GapSettings& settings = {});

}  // namespace ink
