#include "film/blend.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/multiversion.h"

namespace ink {

namespace {

/// srgb_encode without branches or pow: 1.055 x^(1/2.4) - 0.055 is a power of the fourth root,
/// 1.055 y^(5/3) - 0.055, fitted by a Chebyshev polynomial over the curve's range. Within 2e-6.
INKTRACE_INLINE float encoded(float linear) {
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

INKTRACE_INLINE std::int32_t quantize(float v) {
    return static_cast<std::int32_t>(std::min(std::max(v, 0.0F), 1.0F) * 255.0F + 0.5F);
}

INKTRACE_INLINE std::uint32_t packed(const ColorPacket& straight, int i) {
    return static_cast<std::uint32_t>(quantize(straight.r[i]) | quantize(straight.g[i]) << 8 |
                                      quantize(straight.b[i]) << 16) |
           static_cast<std::uint32_t>(quantize(straight.a[i])) << 24U;
}

INKTRACE_INLINE void unpack_lanes(const Lanes<std::uint32_t>& bytes, ColorPacket& c) {
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

}  // namespace

INKTRACE_MULTIVERSION
void srgb_encode(ColorPacket& c) {
    const bool opaque = is_opaque(c);
    if (!opaque) unpremultiply(c);
    for (int i = 0; i < kLanes; ++i) c.r[i] = encoded(c.r[i]);
    for (int i = 0; i < kLanes; ++i) c.g[i] = encoded(c.g[i]);
    for (int i = 0; i < kLanes; ++i) c.b[i] = encoded(c.b[i]);
    if (!opaque) premultiply(c);
}

void srgb_decode(ColorPacket& c) {
    unpremultiply(c);
    for (Lanes<float>* channel : {&c.r, &c.g, &c.b}) {
        for (float& value : *channel) value = srgb_decode(value);
    }
    premultiply(c);
}

INKTRACE_MULTIVERSION
void pack(ColorPacket& c, Lanes<std::uint32_t>& bytes) {
    if (!is_opaque(c)) unpremultiply(c);
    for (int i = 0; i < kLanes; ++i) bytes[i] = packed(c, i);
}

void unpack(const Lanes<std::uint32_t>& bytes, ColorPacket& c) { unpack_lanes(bytes, c); }

INKTRACE_MULTIVERSION
void lay_ink(const BlockInk& ink, ColorPacket& colors) {
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

INKTRACE_MULTIVERSION
void lay_ink(const BlockInk& ink, Lanes<std::uint32_t>& bytes) {
    ColorPacket c;
    unpack_lanes(bytes, c);
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
        bytes[i] = ink.alpha[i] != 0.0F ? packed(c, i) : bytes[i];
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

}  // namespace ink
