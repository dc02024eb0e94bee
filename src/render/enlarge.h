#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/image.h"
#include "base/lanes.h"
#include "base/vec.h"
#include "film/film.h"
#include "render/edges_plan.h"
#include "render/mix_corners.h"
#include "render/tiles.h"

namespace ink {

/// From a small picture to a large one of the same view: about their middles, by one factor.
class Enlargement {
  public:
    /// A small picture with about `share` of the large one's pixels along each side, and as much of
    /// the view as it at least.
    Enlargement(Size large, double share);

    Size small() const { return small_; }
    Size large() const { return large_; }
    float factor() const { return factor_; }
    Vec2f small_middle() const { return middle_of(small_); }
    Vec2f large_middle() const { return middle_of(large_); }

    Vec2f enlarged(Vec2f point) const {
        return large_middle() + (point - small_middle()) * factor_;
    }
    Vec2f shrunk(Vec2f point) const {
        return small_middle() + (point - large_middle()) * (1.0F / factor_);
    }

  private:
    static Vec2f middle_of(Size size) {
        return {0.5F * static_cast<float>(size.width), 0.5F * static_cast<float>(size.height)};
    }

    Size large_, small_;
    float factor_;
};

class FaceTiling;

/// Enlarges finished pixels: mixes them in proportion, but not across lines.
class PixelEnlarger {
  public:
    PixelEnlarger(const Enlargement& enlargement, const DisplayImage& pixels);

    void enlarge_row(int y, Film& film) const;
    /// Mixes anew the pixels in a tile's cells that lines run through, from those pixels only that
    /// lie on the same side. The segments are those of the small picture, the ones of a cell in
    /// sequence; tiles may be done at the same time.
    /// `faces` learns which pixels see another point's surface than that of the nearest one; null
    /// if nobody asks.
    void sharpen(const Tile& tile, std::span<const Segment> lines, Film& film,
                 FaceTiling* faces) const;

  private:
    /// Between which two columns or rows of the small picture those of the large picture lie.
    struct Between {
        Between(int large, int small, float factor);
        std::vector<std::int32_t> first, second;
        std::vector<std::uint32_t> share;  ///< of the second, in 1 / 256
        std::vector<std::uint32_t> twice;  ///< the same in both halves of each number
    };
    CellCorners corners_of(int column, int row) const;
    std::pair<Lanes<float>, Lanes<float>> shrunk_block(int x, int y) const;
    void sharpen_cell(int column, int row, std::span<const Segment> lines, Film& film,
                      FaceTiling* faces) const;

    Enlargement enlargement_;
    const DisplayImage& pixels_;
    Between columns_, rows_;
};

}  // namespace ink
