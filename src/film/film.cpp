#include "film/film.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <variant>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "base/multiversion.h"
#include "film/opaque_ink.h"
#include "film/srgb_bytes.h"

namespace ink {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Four lanes are what every processor has.
template <class T>
constexpr hn::FixedTag<T, kBlockSide> kRow;

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
    std::int32_t clear = 0;
    for (int i = 0; i < kLanes; ++i) clear |= c.a[i] != 1.0F ? 1 : 0;
    return clear == 0;
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

/// Bytes with straight alpha, premultiplied.
INKTRACE_INLINE void unpack(const Lanes<std::uint32_t>& bytes, ColorPacket& c) {
    constexpr float kScale = 1.0F / 255.0F;
    const auto channel = [](std::uint32_t pixel, unsigned shift) {
        return static_cast<float>(static_cast<std::int32_t>((pixel >> shift) & 0xFFU)) * kScale;
    };
    for (int i = 0; i < kLanes; ++i) c.a[i] = channel(bytes[i], 24);
    for (int i = 0; i < kLanes; ++i) c.r[i] = channel(bytes[i], 0) * c.a[i];
    for (int i = 0; i < kLanes; ++i) c.g[i] = channel(bytes[i], 8) * c.a[i];
    for (int i = 0; i < kLanes; ++i) c.b[i] = channel(bytes[i], 16) * c.a[i];
}

/// `ink` is the colour times alpha.
INKTRACE_INLINE void lay_over(const Lanes<float>& alpha, const Lanes<float>& ink,
                              Lanes<float>& channel) {
    for (int i = 0; i < kLanes; ++i) channel[i] = channel[i] * (1.0F - alpha[i]) + ink[i];
}

INKTRACE_MULTIVERSION
void lay_ink(const Film::BlockInk& ink, ColorPacket& colors) {
    std::size_t channel = 0;
    Lanes<float> own;
    for (auto* lanes : {&colors.r, &colors.g, &colors.b}) {
        if (ink.color) {
            const std::array<float, 3> color{ink.color->r, ink.color->g, ink.color->b};
            for (int i = 0; i < kLanes; ++i) own[i] = ink.alpha[i] * color[channel];
        } else {
            std::copy_n(ink.colors[channel], kLanes, own.data());
        }
        lay_over(ink.alpha, own, *lanes);
        ++channel;
    }
    lay_over(ink.alpha, ink.alpha, colors.a);
}

/// Keeps what is below where there is no ink: through colours and back it might be rounded.
INKTRACE_MULTIVERSION
void lay_ink(const Film::BlockInk& ink, Lanes<std::uint32_t>& bytes) {
    ColorPacket c;
    unpack(bytes, c);
    const Color color = ink.color.value_or(Color{});
    if (ink.color) {
        for (int i = 0; i < kLanes; ++i) {
            const float alpha = ink.alpha[i];
            c.r[i] = c.r[i] * (1.0F - alpha) + alpha * color.r;
            c.g[i] = c.g[i] * (1.0F - alpha) + alpha * color.g;
            c.b[i] = c.b[i] * (1.0F - alpha) + alpha * color.b;
        }
    } else {
        for (int i = 0; i < kLanes; ++i) {
            const float clear = 1.0F - ink.alpha[i];
            c.r[i] = c.r[i] * clear + ink.colors[0][i];
            c.g[i] = c.g[i] * clear + ink.colors[1][i];
            c.b[i] = c.b[i] * clear + ink.colors[2][i];
        }
    }
    lay_over(ink.alpha, ink.alpha, c.a);
    unpremultiply(c);
    for (int i = 0; i < kLanes; ++i) {
        const auto quantize = [](float v) {
            return static_cast<std::int32_t>(std::min(std::max(v, 0.0F), 1.0F) * 255.0F + 0.5F);
        };
        const auto mixed = static_cast<std::uint32_t>(quantize(c.r[i]) | quantize(c.g[i]) << 8 |
                                                      quantize(c.b[i]) << 16) |
                           static_cast<std::uint32_t>(quantize(c.a[i])) << 24U;
        bytes[i] = ink.alpha[i] != 0.0F ? mixed : bytes[i];
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
void lay_mean_ink(const PixelSums& sums, Color line, ColorPacket& colors) {
    const float weight = 1.0F / static_cast<float>(sums.samples);
    for (int i = 0; i < kLanes; ++i) {
        const float ink = sums.ink[i] * weight;
        colors.r[i] = std::max(colors.r[i] - sums.covered.r[i] * weight + ink * line.r, 0.0F);
        colors.g[i] = std::max(colors.g[i] - sums.covered.g[i] * weight + ink * line.g, 0.0F);
        colors.b[i] = std::max(colors.b[i] - sums.covered.b[i] * weight + ink * line.b, 0.0F);
        colors.a[i] = std::max(colors.a[i] - sums.covered.a[i] * weight + ink, 0.0F);
    }
}

bool has_ink(const Lanes<float>& strength) {
    float most = 0.0F;
    for (int i = 0; i < kLanes; ++i) most = std::max(most, strength[i]);
    return most > 0.0F;
}

ColorPacket constant(Color color, float alpha) {
    return {Lanes<float>::filled(color.r * alpha), Lanes<float>::filled(color.g * alpha),
            Lanes<float>::filled(color.b * alpha), Lanes<float>::filled(alpha)};
}

constexpr std::array kChannels{&ColorPacket::r, &ColorPacket::g, &ColorPacket::b, &ColorPacket::a};

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

/// lay_over on a plane: where there is no ink, x * 1 + 0 is x.
INKTRACE_INLINE void lay_on_plane(Size size, int x, int y, const Lanes<float>& alpha,
                                  const Lanes<float>& ink, float* plane) {
    const auto width = static_cast<std::size_t>(size.width);
    float* row = plane + static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
    const int columns = std::min(kBlockSide, size.width - x);
    const int rows = std::min(kBlockSide, size.height - y);
    const auto lay = [&](int j, int i) {
        const int lane = j * kBlockSide + i;
        row[i] = row[i] * (1.0F - alpha[lane]) + ink[lane];
    };
    for (int j = 0; j < rows; ++j, row += width) {
        if (columns == kBlockSide) {
            for (int i = 0; i < kBlockSide; ++i) lay(j, i);
        } else {
            for (int i = 0; i < columns; ++i) lay(j, i);
        }
    }
}

/// copy_block of blocks side by side, row after row. Whole cache lines go to memory past the
/// caches, which otherwise read what is then overwritten; whoever is to see them waits for
/// finish_rows().
template <class T>
void copy_blocks(Size size, int x, int y, std::span<const Lanes<T>* const> blocks, T* plane) {
    const auto width = static_cast<std::size_t>(size.width);
    T* row = plane + static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
    const auto whole =
        std::min(blocks.size(), static_cast<std::size_t>((size.width - x) / kBlockSide));
    constexpr std::size_t kLine = 64 / (kBlockSide * sizeof(T));  // blocks to a cache line
    constexpr std::size_t kLarge = std::size_t{1} << 20;  // a picture of less may stay in a cache
    const bool large = size.pixels() * sizeof(T) >= kLarge;
    for (int j = 0; j < std::min(kBlockSide, size.height - y); ++j, row += width) {
        const auto values = [&](std::size_t k) {
            return hn::Load(kRow<T>, blocks[k]->data() + j * kBlockSide);
        };
        for (std::size_t k = 0; k < whole;) {
            T* const to = row + k * kBlockSide;
            if (large && reinterpret_cast<std::uintptr_t>(to) % 64 == 0 && k + kLine <= whole) {
                for (std::size_t n = 0; n < kLine; ++n) {
                    hn::Stream(values(k + n), kRow<T>, to + n * kBlockSide);
                }
                k += kLine;
            } else {
                hn::StoreU(values(k++), kRow<T>, to);
            }
        }
    }
    if (whole == blocks.size()) return;
    copy_block(size, x + static_cast<int>(whole) * kBlockSide, y, *blocks[whole], plane);
}

/// The other way; pixels beyond the film's edge are left as they are.
template <class T>
void load_block(Size size, int x, int y, const T* plane, Lanes<T>& block) {
    const auto width = static_cast<std::size_t>(size.width);
    const T* row = plane + static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
    T* to = block.data();
    const bool whole = x + kBlockSide <= size.width;
    for (int j = 0; j < std::min(kBlockSide, size.height - y); ++j) {
        if (whole) {
            std::memcpy(to, row, kBlockSide * sizeof(T));
        } else {
            std::copy_n(row, size.width - x, to);
        }
        row += width;
        to += kBlockSide;
    }
}

}  // namespace

Film::Film(Size size, const FilmSettings& settings) : size_(size), settings_(settings) {
    line_ = in_blend_space(settings.line_color);
    paper_ = constant({1.0F, 1.0F, 1.0F}, settings.transparent_background ? 0.0F : 1.0F);
    display_.size = size;
    channels_.size = size;
    if (settings.display) display_.pixels.resize(size.pixels());
    if (settings.linear) {
        for (const char* name : {"R", "G", "B", "A"}) {
            channels_.channels.push_back({name, Plane<float>(size.pixels())});
        }
    }

    const ColorPacket background =
        constant(srgb_decode(settings.background), settings.transparent_background ? 0.0F : 1.0F);
    finish_shaded(background, background_);
}

Color Film::in_blend_space(Rgb8 color) const {
    if (settings_.blend == BlendSpace::linear) return srgb_decode(color);
    return {static_cast<float>(color.r) / 255.0F, static_cast<float>(color.g) / 255.0F,
            static_cast<float>(color.b) / 255.0F};
}

void Film::add(const ColorPacket& shaded, const Lanes<float>& strength, PixelSums& sums) const {
    const ColorPacket& below = settings_.compose == Compose::lines ? paper_ : shaded;
    ColorPacket blend_space = below;
    // What no line covers needs no blending.
    if (settings_.blend == BlendSpace::display && has_ink(strength)) encode(blend_space);
    accumulate(below, blend_space, strength, sums);
    ++sums.samples;
}

void Film::put(int x, int y, const PixelSums& sums) {
    ColorPacket colors = sums.shaded;
    const float weight = 1.0F / static_cast<float>(sums.samples);
    for (Lanes<float>* channel : {&colors.r, &colors.g, &colors.b, &colors.a}) {
        for (float& value : *channel) value *= weight;
    }
    if (!has_ink(sums.ink)) return put(x, y, colors);
    if (settings_.blend == BlendSpace::display) encode(colors);
    lay_mean_ink(sums, line_, colors);
    Block block;
    finish(colors, block);
    store(x, y, block);
}

void Film::put(int x, int y, const ColorPacket& shaded) {
    Block block;
    finish_shaded(shaded, block);
    store(x, y, block);
}

void Film::finish_rows() { hwy::FlushStream(); }

void Film::put_row(int x, int y, std::span<const ColorPacket* const> shaded) {
    constexpr std::size_t kMost = 16;  // so many stay in the nearest cache
    for (; !shaded.empty(); x += static_cast<int>(kMost) * kBlockSide) {
        const std::size_t count = std::min(kMost, shaded.size());
        std::array<const ColorPacket*, kMost> paper;
        paper.fill(&paper_);
        const bool covered = settings_.compose == Compose::lines;
        const ColorPacket* const* const colors = covered ? paper.data() : shaded.data();
        if (settings_.linear) {
            std::array<const Lanes<float>*, kMost> blocks;
            for (std::size_t c = 0; c < kChannels.size(); ++c) {
                for (std::size_t k = 0; k < count; ++k) {
                    const ColorPacket& own = colors[k] == nullptr ? background_.linear : *colors[k];
                    blocks[k] = &(own.*kChannels[c]);
                }
                copy_blocks<float>(size_, x, y, std::span(blocks).first(count), linear_plane(c));
            }
        }
        if (settings_.display) {
            std::array<Lanes<std::uint32_t>, kMost> bytes;
            std::array<const Lanes<std::uint32_t>*, kMost> blocks;
            encode_bytes(colors, std::span(bytes).first(count));
            for (std::size_t k = 0; k < count; ++k) {
                blocks[k] = colors[k] == nullptr ? &background_.display : &bytes[k];
            }
            copy_blocks<std::uint32_t>(size_, x, y, std::span(blocks).first(count),
                                       display_.pixels.data());
        }
        shaded = shaded.subspan(count);
    }
}

/// Where there are no lines, nothing needs to go through the blend space.
void Film::finish_shaded(const ColorPacket& shaded, Block& block) const {
    const bool covered = settings_.compose == Compose::lines;
    const ColorPacket& colors = covered ? paper_ : shaded;
    if (settings_.linear) block.linear = colors;
    if (settings_.display) encode_bytes(colors, block.display);
}

/// From the blend space to what the film keeps.
void Film::finish(ColorPacket& blended, Block& block) const {
    if (settings_.linear) {
        block.linear = blended;
        if (settings_.blend == BlendSpace::display) decode(block.linear);
    }
    if (!settings_.display) return;
    if (settings_.blend == BlendSpace::linear) {
        encode_bytes(blended, block.display);
    } else {
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

void Film::put_pixel(int x, int y, const std::array<float, 4>& shaded) {
    ColorPacket one{};
    one.r[0] = shaded[0];
    one.g[0] = shaded[1];
    one.b[0] = shaded[2];
    one.a[0] = shaded[3];
    Block finished;
    finish_shaded(one, finished);
    const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) +
                           static_cast<std::size_t>(x);
    if (settings_.display) display_.pixels[at] = finished.display[0];
    if (!settings_.linear) return;
    linear_plane(0)[at] = finished.linear.r[0];
    linear_plane(1)[at] = finished.linear.g[0];
    linear_plane(2)[at] = finished.linear.b[0];
    linear_plane(3)[at] = finished.linear.a[0];
}

void Film::lay_ink(int x, int y, const BlockInk& ink) {
    Block below;
    if (plain_bytes()) {
        const bool whole = x + kBlockSide <= size_.width && y + kBlockSide <= size_.height;
        // What lay_ink gives, as alpha stays 1 to the last bit.
        if (whole && ink.color &&
            lay_on_opaque(ink.alpha, *ink.color, display_row(y).data() + x,
                          display_row(y).size())) {
            return;
        }
        below.display.fill(0);
        load_block(size_, x, y, display_.pixels.data(), below.display);
        ink::lay_ink(ink, below.display);
        return copy_block(size_, x, y, below.display, display_.pixels.data());
    }
    if (plain_linear()) return lay_linear_ink(x, y, ink);
    below = {};
    load(x, y, below);
    ColorPacket colors = in_blend_space(below);
    ink::lay_ink(ink, colors);
    Block block;
    finish(colors, block);
    // Pixels that stay as they are must not go through the blend space and back, which rounds.
    for (int i = 0; i < kLanes; ++i) {
        if (ink.alpha[i] != 0.0F) continue;
        block.display[i] = below.display[i];
        block.linear.r[i] = below.linear.r[i];
        block.linear.g[i] = below.linear.g[i];
        block.linear.b[i] = below.linear.b[i];
        block.linear.a[i] = below.linear.a[i];
    }
    store(x, y, block);
}

void Film::lay_linear_ink(int x, int y, const BlockInk& ink) {
    const auto lay = [&](std::size_t plane, const Lanes<float>& own) {
        lay_on_plane(size_, x, y, ink.alpha, own, linear_plane(plane));
    };
    const std::array<float, 3> color =
        ink.color ? std::array{ink.color->r, ink.color->g, ink.color->b} : std::array<float, 3>{};
    for (std::size_t c = 0; c < color.size(); ++c) {
        Lanes<float> own;
        if (ink.color) {
            for (int i = 0; i < kLanes; ++i) own[i] = ink.alpha[i] * color[c];
        } else {
            std::copy_n(ink.colors[c], kLanes, own.data());
        }
        lay(c, own);
    }
    lay(color.size(), ink.alpha);
}

void Film::load(int x, int y, Block& block) const {
    if (settings_.display) load_block(size_, x, y, display_.pixels.data(), block.display);
    if (!settings_.linear) return;
    std::size_t plane = 0;
    for (auto* lanes : {&block.linear.r, &block.linear.g, &block.linear.b, &block.linear.a}) {
        const auto& values = std::get<Plane<float>>(channels_.channels[plane++].values);
        load_block(size_, x, y, values.data(), *lanes);
    }
}

/// Finished pixels, premultiplied.
ColorPacket Film::in_blend_space(const Block& block) const {
    ColorPacket colors{};
    if (settings_.linear) {
        colors = block.linear;
        if (settings_.blend == BlendSpace::display) encode(colors);
        return colors;
    }
    unpack(block.display, colors);
    if (settings_.blend == BlendSpace::linear) decode(colors);
    return colors;
}

template <class T>
void Film::put_values(std::size_t plane, int x, int y, int count, const T* values) {
    auto& target = std::get<Plane<T>>(channels_.channels[plane].values);
    const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) +
                              static_cast<std::size_t>(x);
    std::copy_n(values, std::min(count, size_.width - x),
                target.begin() + static_cast<std::ptrdiff_t>(first));
}

template <class T>
std::size_t Film::add_plane(std::string name) {
    channels_.channels.push_back({std::move(name), Plane<T>(size_.pixels(), T{})});
    return channels_.channels.size() - 1;
}

template <class T>
void Film::put_plane(std::size_t plane, int x, int y, const Lanes<T>& values) {
    copy_block(size_, x, y, values, std::get<Plane<T>>(channels_.channels[plane].values).data());
}

template std::size_t Film::add_plane<float>(std::string);
template std::size_t Film::add_plane<std::uint32_t>(std::string);
template void Film::put_plane<float>(std::size_t, int, int, const Lanes<float>&);
template void Film::put_plane<std::uint32_t>(std::size_t, int, int, const Lanes<std::uint32_t>&);
template void Film::put_values<float>(std::size_t, int, int, int, const float*);
template void Film::put_values<std::uint32_t>(std::size_t, int, int, int, const std::uint32_t*);

}  // namespace ink
