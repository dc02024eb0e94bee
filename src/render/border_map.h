#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/tracer.h"
#include "base/image.h"
#include "base/lanes.h"
#include "lines/border_code.h"
#include "render/face_band.h"

namespace ink {

/// How far the pixels of a picture are from the borders of the triangles that they see: all that
/// lines between these are drawn from, if each triangle is a face. Filled tile by tile by the pass
/// that finds lines, for the pass that draws them; threads write disjoint blocks of 4 x 4 pixels.
class BorderMap {
  public:
    /// Distances up to `reach`, pixels. `depths`: whether they are kept, too.
    BorderMap(Size size, float reach, bool depths);

    /// What 4 x 4 pixels see, `t` along their rays; blocks beyond the picture are dropped.
    void put(int x, int y, const BorderPacket& borders, const Lanes<float>& t);

    /// Whether any of the 4 x 4 pixels at (x, y) is within reach of a border.
    bool sees(int x, int y) const { return seen_[block(x, y)] != 0; }
    /// What they see, each as a BorderCode; only if any is.
    const Lanes<std::uint32_t>& codes(int x, int y) const { return codes_[block(x, y)]; }
    /// Along their rays; only if they are kept.
    const Lanes<float>& depths(int x, int y) const { return depths_[block(x, y)]; }
    /// Says that a block will be asked for soon.
    void prefetch(int x, int y) const { __builtin_prefetch(&codes_[block(x, y)]); }
    float reach() const { return reach_; }
    /// What the lines along the borders that sixteen blocks side by side see, from pixel (x, y) on,
    /// leave on those that see any, where all lines have one ink: that of others, which `alphas`
    /// hold, where it is more. Returns the blocks that are within reach of a line.
    LaneBits ink(int x, int y, LaneBits seeing, const RowBands& bands,
                 std::span<Lanes<float>> alphas) const;

  private:
    std::size_t block(int x, int y) const {
        return static_cast<std::size_t>(y / kBlockSide) * static_cast<std::size_t>(blocks_across_) +
               static_cast<std::size_t>(x / kBlockSide);
    }

    Size size_;
    float reach_;
    int blocks_across_;
    std::vector<std::uint8_t> seen_;  ///< a block
    Plane<Lanes<std::uint32_t>> codes_;
    Plane<Lanes<float>> depths_;
};

}  // namespace ink
