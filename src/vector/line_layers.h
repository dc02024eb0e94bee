#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "render/line_styles.h"
#include "vector/line_art.h"

namespace ink {

/// Strokes of one kind, drawn together.
struct LineLayer {
    std::string_view name;             ///< of the type, or "hidden"
    std::vector<std::size_t> strokes;  ///< from the farthest to the nearest
    StrokeStyle usual;                 ///< of the first
    /// Of all alike, which then does not add up where they overlap; nothing: each has its own.
    std::optional<double> opacity;
};

/// From the bottom up; none is empty. `opacity` is that of all layers, if they are equally opaque
/// and of one colour; theirs is 1 then.
struct LineLayers {
    std::vector<LineLayer> layers;
    double opacity = 1.0;
};
LineLayers layers_of(const LineArt& art);

}  // namespace ink
