#pragma once

#include <array>
#include <cstdint>

#include "base/lanes.h"

namespace ink {

/// Sixteen segments, from a to b, pixels.
struct SegmentEnds {
    Lanes<float> ax, ay, bx, by;
};

/// The cells of the lattice that they lie in, and for each corner of a cell (upper left and right,
/// lower left and right) the area of its quarter that lies beyond the segment, square pixels:
/// positive for corners on the segment's left, negative on its right.
struct CornerShares {
    Lanes<std::int32_t> cell_x, cell_y;
    std::array<Lanes<float>, 4> area;
};

/// For `lattice` points along a pixel's side.
void find_corner_shares(const SegmentEnds& segments, int lattice, CornerShares& shares);

}  // namespace ink
