#pragma once

#include <vector>

#include "base/vec.h"
#include "lines/density.h"
#include "lines/segment.h"

namespace ink {

/// Hidden lines shorter than this, in pixels, are crumbs left where the surfaces in front end.
inline constexpr double kShortestHidden = 3.0;

/// The lines of a frame as data, for what is not made of pixels.
struct Drawing {
    /// Those of the types that were asked for, and all that divide two geometries as they are seen
    /// directly. Their order depends on the tiles; `left_sample` and `right_sample` mean nothing
    /// any more. `t` is the distance from the eye, or from the camera's plane, as in the AOV Z.
    std::vector<Segment> segments;
    /// Those on surfaces behind others, if they were asked for; not what a nearer line lies over.
    std::vector<Segment> hidden;
    /// Whether the sides of `segments` are tones instead of geometries, see Tones.
    bool tones = false;
    LineThinning thinning;
    float spacing = 1.0F;  ///< of the lattice, pixels
    /// Corners of the rectangle that all of them lie in, pixels: beyond the picture by what lines
    /// reach in from there.
    Vec2f lower, upper;
};

}  // namespace ink
