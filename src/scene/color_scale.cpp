#include "scene/color_scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

#include "base/parallel.h"

namespace ink {

namespace {

/// Entries that are worth a task of their own.
constexpr std::size_t kGrain = 16384;

Rgb8 undefined_color() { return color_maps().front().at(std::numeric_limits<double>::quiet_NaN()); }

std::pair<double, double> finite_range(std::span<const float> values) {
    constexpr double kMax = std::numeric_limits<double>::max();
    std::pair range{kMax, -kMax};
    for (const float value : values) {
        if (!std::isfinite(value)) continue;
        range.first = std::min<double>(range.first, value);
        range.second = std::max<double>(range.second, value);
    }
    return range;
}

/// Each whole number has its colour; other numbers have none.
Coloring color_categories(const std::string& title, std::span<const float> values) {
    constexpr float kMostNumber = 1 << 24;
    constexpr std::size_t kMostEntries = 1024;
    const auto category = [](float value) {
        return std::abs(value) <= kMostNumber && value == std::floor(value);
    };
    Coloring coloring;
    coloring.colors.reserve(values.size());
    std::map<std::int64_t, Rgb8> seen;
    const Rgb8 undefined = undefined_color();
    for (const float value : values) {
        if (!category(value)) {
            coloring.colors.push_back(undefined);
            continue;
        }
        const auto number = static_cast<std::int64_t>(value);
        const Rgb8 color = category_color(static_cast<std::size_t>(std::abs(number)));
        coloring.colors.push_back(color);
        if (seen.size() < kMostEntries) seen.try_emplace(number, color);
    }
    coloring.scale.emplace();
    coloring.scale->title = title;
    for (const auto& [number, color] : seen) {
        coloring.scale->entries.push_back({fmt::format("{}", number), color});
    }
    return coloring;
}

}  // namespace

Coloring color_words(const std::string& title, std::span<const float> values,
                     std::span<const std::string> words) {
    Coloring coloring;
    coloring.colors.reserve(values.size());
    for (const float value : values) {
        coloring.colors.push_back(category_color(static_cast<std::size_t>(value)));
    }
    coloring.scale.emplace();
    coloring.scale->title = title;
    for (std::size_t k = 0; k < words.size(); ++k) {
        coloring.scale->entries.push_back({words[k], category_color(k)});
    }
    return coloring;
}

Coloring color_field(const std::string& title, std::span<const float> values,
                     const DataSettings& settings) {
    const ColorMap& map = *settings.color_map;
    if (map.is_categorical()) return color_categories(title, values);
    const auto range = settings.color_range.value_or(finite_range(values));
    constexpr std::size_t kSteps = 1024;
    std::array<Rgb8, kSteps> table;
    for (std::size_t k = 0; k < kSteps; ++k) {
        table[k] = map.at(static_cast<double>(k) / (kSteps - 1));
    }
    const double span = range.second - range.first;
    const Rgb8 undefined = undefined_color();
    std::vector<Rgb8> colors(values.size());
    parallel_ranges(values.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const double share = span > 0.0 ? (values[i] - range.first) / span : 0.5;
            const double step = std::clamp(share, 0.0, 1.0) * (kSteps - 1);
            colors[i] = std::isfinite(values[i])
                            ? table[static_cast<std::size_t>(std::lround(step))]
                            : undefined;
        }
    });
    if (range.first > range.second) return {std::move(colors), std::nullopt};
    return {std::move(colors), ColorScale{title, &map, range.first, range.second, {}}};
}

}  // namespace ink
