#include "film/film.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <variant>

#include "base/multiversion.h"

namespace ink {

namespace {

/// srgb_encode without branches or pow: 1.055 x^(1/2.4) - 0.055 is a power of the fourth root,
/// 1.055 y^(5/3) - 0.055, fitted by a Chebyshev polynomial over the curve's range. Within 2e-6.
INKTRACE_INLINE float encode(float linear) {
    const float x = std::min(std::max(linear, 0.0F), 1.0F);
    const float y = std::sqrt(std::sqrt(x));
    const float curve =
        -0.0596417498F +
        y * (0.140776781F + y * (1.36022559F + y * (-0.838965334F +
                                                    y * (0.638769462F + y * (-0.306036986F +
                                                                             y * 0.0648733212F)))));
    return x <= 0.0031308F ? 12.92F * x : curve;
}

INKTRACE_INLINE bool is_opaque(const ColorPacket& c) {
    bool opaque = true;
    for (int i = 0; i < kLanes; ++i) opaque &= c.a[i] == 1.0F;
    return opaque;
}

INKTRACE_INLINE void unpremultiply(ColorPacket& c) {
    for (int i = 0; i < kLanes; ++i) {
        const float inverse = c.a[i] > 0.0F ? 1.0F / c.a[i] : 0.0F;
        c.r[i] *= inverse;
        c.g[i] *= inverse;
        c.b[i] *= inverse;
    }
}

INKTRACE_INLINE void premultiply(ColorPacket& c) {
    for (int i = 0; i < kLanes; ++i) {
        c.r[i] *= c.a[i];
        c.g[i] *= c.a[i];
        c.b[i] *= c.a[i];
    }
}

/// Linear to display, premultiplied to premultiplied.
INKTRACE_MULTIVERSION
void encode(ColorPacket& c) {
    const bool opaque = is_opaque(c);
    if (!opaque) unpremultiply(c);
    for (int i = 0; i < kLanes; ++i) c.r[i] = encode(c.r[i]);
    for (int i = 0; i < kLanes; ++i) c.g[i] = encode(c.g[i]);
    for (int i = 0; i < kLanes; ++i) c.b[i] = encode(c.b[i]);
    if (!opaque) premultiply(c);
}

void decode(ColorPacket& c) {
    unpremultiply(c);
    for (Lanes<float>* channel : {&c.r, &c.g, &c.b}) {
        for (float& value : *channel) value = srgb_decode(value);
    }
    premultiply(c);
}

/// The same for colours that come from bytes, by table.
void decode_bytes(ColorPacket& c) {
    static const auto kTable = [] {
        std::array<float, 256> table{};
        for (std::size_t v = 0; v < table.size(); ++v) {
            table[v] = srgb_decode(static_cast<float>(v) / 255.0F);
        }
        return table;
    }();
    unpremultiply(c);
    for (Lanes<float>* channel : {&c.r, &c.g, &c.b}) {
        for (float& value : *channel) {
            value = kTable[static_cast<std::size_t>(std::clamp(value, 0.0F, 1.0F) * 255.0F + 0.5F)];
        }
    }
    premultiply(c);
}

/// To bytes R, G, B, A with straight alpha.
INKTRACE_MULTIVERSION
void pack(ColorPacket& c, Lanes<std::uint32_t>& bytes) {
    if (!is_opaque(c)) unpremultiply(c);
    for (int i = 0; i < kLanes; ++i) {
        const auto quantize = [](float v) {
            return static_cast<std::int32_t>(std::min(std::max(v, 0.0F), 1.0F) * 255.0F + 0.5F);
        };
        bytes[i] = static_cast<std::uint32_t>(quantize(c.r[i]) | quantize(c.g[i]) << 8 |
                                              quantize(c.b[i]) << 16) |
                   static_cast<std::uint32_t>(quantize(c.a[i])) << 24U;
    }
}

INKTRACE_MULTIVERSION
void accumulate(const ColorPacket& shaded, const ColorPacket& blend_space,
                const Lanes<float>& strength, PixelSums& __restrict sums) {
    for (int i = 0; i < kLanes; ++i) {
        sums.shaded.r[i] += shaded.r[i];
        sums.shaded.g[i] += shaded.g[i];
        sums.shaded.b[i] += shaded.b[i];
        sums.shaded.a[i] += shaded.a[i];
        sums.covered.r[i] += strength[i] * blend_space.r[i];
        sums.covered.g[i] += strength[i] * blend_space.g[i];
        sums.covered.b[i] += strength[i] * blend_space.b[i];
        sums.covered.a[i] += strength[i] * blend_space.a[i];
        sums.ink[i] += strength[i];
    }
}

/// The mean shaded colour (in the blend space), less what the ink hides, plus the ink.
INKTRACE_MULTIVERSION
void lay_ink(const PixelSums& sums, Color line, ColorPacket& colors) {
    const float weight = 1.0F / static_cast<float>(sums.samples);
    for (int i = 0; i < kLanes; ++i) {
        const float ink = sums.ink[i] * weight;
        colors.r[i] = std::max(colors.r[i] - sums.covered.r[i] * weight + ink * line.r, 0.0F);
        colors.g[i] = std::max(colors.g[i] - sums.covered.g[i] * weight + ink * line.g, 0.0F);
        colors.b[i] = std::max(colors.b[i] - sums.covered.b[i] * weight + ink * line.b, 0.0F);
        colors.a[i] = std::max(colors.a[i] - sums.covered.a[i] * weight + ink, 0.0F);
    }
}

ColorPacket constant(Color color, float alpha) {
    return {Lanes<float>::filled(color.r * alpha), Lanes<float>::filled(color.g * alpha),
            Lanes<float>::filled(color.b * alpha), Lanes<float>::filled(alpha)};
}

/// Copies the pixels of a block that lie on the film.
template <class T>
void copy_block(Size size, int x, int y, const Lanes<T>& block, T* plane) {
    const auto width = static_cast<std::size_t>(size.width);
    T* row = plane + static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
    const T* from = block.data();
    if (x + kBlockSide <= size.width && y + kBlockSide <= size.height) {
        for (int j = 0; j < kBlockSide; ++j) {
            std::memcpy(row, from, kBlockSide * sizeof(T));
            row += width;
            from += kBlockSide;
        }
        return;
    }
    for (int j = 0; j < std::min(kBlockSide, size.height - y); ++j) {
        std::copy_n(from, std::min(kBlockSide, size.width - x), row);
        row += width;
        from += kBlockSide;
    }
}

}  // namespace

Film::Film(Size size, const FilmSettings& settings) : size_(size), settings_(settings) {
    line_ = in_blend_space(settings.line_color);
    display_.size = size;
    channels_.size = size;
    if (settings.display) display_.pixels.resize(size.pixels());
    if (settings.linear) {
        for (const char* name : {"R", "G", "B", "A"}) add_plane<float>(name);
    }

    ColorPacket background =
        constant(srgb_decode(settings.background), settings.transparent_background ? 0.0F : 1.0F);
    background = paper(background);
    if (settings.blend == BlendSpace::display) encode(background);
    finish(background, background_);
}

Color Film::in_blend_space(Rgb8 color) const {
    if (settings_.blend == BlendSpace::linear) return srgb_decode(color);
    return {static_cast<float>(color.r) / 255.0F, static_cast<float>(color.g) / 255.0F,
            static_cast<float>(color.b) / 255.0F};
}

/// What lies below the lines: the shaded colour, or white paper for lines alone.
ColorPacket Film::paper(const ColorPacket& shaded) const {
    if (settings_.compose != Compose::lines) return shaded;
    return constant({1.0F, 1.0F, 1.0F}, settings_.transparent_background ? 0.0F : 1.0F);
}

void Film::add(const ColorPacket& shaded, const Lanes<float>& strength, PixelSums& sums) const {
    const ColorPacket below = paper(shaded);
    ColorPacket blend_space = below;
    if (settings_.blend == BlendSpace::display) encode(blend_space);
    accumulate(below, blend_space, strength, sums);
    ++sums.samples;
}

void Film::put(int x, int y, const PixelSums& sums) {
    ColorPacket colors = sums.shaded;
    const float weight = 1.0F / static_cast<float>(sums.samples);
    for (Lanes<float>* channel : {&colors.r, &colors.g, &colors.b, &colors.a}) {
        for (float& value : *channel) value *= weight;
    }
    if (settings_.blend == BlendSpace::display) encode(colors);
    lay_ink(sums, line_, colors);
    Block block;
    finish(colors, block);
    store(x, y, block);
}

void Film::put(int x, int y, const ColorPacket& shaded) {
    ColorPacket colors = paper(shaded);
    if (settings_.blend == BlendSpace::display) encode(colors);
    Block block;
    finish(colors, block);
    store(x, y, block);
}

/// From the blend space to what the film keeps.
void Film::finish(ColorPacket& blended, Block& block) const {
    if (settings_.linear) {
        block.linear = blended;
        if (settings_.blend == BlendSpace::display) decode(block.linear);
    }
    if (settings_.display) {
        if (settings_.blend == BlendSpace::linear) encode(blended);
        pack(blended, block.display);
    }
}

void Film::store(int x, int y, const Block& block) {
    if (settings_.linear) {
        put_plane(0, x, y, block.linear.r);
        put_plane(1, x, y, block.linear.g);
        put_plane(2, x, y, block.linear.b);
        put_plane(3, x, y, block.linear.a);
    }
    if (settings_.display) copy_block(size_, x, y, block.display, display_.pixels.data());
}

void Film::put_display(int x, int y, std::span<const std::uint32_t> pixels) {
    const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) +
                              static_cast<std::size_t>(x);
    std::ranges::copy(pixels, display_.pixels.begin() + static_cast<std::ptrdiff_t>(first));
}

