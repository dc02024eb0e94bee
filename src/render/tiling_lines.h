#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "accel/tracer.h"
#include "base/lanes.h"
#include "render/face_band.h"
#include "render/nearest_edges.h"

namespace ink {

/// A triangle that a point sees.
struct TilingSpot {
    static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

    TriangleSides sides;
    float t;
    std::uint32_t object;  ///< and in its lowest three bits which sides have no line; or kNone
};

/// Up to three families of parallel lines on the screen: where a number that changes evenly across
/// it is whole. A family in each lane, and the fourth is nothing.
struct TilingLines {
    std::array<float, 4> at, dx, dy;  ///< the number at the origin, and how a pixel changes it
    std::array<float, 4> nx, ny;      ///< unit, across the lines
    std::array<float, 4> apart;       ///< from one line to the next, pixels
    std::uint32_t without;            ///< a bit for each that is not there
};

/// The lines about a point of a picture `factor` times smaller than theirs.
TilingLines lines_about(const TilingSpot& spot, float factor);

/// From sixteen points to the nearest line: distances and unit normals.
void find_nearest(const TilingLines& lines, const Lanes<float>& x, const Lanes<float>& y,
                  NearestEdges& nearest);

/// The lines of one family about each of sixteen spots, as in TilingLines, and what their coverage
/// of pixels depends on (see SquareCoverage), ready to be inked.
struct TilingFamily {
    Lanes<float> at, dx, dy, apart;
    Lanes<float> reach, flat, slope, corner;
};

/// Blocks of pixels side by side, each about one spot.
struct TilingBlocks {
    LaneBits which = 0;         ///< of sixteen
    Lanes<std::int32_t> spots;  ///< their indices; of those that are not, of any spot
    /// From the spot to the pixels of a block.
    std::array<const Lanes<float>*, kLanes> off_x;
    const Lanes<float>* off_y;  ///< likewise
};

/// What the lines about their spots, in a picture `factor` times smaller, ink of the pixels of some
/// blocks, by the area under a band along the nearest one; where that is less, `alphas` stay as
/// they are.
void ink(const TilingBlocks& blocks, const TilingSpot* spots, float factor, const RowBands& bands,
         std::span<Lanes<float>> alphas);

}  // namespace ink
