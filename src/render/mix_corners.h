#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/lanes.h"
#include "base/vec.h"
#include "lines/segment.h"

namespace ink {

/// The corners of a cell of a lattice, the upper ones first, with the pixels that they saw.
struct CellCorners {
    std::array<Vec2f, 4> places;
    std::array<std::uint32_t, 4> pixels;
};

/// A line that colours change across, and on which sides of it the corners of its cell lie.
struct DividingLine {
    DividingLine(const Segment& line, const CellCorners& corners);
    Vec2f start, way;
    std::array<float, 4> sides;  ///< their signs tell
    /// How much what lies beyond it differs.
    float weight;
};

/// Pixels about sixteen points of a cell.
struct MixedPixels {
    Lanes<std::uint32_t> pixels;
    std::uint32_t known;                ///< a bit for each whose pixel is known
    Lanes<std::int32_t> nearest, seen;  ///< corners: of all, and of those that are mixed
};

/// Mixes the corners in proportion, those only that no line divides from the point. Where there are
/// none, as in a strip between two lines, those that are divided from it by the least.
void mix_corners(const CellCorners& corners, std::span<const DividingLine> lines,
                 const Lanes<float>& x, const Lanes<float>& y, MixedPixels& mixed);

}  // namespace ink