void Film::touch_up(int x, int y, int count, const TouchUp& change) {
    count = std::min(count, size_.width - x);
    // Pixels that stay as they are must not go through the blend space and back, which rounds.
    Lanes<std::uint8_t> changed{};
    bool inked = false;
    bool shifted = false;
    for (int i = 0; i < count; ++i) {
        const bool ink = change.ink_alpha != nullptr && change.ink_alpha[i] != 0.0F;
        bool shift = false;
        for (const float* plane : change.shift) shift |= plane != nullptr && plane[i] != 0.0F;
        changed[i] = ink || shift ? 1 : 0;
        inked |= ink;
        shifted |= shift;
    }
    if (!inked && !shifted) return;

    const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) +
                              static_cast<std::size_t>(x);
    ColorPacket colors = load(first, count);
    if (shifted && settings_.compose != Compose::lines) shift_colors(change, count, colors);
    if (inked) {
        for (int i = 0; i < count; ++i) {
            const float alpha = change.ink_alpha[i];
            const auto ink = [&](std::size_t channel, float uniform) {
                return change.ink_color ? alpha * uniform : change.ink_colors[channel][i];
            };
            const Color uniform = change.ink_color.value_or(Color{});
            colors.r[i] = colors.r[i] * (1.0F - alpha) + ink(0, uniform.r);
            colors.g[i] = colors.g[i] * (1.0F - alpha) + ink(1, uniform.g);
            colors.b[i] = colors.b[i] * (1.0F - alpha) + ink(2, uniform.b);
            colors.a[i] = colors.a[i] * (1.0F - alpha) + alpha;
        }
    }

    Block block;
    finish(colors, block);
    const auto copy = [&](const auto& lanes, auto* plane) {
        for (int i = 0; i < count; ++i) {
            if (changed[i] != 0) plane[first + static_cast<std::size_t>(i)] = lanes[i];
        }
    };
    if (settings_.display) copy(block.display, display_.pixels.data());
    if (settings_.linear) {
        std::size_t plane = 0;
        for (const auto* lanes :
             {&block.linear.r, &block.linear.g, &block.linear.b, &block.linear.a}) {
            copy(*lanes, std::get<std::vector<float>>(channels_.channels[plane++].values).data());
        }
    }
}

