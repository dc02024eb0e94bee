#include "scene/kind_colors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

#include "base/text.h"

namespace ink {

namespace {

/// Whether the values are whole numbers, several of them, but not so many that they are rather
/// counts or names.
bool are_kinds(std::span<const float> values) {
    constexpr std::size_t kMost = 64;
    std::vector<float> kinds;
    for (const float value : values) {
        if (!kinds.empty() && value == kinds.back()) continue;
        if (!std::isfinite(value) || value != std::floor(value)) return false;
        if (const auto known = std::ranges::find(kinds, value); known != kinds.end()) {
            std::iter_swap(known, std::prev(kinds.end()));  // the next one is often alike
        } else if (kinds.size() < kMost) {
            kinds.push_back(value);
        } else {
            return false;
        }
    }
    return kinds.size() > 1;
}

}  // namespace

bool is_kind_name(std::string_view name) {
    constexpr std::array<std::string_view, 5> kNames{"type", "particle_type", "particle type",
                                                     "atom_type", "material"};
    return std::ranges::find(kNames, to_lower(name)) != kNames.end();
}

std::optional<Coloring> color_kinds(std::span<const Field> fields) {
    for (const Field& field : fields) {
        if (field.components != 1 || !is_kind_name(field.name) || !are_kinds(field.values))
            continue;
        if (!field.words.empty()) return color_words(field.name, field.values, field.words);
        DataSettings settings;
        settings.color_map = find_color_map("categories");
        return color_field(field.name, field.values, settings);
    }
    return std::nullopt;
}

}  // namespace ink
