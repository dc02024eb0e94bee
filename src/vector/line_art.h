#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/color.h"
#include "base/image.h"
#include "lines/chain.h"
#include "lines/curve.h"
#include "lines/dashes.h"
#include "lines/line_type.h"
#include "render/drawing.h"
#include "render/settings.h"
#include "sampling/geometry_names.h"
#include "vector/legend.h"
#include "vector/strokes.h"

namespace ink {

/// What one geometry shows of itself: closed curves, with holes, by the even-odd rule.
struct Region {
    GeometryId id = kBackground;
    std::vector<Curve> outlines;  ///< each ends where it starts
    Rgb8 color;                   ///< mean of its pixels
    enum class Tone : std::uint8_t { one, light, shade } tone = Tone::one;
};

/// A drawing made of curves, ready to be written: what SVG, PDF and JSON have in common.
struct LineArt {
    Size size;
    double dpi = 72.0;
    std::string title;
    Metadata metadata;
    std::optional<Rgb8> background;     ///< none: transparent
    std::optional<DisplayImage> image;  ///< the shaded picture below the lines
    std::vector<Region> regions;
    std::vector<Chain> chains;        ///< of the types that were asked for; t in units of the file
    std::vector<Curve> curves;        ///< one a chain
    std::vector<StrokeStyle> styles;  ///< one a chain; strokes may be thinner
    std::vector<std::optional<Dashes>> dashes;  ///< likewise; nothing: a solid line
    std::vector<Stroke> strokes;                ///< chain after chain
    GeometryNames names;
    Legend legend;  ///< above all
};

/// Regions reach this far below their neighbours, or a renderer that smooths the two edges one
/// after the other lets the background shine through between them.
inline constexpr double kUnderlapPx = 0.5;

/// The picture below the lines and the lines' segments as curves. `image` is the picture without
/// lines. Tolerance, fill and shortest length are settings.
LineArt make_line_art(const Scene& scene, const Settings& settings, const Drawing& drawing,
                      const DisplayImage& image);

/// The geometry in front, and the one behind; equal for self-occlusions and creases.
GeometryId front(const Chain& chain);
GeometryId behind(const Chain& chain);

}  // namespace ink
