#include "render/values.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/text.h"

namespace ink {

ValueForm whole(double least, double most) { return {ValueForm::Kind::whole, {}, least, most}; }
ValueForm number(double least, double most) { return {ValueForm::Kind::number, {}, least, most}; }
ValueForm length_px(double least, double most) {
    return {ValueForm::Kind::length, {}, least, most};
}
ValueForm color() { return {ValueForm::Kind::color}; }
ValueForm any_text(std::vector<std::string_view> some_words) {
    return {ValueForm::Kind::text, std::move(some_words)};
}

double Length::pixels(double dpi, int picture_height) const {
    switch (unit) {
        case Unit::px: return value;
        case Unit::pt: return value * dpi / 72.0;
        case Unit::mm: return value * dpi / 25.4;
        case Unit::percent: return value * picture_height / 100.0;
    }
    return value;
}

namespace {

constexpr std::array<std::string_view, 4> kUnitNames{"px", "pt", "mm", "%"};

}  // namespace

double read_number(std::string_view text, double least, double most) {
    const auto value = parse_double(text);
    if (!value || !(*value >= least) || !(*value <= most)) {
        throw UsageError(fmt::format("'{}' is not a number from {} to {}", text, least, most));
    }
    return *value;
}

int read_int(std::string_view text, int least, int most) {
    const auto value = parse_int(text);
    if (!value || *value < least || *value > most) {
        throw UsageError(
            fmt::format("'{}' is not a whole number from {} to {}", text, least, most));
    }
    return static_cast<int>(*value);
}

Rgb8 read_color(std::string_view text) {
    const auto color = parse_color(text);
    if (!color) {
        throw UsageError(fmt::format(
            "'{}' is not a colour; write a name such as white, #rrggbb, or r,g,b from 0 to 255",
            text));
    }
    return *color;
}

Length read_length(std::string_view text, bool zero_allowed) {
    Length length;
    std::string_view number = trim(text);
    for (std::size_t unit = 0; unit < kUnitNames.size(); ++unit) {
        if (!number.ends_with(kUnitNames[unit])) continue;
        number.remove_suffix(kUnitNames[unit].size());
        length.unit = static_cast<Length::Unit>(unit);
        break;
    }
    const auto value = parse_double(number);
    const bool is_length = value && std::isfinite(*value) && *value >= 0.0;
    if (!is_length || (*value == 0.0 && !zero_allowed)) {
        throw UsageError(fmt::format(
            "'{}' is not a {}; write a positive number with px, pt, mm or %, as in 2px or 0.5pt",
            text, zero_allowed ? "length" : "width"));
    }
    length.value = *value;
    return length;
}

Vec3d read_vector(std::string_view text) {
    const auto parts = split(text, ',');
    std::array<double, 3> v{};
    bool good = parts.size() == 3;
    for (std::size_t i = 0; good && i < 3; ++i) {
        const auto value = parse_double(parts[i]);
        good = value && std::isfinite(*value);
        if (good) v[i] = *value;
    }
    if (!good)
        throw UsageError(fmt::format("'{}' is not a vector; write X,Y,Z, as in 0,1,0", text));
    return {v[0], v[1], v[2]};
}

std::vector<Property> read_properties(std::string_view text) {
    std::vector<Property> properties;
    for (const std::string_view part : split(text, ',')) {
        const std::size_t equals = part.find('=');
        if (equals != std::string_view::npos) {
            properties.push_back(
                {trim(part.substr(0, equals)), std::string(trim(part.substr(equals + 1)))});
        } else if (!properties.empty()) {
            properties.back().value += fmt::format(",{}", part);
        } else {
            throw UsageError(fmt::format("'{}' is not of the form key=value", part));
        }
    }
    return properties;
}

std::string print(const Length& length) {
    return fmt::format("{}{}", length.value, kUnitNames[static_cast<std::size_t>(length.unit)]);
}

}  // namespace ink
