#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/color.h"
#include "scene/data_settings.h"

namespace ink {

/// What the colours of an object mean, as a legend shows it: a scale of numbers, or a list of
/// kinds.
struct ColorScale {
    struct Entry {
        std::string name;
        Rgb8 color;
        friend bool operator==(const Entry&, const Entry&) = default;
    };

    std::string title;              ///< "velocity", "chain"
    const ColorMap* map = nullptr;  ///< of a scale of numbers; null for kinds
    double least = 0.0;             ///< values at the ends of the map
    double most = 0.0;
    std::vector<Entry> entries{};  ///< the kinds

    friend bool operator==(const ColorScale&, const ColorScale&) = default;
};

/// A colour an entry, and what they mean. Without colours the object's material shows.
struct Coloring {
    std::vector<Rgb8> colors;
    std::optional<ColorScale> scale;
};

/// The colours of a field: from its least to its greatest finite value, or over the range that is
/// set; with a map of categories, a colour for each whole number.
Coloring color_field(const std::string& title, std::span<const float> values,
                     const DataSettings& settings);
/// The colours of a field of words, one each: `values` count them from 0 on.
Coloring color_words(const std::string& title, std::span<const float> values,
                     std::span<const std::string> words);

}  // namespace ink
