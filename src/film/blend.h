#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "base/color.h"
#include "base/lanes.h"
#include "shading/lighting.h"

namespace ink {

/// Samples of sixteen pixels on their way to the film. Sums over samples, so that their mean can be
/// taken in linear light while lines are mixed in the blend space.
struct PixelSums {
    ColorPacket shaded{};   ///< linear, premultiplied
    ColorPacket covered{};  ///< what ink hides: strength times colour in the blend space
    Lanes<float> ink{};     ///< line strength
    int samples = 0;
};

/// What covers a block of pixels.
struct BlockInk {
    const Lanes<float>& alpha;
    std::optional<Color> color;          ///< one for all pixels, blend space; or else
    std::array<const float*, 3> colors;  ///< one each, times alpha
};

// Colours are premultiplied; bytes are R, G, B, A with straight alpha.

/// From linear light to what a display is sent, within 2e-6, and back.
void srgb_encode(ColorPacket& colors);
void srgb_decode(ColorPacket& colors);

/// To the nearest bytes, and back. `pack` leaves colours that are not premultiplied.
void pack(ColorPacket& colors, Lanes<std::uint32_t>& bytes);
void unpack(const Lanes<std::uint32_t>& bytes, ColorPacket& colors);

/// Lays ink over pixels in the blend space, or over bytes. Bytes without ink stay as they are:
/// through colours and back they might be rounded.
void lay_ink(const BlockInk& ink, ColorPacket& colors);
void lay_ink(const BlockInk& ink, Lanes<std::uint32_t>& bytes);

/// Adds a sample, whose colour is given as linear light and in the blend space.
void accumulate(const ColorPacket& shaded, const ColorPacket& blend_space,
                const Lanes<float>& strength, PixelSums& sums);
/// The mean shaded colour (in the blend space), less what the ink hides, plus the ink.
void lay_mean_ink(const PixelSums& sums, Color line, ColorPacket& colors);

}  // namespace ink
