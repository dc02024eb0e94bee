#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "base/color.h"
#include "base/image.h"
#include "base/lanes.h"
#include "film/blend.h"
#include "shading/shading.h"

namespace ink {

/// Which of shading and lines reach the picture (the three panels of the paper's Figure 1).
enum class Compose : std::uint8_t {
    shaded,  ///< no lines
    lines,   ///< lines alone, on white
    both
};

/// The values in which a line is mixed with the colour below it.
enum class BlendSpace : std::uint8_t {
    display,  ///< sRGB-encoded, as every 2D program does
    linear
};

struct FilmSettings {
    Compose compose = Compose::both;
    BlendSpace blend = BlendSpace::display;
    Rgb8 line_color{0, 0, 0};
    Rgb8 background{255, 255, 255};
    bool transparent_background = false;
    bool display = true;  ///< make 8-bit sRGB pixels
    bool linear = false;  ///< make linear float pixels
};

/// The picture while it is rendered. Blocks of 4 x 4 pixels are disjoint, so threads need no lock;
/// pixels of a block beyond the film's edge are dropped.
class Film {
  public:
    Film(Size size, const FilmSettings& settings);

    Size size() const { return size_; }

    /// Adds one sample a pixel: its colour and its line strength in [0, 1].
    void add(const ColorPacket& shaded, const Lanes<float>& strength, PixelSums& sums) const;
    /// Finishes the block whose upper left pixel is (x, y): per sample, c = mix(c_s, line colour,
    /// e) (Choudhury and Parker 2009, section 3.2); per pixel, the mean of its samples.
    void put(int x, int y, const PixelSums& sums);
    /// The same for a single sample a pixel without lines.
    void put(int x, int y, const ColorPacket& shaded);
    /// The same where there is nothing but background.
    void put_background(int x, int y) { store(x, y, background_); }
    /// The same for blocks side by side, from the one at (x, y) on; null where there is nothing but
    /// background. Faster than one by one, as it fills whole cache lines; but only after
    /// finish_rows() do other threads see them.
    void put_row(int x, int y, std::span<const ColorPacket* const> shaded);
    static void finish_rows();

    /// A row of the display image, which must have been asked for, to be filled with finished
    /// pixels.
    std::span<std::uint32_t> display_row(int y) {
        const auto width = static_cast<std::size_t>(size_.width);
        return std::span(display_.pixels).subspan(static_cast<std::size_t>(y) * width, width);
    }
    /// Finishes a single pixel.
    void put_pixel(int x, int y, const std::array<float, 4>& shaded);

    /// Lays ink over the finished block at (x, y).
    void lay_ink(int x, int y, const BlockInk& ink);

    /// The lines' colour in the blend space, and any other.
    Color line_color() const { return line_; }
    Color in_blend_space(Rgb8 color) const;

    /// Adds a plane of zeros for data beside the colour; returns its index.
    template <class T>
    std::size_t add_plane(std::string name);
    /// Writes a block of a plane.
    template <class T>
    void put_plane(std::size_t plane, int x, int y, const Lanes<T>& values);

    /// Writes `count` values of a row of a plane, as far as they lie on the film.
    template <class T>
    void put_values(std::size_t plane, int x, int y, int count, const T* values);

    const DisplayImage& display() const { return display_; }    ///< empty unless asked for
    const ChannelImage& channels() const { return channels_; }  ///< R G B A if linear, then planes

  private:
    /// A finished block.
    struct Block {
        ColorPacket linear;            ///< if linear pixels are wanted
        Lanes<std::uint32_t> display;  ///< if display pixels are
    };

    /// Whether pixels are bytes and nothing else, and lines are mixed with them as they are.
    bool plain_bytes() const {
        return settings_.display && !settings_.linear && settings_.blend == BlendSpace::display;
    }
    /// Whether pixels are linear numbers and nothing else, and lines likewise.
    bool plain_linear() const {
        return settings_.linear && !settings_.display && settings_.blend == BlendSpace::linear;
    }
    float* linear_plane(std::size_t k) {
        return std::get<Plane<float>>(channels_.channels[k].values).data();
    }
    void lay_linear_ink(int x, int y, const BlockInk& ink);
    void finish(ColorPacket& blended, Block& block) const;
    void finish_shaded(const ColorPacket& shaded, Block& block) const;
    void load(int x, int y, Block& block) const;
    ColorPacket in_blend_space(const Block& block) const;
    void store(int x, int y, const Block& block);

    Size size_;
    FilmSettings settings_;
    Color line_;         ///< in the blend space
    ColorPacket paper_;  ///< below lines alone, instead of what is shaded
    DisplayImage display_;
    ChannelImage channels_;
    Block background_{};
};

}  // namespace ink
