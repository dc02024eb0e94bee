#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/color.h"
#include "base/lanes.h"
#include "lines/line_type.h"
#include "lines/segment.h"
#include "lines/strength.h"

namespace ink {

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
    /// From a line's middle to the farthest pixel centre that it inks.
    float reach() const;
};

/// Ink on a rectangle of pixels, before it is mixed with the picture.
class InkTile {
  public:
    explicit InkTile(const InkSettings& settings);

    /// Clears the tile and moves it to pixels [x0, x0 + width) x [y0, y0 + height).
    void begin(int x0, int y0, int width, int height);
    /// Adds a segment in one of the settings' styles, its width times `width_scale`; what lies
    /// beyond the tile is left out.
    void draw(const Segment& segment, std::size_t style, float width_scale = 1.0F);
    /// The same in the style of its type.
    void draw(const Segment& segment) { draw(segment, static_cast<std::size_t>(segment.type)); }
    /// Inks 4 x 4 pixels, from pixel (x, y) of the tile on, with lines between faces: what each
    /// gets from the middle of a line at `distance` from its centre, pixels, infinite for none;
    /// (nx, ny) is the unit normal of the line.
    void draw_faces(int x, int y, const Lanes<float>& distance, const Lanes<float>& nx,
                    const Lanes<float>& ny, const Lanes<float>& t, std::size_t style, float width);
    /// Lays the inks over each other, the nearer line on top at each pixel.
    void finish();

    bool empty() const { return empty_; }
    /// Planes over the tile's pixels, row by row: ink's alpha, and its colour times alpha where
    /// there is no uniform one.
    const float* alpha() const { return alpha_.data(); }
    const std::array<std::vector<float>, 3>& color() const { return color_; }
    std::optional<Color> uniform_color() const { return uniform_; }
    /// Floats in a plane, and where pixel (x, y) of the tile is in it.
    std::size_t plane_size() const { return index(0, height_); }
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(stride_) +
               static_cast<std::size_t>(x);
    }

    /// Marks a pixel as changed; returns its index. Marks are kept by runs of kLanes pixels.
    std::size_t touch(int x, int y) {
        touched_[run_of(x, y)] = 1;
        return index(x, y);
    }
    bool touched(int x, int y) const { return touched_[run_of(x, y)] != 0; }

  private:
    /// One ink, that is, colour and opacity. A pixel's coverage is that of the line nearest to it:
    /// the union of the bands, round at joins and ends.
    struct Layer {
        Color color;
        float opacity = 1.0F;
        bool used = false;
        std::vector<float> coverage;
        std::vector<float> t;  ///< of the nearest line that inks the pixel
    };

    Layer& layer_of(std::size_t style);
    std::size_t run_of(int x, int y) const { return index(x, y) / kLanes; }
    void finish_alone(const Layer& layer);
    void finish_pixel(std::size_t k, std::span<const Layer* const> used);

    InkSettings settings_;
    std::vector<float> profile_;  ///< strength by distance over half width, if soft
    std::vector<std::size_t> layer_of_style_;
    std::vector<Layer> layers_;
    std::vector<const Layer*> here_;  ///< the layers that ink a pixel, the nearest first
    std::vector<float> alpha_;
    std::array<std::vector<float>, 3> color_;
    std::optional<Color> uniform_;
    std::vector<std::uint8_t> touched_;
    int x0_ = 0, y0_ = 0, width_ = 0, height_ = 0, stride_ = 0;
    bool empty_ = true;
};

}  // namespace ink
