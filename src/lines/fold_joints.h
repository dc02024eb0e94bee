#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lines/placed_lines.h"
#include "lines/segment.h"

namespace ink {

/// How joints of self-occlusions are eased.
struct JointSettings {
    float reach = 2.0F;  ///< widths of the line to each side of a jog that a curve takes its place
    /// Two ends that run past each other, no farther apart than this, in widths, are one line: so
    /// near to each other that of two pieces side by side one was dropped.
    float aside = 1.8F;
    float overlap = 2.5F;       ///< past each other by up to so many widths
    float gap = 2.0F;           ///< or short of each other
    float hair = 1.0F;          ///< widths: what is shorter and sticks out of a joint is dropped
    float hook = 2.5F;          ///< widths: likewise where a line turns back, so near to its end,
    float hook_turn = 70.0F;    ///< by as much, degrees
    float least_turn = 15.0F;   ///< degrees: a jog turns by as much at once,
    float most_turned = 30.0F;  ///< and no more than this from before it to after it: no corner
};

struct FoldJoints {
    std::vector<std::size_t> dropped;  ///< indices of segments, ascending
    std::vector<Segment> curves;       ///< in their place
};

/// Folds of a bumpy surface that follow each other seldom lie in one line: each ends a pixel or two
/// beside the next. Where pieces of self-occlusions were joined, such a jog becomes a curve.
/// `lines` are all of the picture's that are seen directly; some, by their indices, are `gone`.
/// `width`: of a self-occlusion, pixels. The result does not depend on their order.
FoldJoints ease_joints(const plane::PlacedLines& lines, std::span<const std::size_t> gone,
                       float spacing, float width, const JointSettings& settings = {});

}  // namespace ink
