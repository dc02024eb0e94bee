#include "render/lattice_blocks.h"

#include <algorithm>
#include <bit>

namespace ink {

namespace {

ScreenBox screen_box(const Block& block, float spacing) {
    const auto left = static_cast<float>(block.x);
    const auto top = static_cast<float>(block.y);
    const int columns = block.is_strip() ? block.columns : kBlockSide;
    const int rows = block.is_strip() ? block.rows : kBlockSide;
    return {left * spacing, top * spacing, (left + static_cast<float>(columns)) * spacing,
            (top + static_cast<float>(rows)) * spacing};
}

}  // namespace

void LatticeBlocks::lay(const SampleGrid& grid, const Sampler& sampler, bool strips, bool whole) {
    const auto in_blocks = [&](int points) {
        return strips && points % kBlockSide == 1 ? points - 1 : points;
    };
    columns_ = in_blocks(grid.width);
    rows_ = in_blocks(grid.height);
    const auto blocks_for = [](int points) { return (points + kBlockSide - 1) / kBlockSide; };
    blocks_across_ = blocks_for(columns_);
    const int blocks_down = blocks_for(rows_);
    block_at_.assign(
        static_cast<std::size_t>(blocks_across_) * static_cast<std::size_t>(blocks_down), kEmpty);
    packets_.clear();
    for (int row = 0; row < blocks_down; ++row) lay_row(grid, sampler, row, whole);
    down_.clear();
    across_.clear();
    for (int j = 0; columns_ < grid.width && j < grid.height; j += kLanes) {
        down_.push_back(
            lay_strip(grid, sampler,
                      {grid.x0 + columns_, grid.y0 + j, 1, std::min(kLanes, grid.height - j), 1}));
    }
    for (int i = 0; rows_ < grid.height && i < columns_; i += kLanes) {
        across_.push_back(
            lay_strip(grid, sampler,
                      {grid.x0 + i, grid.y0 + rows_, std::min(kLanes, columns_ - i), 1, kLanes}));
    }
}

void LatticeBlocks::lay_row(const SampleGrid& grid, const Sampler& sampler, int row, bool whole) {
    const int y = grid.y0 + row * kBlockSide;
    // Most rows without anything are told by one question.
    const ScreenBox first = screen_box({grid.x0, y}, grid.spacing);
    const ScreenBox last = screen_box({grid.x0 + columns_ - 1, y}, grid.spacing);
    if (!sampler.reaches({first.left, first.top, last.right, first.bottom})) return;
    constexpr int kAtOnce = 64;
    for (int k = 0; k < blocks_across_; k += kAtOnce) {
        const ScreenBox box = screen_box({grid.x0 + k * kBlockSide, y}, grid.spacing);
        std::uint64_t reached =
            sampler.reached(box, kBlockSide * grid.spacing, std::min(blocks_across_ - k, kAtOnce));
        for (; reached != 0; reached &= reached - 1) {
            const int column = k + std::countr_zero(reached);
            block_at_[index(column, row)] = static_cast<std::uint32_t>(packets_.size());
            // Field by field: to copy at once what was stored in pieces takes a wait.
            Block& block = packets_.emplace_back();
            block.x = grid.x0 + column * kBlockSide;
            block.y = y;
            block.columns = std::min(kBlockSide, columns_ - column * kBlockSide);
            block.rows = std::min(kBlockSide, rows_ - row * kBlockSide);
            block.whole = whole;
        }
    }
}

/// Its place among the packets.
std::uint32_t LatticeBlocks::lay_strip(const SampleGrid& grid, const Sampler& sampler,
                                       const Block& strip) {
    if (!sampler.reaches(screen_box(strip, grid.spacing))) return kEmpty;
    packets_.push_back(strip);
    return static_cast<std::uint32_t>(packets_.size() - 1);
}

}  // namespace ink
