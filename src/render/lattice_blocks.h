#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sampling/sampler.h"
#include "sampling/samples.h"

namespace ink {

/// The packets in which the lattice points of a tile are traced: blocks of 4 x 4, and strips of
/// sixteen where one column or row is left over. Those in whose part of the screen there is nothing
/// are left out.
class LatticeBlocks {
  public:
    static constexpr std::uint32_t kEmpty = 0xFFFFFFFFU;  ///< instead of a packet's index
    struct Place {
        std::uint32_t packet;  ///< or kEmpty
        int lane;
    };

    /// Lays out the points of a grid, in the part of the screen that `sampler` has entered.
    /// `strips`: whether strips may be laid. `whole`: see Block.
    void lay(const SampleGrid& grid, const Sampler& sampler, bool strips, bool whole);

    std::span<const Block> packets() const { return packets_; }
    std::size_t size() const { return packets_.size(); }
    const Block& operator[](std::size_t k) const { return packets_[k]; }
    std::size_t strips() const { return down_.size() + across_.size(); }

    /// Of a point of the grid.
    Place place_of(int i, int j) const {
        if (i < columns_ && j < rows_) {
            // Without a sign, to divide is to shift.
            const auto x = static_cast<unsigned>(i);
            const auto y = static_cast<unsigned>(j);
            constexpr unsigned kSide = kBlockSide;
            return {block(static_cast<int>(x / kSide), static_cast<int>(y / kSide)),
                    static_cast<int>(y % kSide * kSide + x % kSide)};
        }
        const bool down = i >= columns_;
        const int along = down ? j : i;
        return {(down ? down_ : across_)[static_cast<std::size_t>(along / kLanes)], along % kLanes};
    }
    /// The packet of the block in a column and row of blocks, or kEmpty.
    std::uint32_t block(int column, int row) const { return block_at_[index(column, row)]; }
    /// Those of `count` blocks of a row, from a column on.
    std::span<const std::uint32_t> blocks(int column, int row, std::size_t count) const {
        return std::span(block_at_).subspan(index(column, row), count);
    }

  private:
    std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(blocks_across_) +
               static_cast<std::size_t>(column);
    }
    void lay_row(const SampleGrid& grid, const Sampler& sampler, int row, bool whole);
    std::uint32_t lay_strip(const SampleGrid& grid, const Sampler& sampler, const Block& strip);

    int columns_ = 0, rows_ = 0;  ///< of points in blocks; the rest are in strips
    int blocks_across_ = 0;
    std::vector<std::uint32_t> block_at_;       ///< row by row
    std::vector<std::uint32_t> down_, across_;  ///< strips of the last column and row
    std::vector<Block> packets_;
};

}  // namespace ink
