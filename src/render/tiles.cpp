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
    const auto reaches = [&](int x, int y, int end) {
        const auto top = static_cast<float>(y);
        return sampler.reaches({static_cast<float>(x) - reach, top - reach,
                                static_cast<float>(end) + reach, top + kBlockSide + reach});
    };
    for (int y = tile.y0; y < tile.y1; y += kBlockSide) {
        // Most rows without anything are told by one question.
        const bool any = reaches(tile.x0, y, tile.x1 + kBlockSide - 1);
        for (int x = tile.x0; x < tile.x1; x += kBlockSide) {
            (any && reaches(x, y, x + kBlockSide) ? near_scene : empty).push_back({x, y});
        }
    }
}

}  // namespace ink
