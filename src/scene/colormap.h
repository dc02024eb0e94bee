#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "base/color.h"

namespace ink {

/// A scale of colours from a field's least value (0) to its greatest (1).
struct ColorMap {
    std::string_view name;    ///< "viridis"
    std::string_view colors;  ///< "rrggbb" at evenly spaced values, sRGB; none: of categories

    /// Gives whole numbers colours that are easy to tell apart (`category_color`).
    bool is_categorical() const { return colors.empty(); }

    /// The colour at `x`, which is clamped to [0, 1]; NaN is pink, as an unknown element is. Not of
    /// a map of categories.
    Rgb8 at(double x) const;
};

/// All maps: viridis (the default), cividis, magma, inferno and plasma (perceptually uniform, from
/// matplotlib, CC0), coolwarm (diverging, Moreland 2009), gray, and categories.
std::span<const ColorMap> color_maps();

/// The map of that name; null where there is none.
const ColorMap* find_color_map(std::string_view name);

/// Colour `index` of a list of colours that are easy to tell apart: the eight of Okabe and Ito
/// (2008) less black, then lighter and darker ones of the same hues, then again from the start.
Rgb8 category_color(std::size_t index);

}  // namespace ink
