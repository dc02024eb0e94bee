#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "lines/density_lanes.h"
#include "lines/ink.h"

namespace ink {

/// How much of the picture lines would cover if none overlapped another: their length times their
/// width, over the area, about each place. Where that exceeds what a drawing can bear, lines are
/// drawn thinner, so that they add up to a tone instead of a black blot.
///
/// Lengths are summed in fixed point over squares of a fixed raster, so that sums do not depend on
/// the order of the segments or on how the picture is cut.
class LineDensity {
  public:
    LineDensity() = default;
    /// Over pixels [x0, x1) x [y0, y1), the part of the screen that is searched for lines. `widest`
    /// is the greatest width of a line, pixels: the squares are several times as wide, and no
    /// narrower than `least_side`.
    LineDensity(int x0, int y0, int x1, int y1, float widest, int least_side = kLeastSide);

    /// Squares must be wide enough for a single line, and a bundle of three, to count as sparse.
    static constexpr int kLeastSide = 16;

    void add(const InkStroke& stroke, float width) {
        const Vec2f d = stroke.b - stroke.a;
        add((stroke.a + stroke.b) * 0.5F, std::sqrt(d.x * d.x + d.y * d.y), width);
    }
    /// Lines of that length in all about a place, pixels.
    void add(Vec2f place, float length, float width) {
        add(column_of(place.x), row_of(place.y), amount(length, width));
    }
    /// The same in steps: length times width, in 2^-20 square pixels, and the square of a place.
    using Amount = std::int64_t;
    static Amount amount(float length, float width) {
        return static_cast<Amount>(length * width * kFixedPoint);
    }
    int column_of(float x) const {
        // Lines may end a hair outside of what was searched.
        const auto column = static_cast<int>(std::floor(x / static_cast<float>(side_)));
        return std::clamp(column, i0_, i0_ + across_ - 1);
    }
    int row_of(float y) const {
        const auto row = static_cast<int>(std::floor(y / static_cast<float>(side_)));
        return std::clamp(row, j0_, j0_ + down_ - 1);
    }
    void add(int column, int row, Amount inked) { inked_[square(column, row)] += inked; }
    LineDensity& operator+=(const LineDensity& other);
    /// To be called after the last of them, before `at`.
    void finish();

    /// Covered share about a place, without end: 2 if lines lie side by side twice.
    float at(Vec2f point) const;
    /// The same about many places.
    void at(std::span<const Vec2f> points, std::span<float> shares) const;
    /// An upper bound of it over all places from one to another.
    float most_within(Vec2f lower, Vec2f upper) const;
    /// From now on, places are those of a picture `factor` times as large.
    void enlarge(float factor, Vec2f middle_before, Vec2f middle_after);

  private:
    static constexpr float kFixedPoint = 1 << 20;

    DensityRaster raster() const;
    std::size_t square(int i, int j) const {
        return static_cast<std::size_t>(j - j0_) * static_cast<std::size_t>(across_) +
               static_cast<std::size_t>(i - i0_);
    }
    float area(int i, int j) const;

    int x0_ = 0, y0_ = 0, x1_ = 0, y1_ = 0;
    int side_ = 1;               ///< of a square, pixels
    int i0_ = 0, j0_ = 0;        ///< the first square: one before the picture's
    int across_ = 0, down_ = 0;  ///< squares
    std::vector<Amount> inked_;
    std::vector<DensityRaster::Square> squares_;
    float shrink_ = 1.0F;  ///< from the places of `at`
    Vec2f shift_;          ///< likewise, after shrinking
};

/// By how much to scale the width of lines that would cover `share` of their surroundings so that
/// they cover no more than `most`: 1 as long as there is room, then less, smoothly.
float width_scale(float share, float most);

/// By how much lines get thinner where they are dense, beside what they have lost already for what
/// they are lines of (Segment::width_scale).
struct LineThinning {
    LineDensity all;     ///< of all lines
    LineDensity direct;  ///< of those seen directly: what is seen in a mirror must not thin them
    float most = 1.0F;   ///< share of an area that lines may cover; 1: they are never thinned

    /// What to scale the width of a line of this level by, see Segment.
    float scale_at(Vec2f point, int level) const;
    /// The same about many places, of lines seen directly.
    void scales_at(std::span<const Vec2f> points, std::span<float> scales) const;
};

}  // namespace ink
