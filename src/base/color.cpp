#include "base/color.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "base/text.h"

namespace ink {

float srgb_encode(float linear) {
    return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
}

float srgb_decode(float display) {
    return display <= 0.04045F ? display / 12.92F : std::pow((display + 0.055F) / 1.055F, 2.4F);
}

Color srgb_decode(Rgb8 display) {
    const auto channel = [](std::uint8_t v) { return srgb_decode(static_cast<float>(v) / 255.0F); };
    return {channel(display.r), channel(display.g), channel(display.b)};
}

namespace {

std::optional<Rgb8> parse_hex(std::string_view digits) {
    const bool all_digits = digits.find_first_not_of("0123456789abcdefABCDEF") == digits.npos;
    if (!all_digits || (digits.size() != 3 && digits.size() != 6)) return std::nullopt;
    const auto value = parse_hex_number(digits);
    if (!value) return std::nullopt;
    const auto byte = [](unsigned v) { return static_cast<std::uint8_t>(v & 0xFFU); };
    if (digits.size() == 6) return Rgb8{byte(*value >> 16U), byte(*value >> 8U), byte(*value)};
    const auto nibble = [&](unsigned shift) { return byte(((*value >> shift) & 0xFU) * 0x11U); };
    return Rgb8{nibble(8), nibble(4), nibble(0)};
}

}  // namespace

std::optional<Rgb8> parse_color(std::string_view text) {
    // CSS Color Module Level 4, section 6.1: the sixteen basic keywords, and orange.
    static constexpr std::array<std::pair<std::string_view, Rgb8>, 18> kNames{{
        {"black", {0, 0, 0}},
        {"silver", {192, 192, 192}},
        {"gray", {128, 128, 128}},
        {"grey", {128, 128, 128}},
        {"white", {255, 255, 255}},
        {"maroon", {128, 0, 0}},
        {"red", {255, 0, 0}},
        {"purple", {128, 0, 128}},
        {"fuchsia", {255, 0, 255}},
        {"green", {0, 128, 0}},
        {"lime", {0, 255, 0}},
        {"olive", {128, 128, 0}},
        {"yellow", {255, 255, 0}},
        {"navy", {0, 0, 128}},
        {"blue", {0, 0, 255}},
        {"teal", {0, 128, 128}},
        {"aqua", {0, 255, 255}},
        {"orange", {255, 165, 0}},
    }};
    const std::string word = to_lower(text);
    for (const auto& [name, color] : kNames) {
        if (word == name) return color;
    }
    if (text.starts_with('#')) return parse_hex(text.substr(1));

    const auto channels = split(text, ',');
    if (channels.size() != 3) return std::nullopt;
    std::array<std::uint8_t, 3> rgb{};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto value = parse_int(channels[i]);
        if (!value || *value < 0 || *value > 255) return std::nullopt;
        rgb[i] = static_cast<std::uint8_t>(*value);
    }
    return Rgb8{rgb[0], rgb[1], rgb[2]};
}

std::string to_string(Rgb8 color) {
    return fmt::format("#{:02x}{:02x}{:02x}", color.r, color.g, color.b);
}

}  // namespace ink
