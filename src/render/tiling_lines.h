#pragma once

#include <array>
#include <cstdint>

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

/// What the lines about a spot ink of the pixels about sixteen points, by the area under a band
/// along the nearest one; where that is less, `alpha` stays as it is.
void ink(const TilingSpot& spot, float factor, const Lanes<float>& x, const Lanes<float>& y,
         FaceBand band, Lanes<float>& alpha);

}  // namespace ink
