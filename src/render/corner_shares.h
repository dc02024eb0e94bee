#pragma once

#include <array>
#include <cstddef>
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

/// Linear, premultiplied R, G, B, A.
using PixelColor = std::array<float, 4>;
/// What smoothing adds to one. In fixed point, for a sum that does not depend on the order of
/// segments, and so not on the tiles.
using ColorShift = std::array<std::int32_t, 4>;
inline constexpr float kShiftScale = 1 << 22;

/// Sums of the shifts of a tile's pixels, and of one more column and row.
struct ShiftPlane {
    ColorShift* shifts;  ///< row by row
    std::size_t stride;
    std::uint8_t* touched;  ///< blocks that have any
    std::size_t across;     ///< blocks
    int x0, y0, width, height;
};

/// Adds the first `count` segments' changes of colour, each by its share, to the pixels at the
/// corners of their cells, for one lattice point a pixel. Bit i of the result is set if segment i
/// lies in no cell of the tile and is left out.
std::uint32_t spread_shares(const CornerShares& shares,
                            const std::array<PixelColor, kLanes>& changes, int count,
                            const ShiftPlane& plane);

}  // namespace ink
