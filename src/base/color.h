#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace ink {

/// A colour of three components, linear or display-encoded (sRGB) as the name of the variable says.
struct Color {
    float r{}, g{}, b{};
    friend constexpr bool operator==(Color, Color) = default;
};

/// A display-encoded (sRGB) colour, 8 bits a channel, as files and palettes give them.
struct Rgb8 {
    std::uint8_t r{}, g{}, b{};
    friend constexpr bool operator==(Rgb8, Rgb8) = default;
};

/// sRGB transfer function (IEC 61966-2-1): linear [0, 1] to display [0, 1], and back.
float srgb_encode(float linear);
float srgb_decode(float display);

Color srgb_decode(Rgb8 display);

/// Reads "#rgb", "#rrggbb", "r,g,b" (0 to 255) or a CSS basic colour name such as "white".
std::optional<Rgb8> parse_color(std::string_view text);
/// "#rrggbb".
std::string to_string(Rgb8 color);

}  // namespace ink
