#include "render/material_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

#include "base/error.h"
#include "base/text.h"
#include "render/values.h"

namespace ink {

namespace {

/// A key whose value is a number.
struct Number {
    std::string_view key;
    std::optional<double> MaterialRule::*value;
    double least, most;
};
constexpr std::array<Number, 3> kNumbers{{
    {"specular", &MaterialRule::specular, 0.0, 1.0},
    {"roughness", &MaterialRule::roughness, kLeastRoughness, 1.0},
    {"metal", &MaterialRule::metal, 0.0, 1.0},
}};

void read_property(const Property& property, MaterialRule& rule) {
    if (property.key == "color") {
        rule.color = read_color(property.value);
        return;
    }
    std::vector<std::string_view> keys{"color"};
    for (const Number& number : kNumbers) {
        keys.push_back(number.key);
        if (property.key != number.key) continue;
        try {
            rule.*number.value = read_number(property.value, number.least, number.most);
        } catch (const UsageError& error) {
            throw UsageError(fmt::format("{}: {}", number.key, error.what()));
        }
        return;
    }
    throw UsageError(fmt::format("'{}' is not one of {}", property.key, fmt::join(keys, ", ")));
}

MaterialRule read_rule(std::string_view text) {
    MaterialRule rule;
    const std::size_t colon = text.substr(0, text.find('=')).rfind(':');
    if (colon != std::string_view::npos) {
        rule.object = trim(text.substr(0, colon));
        if (rule.object.empty()) {
            throw UsageError(fmt::format("'{}' names no object before its colon", text));
        }
        text.remove_prefix(colon + 1);
    }
    for (const Property& property : read_properties(text)) read_property(property, rule);
    return rule;
}

std::string print(const MaterialRule& rule) {
    std::vector<std::string> properties;
    if (rule.color) properties.push_back(fmt::format("color={}", to_string(*rule.color)));
    for (const Number& number : kNumbers) {
        const auto& value = rule.*number.value;
        if (value) properties.push_back(fmt::format("{}={}", number.key, *value));
    }
    return fmt::format("{}{}{}", rule.object, rule.object.empty() ? "" : ":",
                       fmt::join(properties, ","));
}

}  // namespace

std::vector<MaterialRule> read_material_rules(std::string_view text) {
    std::vector<MaterialRule> rules;
    for (const std::string_view rule : split(text, ';')) rules.push_back(read_rule(rule));
    return rules;
}

std::string print(const std::vector<MaterialRule>& rules) {
    std::vector<std::string> texts;
    for (const MaterialRule& rule : rules) texts.push_back(print(rule));
    return fmt::format("{}", fmt::join(texts, ";"));
}

}  // namespace ink