/// Finished pixels, back in the blend space and premultiplied.
ColorPacket Film::load(std::size_t first, int count) const {
    ColorPacket colors{};
    if (settings_.linear) {
        std::size_t plane = 0;
        for (auto* lanes : {&colors.r, &colors.g, &colors.b, &colors.a}) {
            const auto& values = std::get<std::vector<float>>(channels_.channels[plane++].values);
            std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(first), count, lanes->begin());
        }
        if (settings_.blend == BlendSpace::display) encode(colors);
        return colors;
    }
    for (int i = 0; i < count; ++i) {
        const std::uint32_t pixel = display_.pixels[first + static_cast<std::size_t>(i)];
        const auto channel = [&](unsigned shift) {
            return static_cast<float>((pixel >> shift) & 0xFFU) * (1.0F / 255.0F);
        };
        colors.a[i] = channel(24);
        colors.r[i] = channel(0) * colors.a[i];
        colors.g[i] = channel(8) * colors.a[i];
        colors.b[i] = channel(16) * colors.a[i];
    }
    if (settings_.blend == BlendSpace::linear) decode(colors);
    return colors;
}

void Film::shift_colors(const TouchUp& change, int count, ColorPacket& colors) const {
    ColorPacket linear = colors;
    if (settings_.blend == BlendSpace::display) (settings_.linear ? decode : decode_bytes)(linear);
    std::size_t plane = 0;
    for (auto* lanes : {&linear.r, &linear.g, &linear.b, &linear.a}) {
        const float* shift = change.shift[plane++];
        for (int i = 0; i < count; ++i) {
            (*lanes)[i] = std::clamp((*lanes)[i] + shift[i], 0.0F, plane == 4 ? 1.0F : kInfinity);
        }
    }
    if (settings_.blend == BlendSpace::display) encode(linear);
    for (int i = 0; i < count; ++i) {
        bool shifted = false;
        for (const float* shift : change.shift) shifted |= shift[i] != 0.0F;
        if (!shifted) continue;
        colors.r[i] = linear.r[i];
        colors.g[i] = linear.g[i];
        colors.b[i] = linear.b[i];
        colors.a[i] = linear.a[i];
    }
}

