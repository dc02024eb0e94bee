#include "scene/field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/text.h"

namespace ink {

namespace {

const Field* find_field(std::span<const Field> fields, std::string_view name) {
    const auto found = std::ranges::find(fields, name, &Field::name);
    return found == fields.end() ? nullptr : &*found;
}

std::optional<std::size_t> component_index(std::string_view text, std::size_t components) {
    constexpr std::string_view kLetters = "xyzw";
    const std::size_t letter = text.size() == 1 ? kLetters.find(text[0]) : std::string_view::npos;
    const std::int64_t index = letter != std::string_view::npos ? static_cast<std::int64_t>(letter)
                                                                : parse_int(text).value_or(-1);
    if (index < 0 || static_cast<std::size_t>(index) >= components) return std::nullopt;
    return static_cast<std::size_t>(index);
}

float length(std::span<const float> vector) {
    double sum = 0.0;
    for (const float x : vector) sum += static_cast<double>(x) * x;
    return static_cast<float>(std::sqrt(sum));
}

}  // namespace

std::vector<float> scalar_values(std::span<const Field> fields, std::string_view name) {
    if (const Field* const field = find_field(fields, name)) {
        if (field->components == 1) return field->values;
        std::vector<float> lengths;
        for (std::size_t i = 0; i < field->values.size(); i += field->components) {
            lengths.push_back(length(std::span(field->values).subspan(i, field->components)));
        }
        return lengths;
    }
    const std::size_t dot = name.rfind('.');
    if (dot == std::string_view::npos) return {};
    const Field* const field = find_field(fields, name.substr(0, dot));
    if (field == nullptr) return {};
    const auto component = component_index(name.substr(dot + 1), field->components);
    if (!component) return {};
    std::vector<float> values;
    for (std::size_t i = *component; i < field->values.size(); i += field->components) {
        values.push_back(field->values[i]);
    }
    return values;
}

std::span<const std::string> words_of(std::span<const Field> fields, std::string_view name) {
    const Field* const field = find_field(fields, name);
    return field == nullptr ? std::span<const std::string>() : std::span(field->words);
}

FieldSummary summarize(const Field& field) {
    constexpr double kMax = std::numeric_limits<double>::max();
    FieldSummary summary{field.name, field.components, kMax, -kMax};
    for (const float value : field.values) {
        if (!std::isfinite(value)) continue;
        summary.least = std::min<double>(summary.least, value);
        summary.most = std::max<double>(summary.most, value);
    }
    return summary;
}

std::string field_names(std::span<const Field> fields) {
    std::string names;
    for (const Field& field : fields) {
        if (!names.empty()) names += ", ";
        names += field.components == 1 ? field.name
                                       : fmt::format("{} ({})", field.name, field.components);
    }
    return names;
}

}  // namespace ink
