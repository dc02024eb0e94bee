#include "render/tiles.h"

#include <algorithm>

namespace ink {

std::vector<Tile> cut_into_tiles(Size size, int side) {
    std::vector<Tile> tiles;
    for (int y = 0; y < size.height; y += side) {
        for (int x = 0; x < size.width; x += side) {
            tiles.push_back(
                {x, y, std::min(x + side, size.width), std::min(y + side, size.height)});
        }
    }
    return tiles;
}

void sort_blocks(const Tile& tile, const Sampler& sampler, float reach,
                 std::vector<Block>& near_scene, std::vector<Block>& empty) {
    near_scene.clear();
    empty.clear();
    for (int y = tile.y0; y < tile.y1; y += kBlockSide) {
        for (int x = tile.x0; x < tile.x1; x += kBlockSide) {
            const auto left = static_cast<float>(x);
            const auto top = static_cast<float>(y);
            const bool near = sampler.reaches(
                {left - reach, top - reach, left + kBlockSide + reach, top + kBlockSide + reach});
            (near ? near_scene : empty).push_back({x, y});
        }
    }
}

}  // namespace ink
