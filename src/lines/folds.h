#pragma once

#include <functional>
#include <span>
#include <vector>

#include "lines/segment.h"
#include "lines/segment_squares.h"
#include "sampling/samples.h"

namespace ink {

/// How self-occlusions are made whole.
struct FoldSettings {
    /// Widths of lines thinner than this, in pixels, count as this.
    float least_width = 0.0F;
    /// A bridge follows the valley of the angle between surface and ray, no steeper than this sine:
    /// about 15 degrees. Suggestive contours (DeCarlo et al. 2003) run along the same valleys.
    float most_facing = 0.26F;
    /// And on both sides the sine rises by this much at least.
    float least_rise = 0.01F;
    float longest_bridge = 10.0F;  ///< widths of the line
    /// To a line of another kind, past the end of which nothing goes on.
    float longest_to_other = 4.0F;
    /// Two ends that look at each other are one line over so many widths, if the sine stays below
    /// this on the way: about 17 degrees.
    float longest_leap = 4.0F;
    float most_facing_leapt = 0.3F;
    /// A line with a loose end is a crumb if it hides next to nothing: its length times the
    /// greatest distance of its two sides, at a right angle to the surface, is less than this, in
    /// squares of its width, and it is not longer than so many widths.
    float crumb_area = 8.0F;
    float stub_area = 5.0F;  ///< the same of one that ends on another line on one side
    /// The same of each of two that go on from each other, which are then judged as one.
    float follower_area = 2.0F;
    /// And it is a crumb, whatever it hides, if it is shorter than so many widths: a dot, or a hair
    /// that sticks out of the line on which it ends. Dashes of three widths still looked like dirt
    /// on scans (the bunny and the armadillo at 1024 x 1024).
    float shortest = 3.5F;
    /// The same of one that lies with both ends on other lines, one of which it does not share: a
    /// bump on it. Where a mesh turns away at an outline, one lattice finds such a bit of an edge
    /// and another does not.
    float shortest_stub = 1.0F;
    float longest_crumb = 12.0F;
    /// What ends loosely while it runs beside another piece, closer than so many widths, so that
    /// their strokes touch or no half a stroke fits in between, is dropped.
    float shadow = 1.5F;
};

struct FoldRepairs {
    std::vector<Segment> bridges;
    std::vector<std::size_t> crumbs;  ///< indices of segments to drop, ascending
};

/// Says that the next samples lie in this part of the screen, or near it.
using AreaFunction = std::function<void(Vec2f low, Vec2f high)>;

/// One thread's way to ask for samples. `enter` may be empty.
struct FoldWorker {
    SampleFunction sample;
    AreaFunction enter;
};

/// Calls `body(k, worker)` for each k in [0, count), no two at one time with the same worker.
using FoldLoop = std::function<void(
    std::size_t count, const std::function<void(std::size_t k, std::size_t worker)>& body)>;

struct FoldTeam {
    std::vector<FoldWorker> workers;
    FoldLoop loop;  ///< over these workers
};

/// On a mesh, and on a bumpy surface, the place where a surface hides itself breaks up: between two
/// of its folds it is merely steep. Joins such pieces of self-occlusions along the steepest way
/// from one to the next, and finds those that are too short and shallow to mean anything, or that
/// double another one. `lines` are all of the picture's that are seen directly, `squares` their
/// places; `spacing` is that of the lattice and `width` that of a self-occlusion, both in pixels.
/// The result depends neither on the lines' order nor on how many workers there are.
FoldRepairs mend_folds(std::span<const Segment> lines, const plane::SegmentSquares& squares,
                       const Viewpoint& viewpoint, float spacing, float width, const FoldTeam& team,
                       const FoldSettings& settings = {});
/// The same on the caller's thread alone.
FoldRepairs mend_folds(std::span<const Segment> lines, const Viewpoint& viewpoint, float spacing,
                       float width, const SampleFunction& sample,
                       const FoldSettings& settings = {});

}  // namespace ink
