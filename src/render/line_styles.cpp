#include "render/line_styles.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/text.h"

namespace ink {

namespace {

constexpr std::array<std::string_view, kLineTypes> kNames{
    "silhouette", "intersection", "self-occlusion", "crease", "boundary", "mesh", "ridge"};

constexpr int kMostObjects = 1 << 24;
constexpr int kMostLevels = 16;

void read_target(std::string_view text, LineRule& rule) {
    const std::size_t slash = text.find('/');
    if (slash != std::string_view::npos) {
        const std::string_view level = trim(text.substr(slash + 1));
        rule.and_beyond = level == "+";
        rule.level = rule.and_beyond ? 1 : read_int(level, 0, kMostLevels);
        text = text.substr(0, slash);
    }
    const std::size_t at = text.find('@');
    if (at != std::string_view::npos) rule.object = read_int(text.substr(at + 1), 1, kMostObjects);
    const std::string_view type = trim(text.substr(0, at));
    rule.hidden = type == "hidden";
    rule.inner = type == "inner";
    if (type != "all" && !rule.hidden && !rule.inner) rule.type = read_line_type(type);
}

void read_property(std::string_view key, std::string_view value, LineRule& rule) {
    if (key == "width") {
        rule.width = read_length(value);
    } else if (key == "color") {
        rule.color = read_color(value);
    } else if (key == "opacity") {
        rule.opacity = read_number(value, 0.0, 1.0);
    } else {
        throw UsageError(fmt::format("'{}' is not one of width, color, opacity", key));
    }
}

LineRule read_rule(std::string_view text) {
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) {
        throw UsageError(fmt::format(
            "'{}' has no colon; write TYPE:key=value,... as in crease:width=1px,color=gray", text));
    }
    LineRule rule;
    read_target(text.substr(0, colon), rule);
    for (const Property& property : read_properties(text.substr(colon + 1))) {
        read_property(property.key, property.value, rule);
    }
    return rule;
}

std::string print(const LineRule& rule) {
    std::vector<std::string> properties;
    if (rule.width) properties.push_back(fmt::format("width={}", print(*rule.width)));
    if (rule.color) properties.push_back(fmt::format("color={}", to_string(*rule.color)));
    if (rule.opacity) properties.push_back(fmt::format("opacity={}", *rule.opacity));
    std::string level;
    if (rule.level) level = rule.and_beyond ? "/+" : fmt::format("/{}", *rule.level);
    return fmt::format("{}{}{}:{}",
                       rule.hidden  ? "hidden"
                       : rule.inner ? "inner"
                       : rule.type  ? name_of(*rule.type)
                                    : "all",
                       rule.object > 0 ? fmt::format("@{}", rule.object) : "", level,
                       fmt::join(properties, ","));
}

}  // namespace

std::string_view name_of(LineType type) { return kNames[static_cast<std::size_t>(type)]; }

LineType read_line_type(std::string_view text) {
    const auto found = std::ranges::find(kNames, text);
    if (found == kNames.end()) {
        throw UsageError(fmt::format("'{}' is not one of {}, all, inner, hidden", text,
                                     fmt::join(kNames, ", ")));
    }
    return static_cast<LineType>(found - kNames.begin());
}

std::vector<LineRule> read_line_rules(std::string_view text) {
    std::vector<LineRule> rules;
    for (const std::string_view rule : split(text, ';')) rules.push_back(read_rule(rule));
    return rules;
}

std::string print(const std::vector<LineRule>& rules) {
    std::vector<std::string> texts;
    for (const LineRule& rule : rules) texts.push_back(print(rule));
    return fmt::format("{}", fmt::join(texts, ";"));
}

}  // namespace ink
