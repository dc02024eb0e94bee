#pragma once

#include <vector>

#include "base/image.h"
#include "camera/camera.h"
#include "sampling/sampler.h"

namespace ink {

/// A rectangle of blocks that one thread works on.
struct Tile {
    int x0, y0, x1, y1;  ///< pixels, x1 and y1 exclusive; x0, y0 multiples of kBlockSide
};

/// The picture cut into squares of `side` pixels, row by row.
std::vector<Tile> cut_into_tiles(Size size, int side);

/// The blocks of a tile, which the sampler has entered, split by whether any ray through a point
/// within `reach` pixels of the block can hit the scene.
void sort_blocks(const Tile& tile, const Sampler& sampler, float reach,
                 std::vector<Block>& near_scene, std::vector<Block>& empty);

}  // namespace ink
