#pragma once

#include <span>

#include "base/vec.h"

namespace ink {

/// The squares of a LineDensity, row by row, by value, so that nothing that a loop writes can
/// change them. Places are shrunk and shifted first.
struct DensityRaster {
    /// What a square adds to the shares of places near it.
    struct Square {
        float inked = 0.0F;     ///< square pixels
        float searched = 0.0F;  ///< likewise
    };

    const Square* squares;
    Vec2f shift;
    float shrink, per_square;
    int i0, j0, i1,
        j1;  ///< the first squares that have neighbours to the right and below, the last
    int across;
};

/// Of many places: between the middles of four squares, in proportion, what is inked of what was
/// searched. Squares cut by the border weigh less.
void find_shares(const DensityRaster& raster, std::span<const Vec2f> places,
                 std::span<float> shares);

}  // namespace ink
