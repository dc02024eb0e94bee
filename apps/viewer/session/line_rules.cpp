#include "session/line_rules.h"

#include <algorithm>

#include "base/text.h"

namespace inktrace::viewer {

LineRules::LineRules(std::string_view text) {
    for (const std::string_view part : ink::split(text, ';')) {
        const std::size_t colon = part.find(':');
        if (colon == std::string_view::npos) continue;
        Rule rule{std::string(ink::trim(part.substr(0, colon))), {}};
        for (const std::string_view pair : ink::split(part.substr(colon + 1), ',')) {
            const std::size_t equals = pair.find('=');
            if (equals == std::string_view::npos) continue;
            rule.values.emplace_back(pair.substr(0, equals), pair.substr(equals + 1));
        }
        rules_.push_back(std::move(rule));
    }
}

std::string LineRules::text() const {
    std::string text;
    for (const Rule& rule : rules_) {
        if (rule.values.empty()) continue;
        text += (text.empty() ? "" : ";") + rule.target + ":";
        bool first = true;
        for (const auto& [key, value] : rule.values) {
            text += (first ? "" : ",") + key + "=" + value;
            first = false;
        }
    }
    return text;
}

std::optional<std::string> LineRules::get(std::string_view type, std::string_view key) const {
    std::optional<std::string> found;
    for (const Rule& rule : rules_) {
        if (rule.target != type && rule.target != "all") continue;
        for (const auto& [name, value] : rule.values) {
            if (name == key) found = value;
        }
    }
    return found;
}

void LineRules::set(std::string_view type, std::string_view key, const std::string& value) {
    // The last rule of the type counts.
    auto rule = std::ranges::find(rules_.rbegin(), rules_.rend(), type, &Rule::target);
    if (rule == rules_.rend()) {
        if (value.empty()) return;
        const auto single = std::ranges::find_if(
            rules_, [](const Rule& r) { return r.target.find('@') != std::string::npos; });
        rules_.insert(single, Rule{std::string(type), {{std::string(key), value}}});
        return;
    }
    std::erase_if(rule->values, [&](const auto& pair) { return pair.first == key; });
    if (!value.empty()) rule->values.emplace_back(key, value);
}

bool LineRules::has(std::string_view type) const {
    return std::ranges::find(rules_, type, &Rule::target) != rules_.end();
}

void LineRules::clear(std::string_view type) {
    std::erase_if(rules_, [&](const Rule& rule) { return rule.target == type; });
}

}  // namespace inktrace::viewer
