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

/// How many tiles of `side` pixels a length is cut into. The last one may have up to `spare` pixels
/// more: to begin another for so few would cost more.
int count_tiles(int length, int side, int spare);

/// The picture cut into squares of `side` pixels, row by row; the last ones likewise.
std::vector<Tile> cut_into_tiles(Size size, int side, int spare = 0);

/// The blocks of a tile, which the sampler has entered, split by whether any ray through a point
/// within `reach` pixels of the block can hit the scene.
void sort_blocks(const Tile& tile, const Sampler& sampler, float reach,
                 std::vector<Block>& near_scene, std::vector<Block>& empty);

}  // namespace ink
