#include "render/tiles.h"

#include <algorithm>
#include <cstdint>

namespace ink {

int count_tiles(int length, int side, int spare) {
    return std::max((length - std::min(spare, side - 1) + side - 1) / side, 1);
}

std::vector<Tile> cut_into_tiles(Size size, int side, int spare) {
    const int across = count_tiles(size.width, side, spare);
    const int down = count_tiles(size.height, side, spare);
    std::vector<Tile> tiles;
    for (int j = 0; j < down; ++j) {
        for (int i = 0; i < across; ++i) {
            tiles.push_back({i * side, j * side, i + 1 < across ? (i + 1) * side : size.width,
                             j + 1 < down ? (j + 1) * side : size.height});
        }
    }
    return tiles;
}

void sort_blocks(const Tile& tile, const Sampler& sampler, float reach,
                 std::vector<Block>& near_scene, std::vector<Block>& empty) {
    near_scene.clear();
    empty.clear();
    const auto box = [&](int x, int y, int end) -> ScreenBox {
        const auto top = static_cast<float>(y);
        return {static_cast<float>(x) - reach, top - reach, static_cast<float>(end) + reach,
                top + kBlockSide + reach};
    };
    for (int y = tile.y0; y < tile.y1; y += kBlockSide) {
        // Most rows without anything are told by one question.
        const bool any = sampler.reaches(box(tile.x0, y, tile.x1 + kBlockSide - 1));
        std::uint64_t reached = 0;
        for (int k = 0, x = tile.x0; x < tile.x1; ++k, x += kBlockSide, reached >>= 1U) {
            if (any && k % 64 == 0) {
                const int count = std::min((tile.x1 - x + kBlockSide - 1) / kBlockSide, 64);
                reached = sampler.reached(box(x, y, x + kBlockSide), kBlockSide, count);
            }
            ((reached & 1U) != 0 ? near_scene : empty).push_back({x, y});
        }
    }
}

}  // namespace ink
