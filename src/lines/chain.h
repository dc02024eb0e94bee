#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "lines/line_type.h"
#include "lines/segment.h"
#include "lines/segment_graph.h"
#include "scene/ids.h"

namespace ink {

/// A line of the picture from one junction to the next, or round to its own start: one type, one
/// geometry on each side.
struct Chain {
    LineType type = LineType::silhouette;
    /// Geometry on the left and on the right of the way along the points (y points down).
    GeometryId left = kBackground, right = kBackground;
    bool left_in_front = true;        ///< which of the sides is nearer to the viewer
    float strength = 1.0F;            ///< mean over the length, [0, 1]
    bool hidden = false;              ///< on surfaces behind others
    int level = 0;                    ///< see Segment; chains of two levels are never joined
    bool closed = false;              ///< runs on from the last point to the first
    std::vector<Vec2f> points;        ///< pixels; at least two, three where closed
    std::vector<float> t;             ///< of the nearer side at each point, as in Segment
    std::vector<float> strengths;     ///< likewise at each point
    std::vector<float> width_scales;  ///< likewise; empty: 1
    /// Junctions that the ends share with other chains: equal numbers, bitwise equal points.
    std::uint32_t first_vertex = 0, last_vertex = 0;
    /// The line that it was split off at a corner, if it was.
    struct Whole {
        double length = 0.0;  ///< pixels
        bool closed = false;
    } whole{};
};

/// A chain of a path, and whether the path runs against it.
struct PathStep {
    std::uint32_t chain = 0;
    bool reversed = false;
    bool at_corner = false;  ///< begins at a corner where a chain was split
};

/// Chains that make one line for the eye: where another line ends on it, or its type changes, a
/// line goes on in the same direction.
struct Path {
    std::vector<PathStep> steps;
    bool closed = false;
};

/// All lines of a picture. Every chain is in exactly one path.
struct ChainGraph {
    std::vector<Chain> chains;
    std::vector<Path> paths;
};

/// Joins segments, which must be of one level, into chains: at bitwise equal ends, and where an end
/// lies on another segment of its cell. `spacing` is the lattice's, in pixels. The result does not
/// depend on the order of the segments, and so not on how the picture was cut into tiles.
ChainGraph chain_segments(std::span<const Segment> segments, float spacing);

/// Chains, and the first and the last way of each: they follow each other by next_of_type.
struct ChainedWays {
    ChainGraph graph;
    std::vector<std::array<Way, 2>> ways;
};
ChainedWays chain_ways(const SegmentGraph& graph);

/// Length of the polyline, pixels.
double length_of(const Chain& chain);

}  // namespace ink
