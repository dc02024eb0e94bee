#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/color.h"
#include "base/lanes.h"
#include "lines/ink_kernels.h"
#include "lines/line_type.h"
#include "lines/segment.h"
#include "lines/strength.h"

namespace ink {

/// The lines between a mesh's faces run up to its outline, and in front of it where the surface
/// turns away. Taking them to lie this much farther behind, in a scene of size 1, keeps them below
/// the outline, and above what is well behind.
inline constexpr float kMeshBehind = 0.1F;

/// How lines of one type are drawn.
struct LineStyle {
    float width_px = 2.0F;
    Color color;  ///< in the space in which lines are mixed with the picture
    float opacity = 1.0F;
};

struct InkSettings {
    std::vector<LineStyle> styles;  ///< those of the line types come first
    /// Across the line. Solid is the exact area of each pixel under the line's band; linear and
    /// power are the paper's soft profiles, functions of the distance to the line alone.
    Metric profile{Metric::Kind::solid};

    float widest() const;  ///< pixels
    /// Whether it matters which of two lines lies on top.
    bool has_several_inks() const;
    /// From a line's middle to the farthest pixel centre that it inks.
    float reach() const;
};

/// A piece of a line as it is drawn: what InkTile needs of a segment.
struct InkStroke {
    Vec2f a, b;  ///< ends, pixels
    float strength = 1.0F;
    float t = 0.0F;           ///< as in Segment, for what lies on top
    std::uint32_t style = 0;  ///< among those of InkSettings
    bool direct = true;       ///< not seen in a mirror or through glass
    bool left_in_front = true;
    float width_scale = 1.0F;  ///< as in Segment, as is the gap
    float gap = 0.0F;
};
inline InkStroke make_ink_stroke(const Segment& segment, std::size_t style) {
    return {segment.a,
            segment.b,
            segment.strength,
            segment.t + (segment.type == LineType::mesh ? kMeshBehind : 0.0F),
            static_cast<std::uint32_t>(style),
            segment.level == 0,
            segment.left_in_front,
            segment.width_scale,
            segment.gap};
}

/// The line between faces that is nearest to each pixel of a block.
struct NearestLines {
    Lanes<float> distance;  ///< from the pixel's centre, pixels; infinite where there is none
    Lanes<float> nx, ny;    ///< unit, across the line
    Lanes<float> t;         ///< of the line's middle, distance along the ray
};

/// Ink on a rectangle of pixels, before it is mixed with the picture. Its planes go by blocks of
/// 4 x 4 pixels, from the rectangle's upper left corner on, row by row.
class InkTile {
  public:
    explicit InkTile(const InkSettings& settings);

    /// Clears the tile and moves it to pixels [x0, x0 + width) x [y0, y0 + height).
    void begin(int x0, int y0, int width, int height);
    /// Adds a stroke, its width times `width_scale`; what lies beyond the tile is left out. Strokes
    /// may wait for others until finish().
    void draw(const InkStroke& stroke, float width_scale = 1.0F);
    /// Adds a segment in the style of its type.
    void draw(const Segment& segment) {
        draw(make_ink_stroke(segment, static_cast<std::size_t>(segment.type)));
    }
    /// Inks the block with pixel (x, y) of the tile with lines between faces, `width` pixels wide;
    /// `strength` is the share of ink that each has, in [0, 1].
    void draw_faces(int x, int y, const NearestLines& lines, const Lanes<float>& strength,
                    std::size_t style, float width);
    /// The same where each pixel sees a face that is one triangle, and there are several inks:
    /// `codes` are BorderCodes of distances up to `reach`, `depths` those of the pixels.
    void draw_borders(int x, int y, const Lanes<std::uint32_t>& codes, float reach,
                      const Lanes<float>& depths, std::size_t style, float width);
    /// Lays the inks over each other, the nearer line on top at each pixel.
    void finish();

    bool empty() const { return empty_; }
    /// Whether block k may have ink.
    bool touched(std::size_t k) const { return touched_[k] != 0; }
    std::size_t blocks() const { return touched_.size(); }
    std::size_t blocks_across() const { return across_; }
    /// Planes over the tile's pixels: ink's alpha, and its colour times alpha where there is no
    /// uniform one.
    const float* alpha() const { return alpha_.front().data(); }
    const Lanes<float>& alpha_of_block(std::size_t k) const { return alpha_[k]; }
    const std::array<std::vector<float>, 3>& color() const { return color_; }
    std::optional<Color> uniform_color() const { return uniform_; }
    /// Where pixel (x, y) of the tile is in a plane.
    std::size_t index(int x, int y) const {
        const auto column = static_cast<std::size_t>(x);
        const auto row = static_cast<std::size_t>(y);
        return (row / kBlockSide * across_ + column / kBlockSide) * kLanes +
               row % kBlockSide * kBlockSide + column % kBlockSide;
    }

  private:
    /// One ink, that is, colour and opacity. A pixel's coverage is that of the line nearest to it:
    /// the union of the bands, round at joins and ends.
    struct Layer {
        Color color;
        float opacity = 1.0F;
        bool used = false;
        std::vector<Lanes<float>> coverage;
        std::vector<Lanes<float>> t;  ///< of the nearest line that inks the pixel, if it matters
        std::vector<float> narrow, narrow_t;  ///< see InkPlanes
        std::vector<Lanes<float>> squared;    ///< likewise
        InkPlanes planes{};                   ///< these, for strokes
    };

    Layer& layer_of(std::size_t style) {
        Layer& layer = layers_[layer_of_style_[style]];
        if (!layer.used) start(layer);
        return layer;
    }
    void start(Layer& layer);
    void draw_waiting();
    void finish_alone(const Layer& layer);
    void finish_pixel(std::size_t k, std::span<const Layer* const> used);

    InkSettings settings_;
    std::vector<float> profile_;  ///< of soft lines, as draw_soft() wants it; empty if solid
    std::vector<std::size_t> layer_of_style_;
    std::vector<Layer> layers_;
    InkBatch waiting_{};  ///< strokes
    std::vector<const Layer*> used_;
    std::vector<const Layer*> here_;  ///< the layers that ink a pixel, the nearest first
    std::vector<Lanes<float>> alpha_;
    std::array<std::vector<float>, 3> color_;
    std::optional<Color> uniform_;
    std::vector<std::uint8_t> touched_;
    int x0_ = 0, y0_ = 0, width_ = 0, height_ = 0;
    std::size_t across_ = 0;  ///< blocks
    bool empty_ = true;
};

}  // namespace ink