template <class T>
void Film::put_row(std::size_t plane, int x, int y, int count, const T* values) {
    auto& target = std::get<std::vector<T>>(channels_.channels[plane].values);
    const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) +
                              static_cast<std::size_t>(x);
    std::copy_n(values, std::min(count, size_.width - x),
                target.begin() + static_cast<std::ptrdiff_t>(first));
}

template <class T>
std::size_t Film::add_plane(std::string name) {
    channels_.channels.push_back({std::move(name), std::vector<T>(size_.pixels())});
    return channels_.channels.size() - 1;
}

template <class T>
void Film::put_plane(std::size_t plane, int x, int y, const Lanes<T>& values) {
    copy_block(size_, x, y, values,
               std::get<std::vector<T>>(channels_.channels[plane].values).data());
}

template std::size_t Film::add_plane<float>(std::string);
template std::size_t Film::add_plane<std::uint32_t>(std::string);
template void Film::put_plane<float>(std::size_t, int, int, const Lanes<float>&);
template void Film::put_plane<std::uint32_t>(std::size_t, int, int, const Lanes<std::uint32_t>&);
template void Film::put_row<float>(std::size_t, int, int, int, const float*);
template void Film::put_row<std::uint32_t>(std::size_t, int, int, int, const std::uint32_t*);

}  // namespace ink
