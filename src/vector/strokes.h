#pragma once

#include <cstdint>
#include <vector>

#include "lines/chain.h"
#include "lines/curve.h"
#include "lines/density.h"

namespace ink {

/// How heavy a line is at each of its points.
struct LineWeights {
    std::vector<float> width;    ///< pixels
    std::vector<float> opacity;  ///< [0, 1]
};

/// A line of this width, thinner where lines are dense, and as faint as it is weak: what makes
/// lines heavier or lighter from place to place belongs here.
LineWeights weigh(const Chain& chain, double width_px, const LineThinning& thinning);

/// A stretch of a line that is drawn in one go: of one width, and of an opacity that changes, if at
/// all, from the curve's start straight towards its end.
struct Stroke {
    struct Stop {
        double offset;   ///< on the straight way, [0, 1]
        double opacity;  ///< in between, it changes evenly
    };

    Curve curve;
    bool closed = false;
    double begins_at = 0.0;  ///< length of the line before it, pixels
    double width_px = 0.0;
    double opacity = 1.0;      ///< mean
    std::vector<Stop> fade{};  ///< empty: as opaque everywhere
    std::uint32_t chain = 0;   ///< whose line it is part of, set by the owner
};

/// Cuts a chain's curve into strokes; as a rule it is one.
std::vector<Stroke> make_strokes(const Chain& chain, const Curve& curve,
                                 const LineWeights& weights);

}  // namespace ink
