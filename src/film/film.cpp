#include "film/film.h"

#include <algorithm>
#include <utility>
#include <variant>

#include <hwy/cache_control.h>

#include "film/opaque_ink.h"
#include "film/plane_blocks.h"
#include "film/srgb_bytes.h"

namespace ink {

namespace {

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
    if (settings_.blend == BlendSpace::display && has_ink(strength)) srgb_encode(blend_space);
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
    if (settings_.blend == BlendSpace::display) srgb_encode(colors);
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
        if (settings_.blend == BlendSpace::display) srgb_decode(block.linear);
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
        if (settings_.blend == BlendSpace::display) srgb_encode(colors);
        return colors;
    }
    unpack(block.display, colors);
    if (settings_.blend == BlendSpace::linear) srgb_decode(colors);
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
