#pragma once

#include <array>
#include <cstddef>

#include "base/lanes.h"
#include "render/nearest_edges.h"

namespace ink {

/// Up to three families of parallel lines on the screen: where a number that changes evenly across
/// it is whole.
struct TilingLines {
    struct Family {
        float at, dx, dy;  ///< the number at the origin, and how a pixel's step changes it
        float nx, ny;      ///< unit, across the lines
        float apart;       ///< from one line to the next, pixels
    };
    std::array<Family, 3> families;
    std::size_t count = 0;
};

/// From sixteen points to the nearest line: distances and unit normals.
void find_nearest(const TilingLines& lines, const Lanes<float>& x, const Lanes<float>& y,
                  NearestEdges& nearest);

}  // namespace ink
