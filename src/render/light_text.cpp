#include "render/light_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/error.h"
#include "base/text.h"
#include "render/values.h"

namespace ink {

namespace {

using Kind = LightRule::Kind;

struct NamedKind {
    std::string_view name;
    Kind kind;
    std::vector<std::string_view> keys;
};

const std::vector<NamedKind>& kinds() {
    static const std::vector<NamedKind> kKinds{
        {"camera", Kind::camera, {"from", "size", "strength", "color"}},
        {"sun", Kind::sun, {"from", "size", "strength", "color"}},
        {"disc", Kind::disc, {"from", "size", "strength", "color"}},
        {"sky", Kind::sky, {"strength", "color", "ground"}}};
    return kKinds;
}

const NamedKind& named(Kind kind) { return *std::ranges::find(kinds(), kind, &NamedKind::kind); }

double read_size(Kind kind, std::string_view text) {
    constexpr double kWidest = 90.0;  // degrees
    return read_number(text, 0.0, kind == Kind::disc ? 1e15 : kWidest);
}

void read_property(const NamedKind& kind, const Property& property, LightRule& light) {
    if (std::ranges::find(kind.keys, property.key) == kind.keys.end()) {
        throw UsageError(fmt::format("'{}' is not one of {}, the keys of {}", property.key,
                                     fmt::join(kind.keys, ", "), kind.name));
    }
    constexpr double kStrongest = 100.0;
    try {
        if (property.key == "from") light.from = read_vector(property.value);
        if (property.key == "size") light.size = read_size(light.kind, property.value);
        if (property.key == "strength") {
            light.strength = read_number(property.value, 0.0, kStrongest);
        }
        if (property.key == "color") light.color = read_color(property.value);
        if (property.key == "ground") light.ground = read_color(property.value);
    } catch (const UsageError& error) {
        throw UsageError(fmt::format("{}: {}", property.key, error.what()));
    }
    if (property.key == "from" && light.kind != Kind::disc && !(length(light.from) > 0.0)) {
        throw UsageError(fmt::format("from: '{}' has no length; write a direction such as 1,1,1",
                                     property.value));
    }
}

LightRule read_light(std::string_view text) {
    const std::size_t colon = text.find(':');
    const std::string_view name = trim(text.substr(0, colon));
    const auto found = std::ranges::find(kinds(), name, &NamedKind::name);
    if (found == kinds().end()) {
        throw UsageError(
            fmt::format("'{}' is not one of {}; write for example camera:from=-1,1,1,strength=0.8",
                        name, fmt::join(light_kinds(), ", ")));
    }
    LightRule light;
    light.kind = found->kind;
    if (colon == std::string_view::npos) return light;
    for (const Property& property : read_properties(text.substr(colon + 1))) {
        read_property(*found, property, light);
    }
    return light;
}

std::string print(const LightRule& light) {
    const LightRule usual;
    std::vector<std::string> properties;
    if (light.kind != Kind::sky) {
        properties.push_back(
            fmt::format("from={},{},{}", light.from.x, light.from.y, light.from.z));
    }
    if (light.size != usual.size) properties.push_back(fmt::format("size={}", light.size));
    properties.push_back(fmt::format("strength={}", light.strength));
    if (light.color != usual.color) {
        properties.push_back(fmt::format("color={}", to_string(light.color)));
    }
    if (light.ground) properties.push_back(fmt::format("ground={}", to_string(*light.ground)));
    return fmt::format("{}:{}", named(light.kind).name, fmt::join(properties, ","));
}

}  // namespace

std::vector<std::string_view> light_kinds() {
    std::vector<std::string_view> names;
    for (const NamedKind& kind : kinds()) names.push_back(kind.name);
    return names;
}

std::vector<LightRule> read_lights(std::string_view text) {
    std::vector<LightRule> lights;
    for (const std::string_view light : split(text, ';')) lights.push_back(read_light(light));
    return lights;
}

std::string print(const std::vector<LightRule>& lights) {
    std::vector<std::string> texts;
    for (const LightRule& light : lights) texts.push_back(print(light));
    return fmt::format("{}", fmt::join(texts, ";"));
}

}  // namespace ink
