#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/lanes.h"
#include "film/film.h"
#include "lines/segment.h"
#include "render/corner_shares.h"
#include "render/tiles.h"

namespace ink {

/// The pixels along the border of a tile, to which lines of several tiles may add. What lies in the
/// first row, then in the first column below it.
struct Fringe {
    std::vector<PixelColor> colors;  ///< empty: all background
    std::vector<ColorShift> own;     ///< from the tile's own lines, or kLeft; empty: none
    std::vector<ColorShift> right;   ///< for the column after the last; empty: none
    std::vector<ColorShift> below;   ///< for the row after the last and its corner on the right
};

/// Smooths the shading along lines: of a pixel that a line cuts, the part on the other side takes
/// the other side's colour. A lattice point stands for a square of the lattice's spacing; of each
/// quarter of the four squares about a cell that a segment crosses, the area beyond the segment
/// counts.
class EdgeSmoothing {
  public:
    /// For `lattice` points along a pixel's side.
    explicit EdgeSmoothing(int lattice) : q_(lattice) {}

    /// Clears what there is and moves to the segments in the cells of a tile.
    void begin(const Tile& tile);
    /// `left` and `right` are the colours of the segment's two sides.
    void add(const Segment& segment, PixelColor left, PixelColor right) {
        constexpr float kMostChange = 64.0F;
        PixelColor& change = changes_[static_cast<std::size_t>(waiting_)];
        float most = 0.0F;
        // Channel by channel: to load as a vector what was stored in pieces takes a wait. Without a
        // branch, as std::clamp has.
        for (std::size_t c = 0; c < change.size(); ++c) {
            change[c] = std::min(std::max(right[c] - left[c], -kMostChange), kMostChange);
            most = std::max(most, std::abs(change[c]));
        }
        if (most == 0.0F) return;
        ends_.ax[waiting_] = segment.a.x;
        ends_.ay[waiting_] = segment.a.y;
        ends_.bx[waiting_] = segment.b.x;
        ends_.by[waiting_] = segment.b.y;
        if (++waiting_ == kLanes) finish();
    }
    /// Segments wait for others; after the last one has been added, this takes in what is left.
    void finish();

    /// Leaves the pixel of lattice point (i, j) as it is, if it lies in the tile, whatever lines
    /// add to it. To be called after all segments have been added.
    void leave(int i, int j);

    /// Adds what there is to the block with pixel (x, y), which lies in the tile; its pixels on the
    /// tile's fringe are left as they are.
    void apply(int x, int y, ColorPacket& colors) const;
    bool changes_any() const { return any_; }
    bool changes(int x, int y) const { return any_ && touched_[block(x, y)] != 0; }

    /// Copies what there is for the fringe, and beyond it. The colours of its pixels are the
    /// caller's.
    void copy_fringe(Fringe& fringe) const;

  private:
    std::size_t block(int x, int y) const {
        const auto column = static_cast<std::size_t>(x - tile_.x0) / kBlockSide;
        const auto row = static_cast<std::size_t>(y - tile_.y0) / kBlockSide;
        return row * across_ + column;
    }
    /// Of pixel (x, y) of the tile.
    std::size_t pixel(int x, int y) const {
        return static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(x);
    }
    void clear_touched();
    void spread_beyond(int k);
    void touch(int x, int y) {
        touched_[static_cast<std::size_t>(y / kBlockSide) * across_ +
                 static_cast<std::size_t>(x / kBlockSide)] = 1;
    }

    int q_;
    Tile tile_{};
    std::size_t across_ = 0;  ///< blocks, one more than the tile's
    std::size_t stride_ = 0;  ///< pixels of those blocks
    bool any_ = false;
    std::vector<ColorShift> shifts_;     ///< row by row; zero but in blocks that are touched
    std::vector<std::uint8_t> touched_;  ///< of the blocks
    int waiting_ = 0;                    ///< segments
    SegmentEnds ends_{};
    std::array<PixelColor, kLanes> changes_{};  ///< from their left to their right
    CornerShares shares_;
};

/// Finishes the fringe of tile `index` of a raster of tiles, `across` in a row, once all tiles are
/// done: puts the pixels that any line changes on the film again.
void finish_fringe(std::span<const Tile> tiles, const std::vector<const Fringe*>& fringes,
                   std::size_t across, std::size_t index, const PixelColor& background, Film& film);

}  // namespace ink
