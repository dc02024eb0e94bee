#pragma once

#include <array>
#include <cstdint>

#include "base/vec.h"
#include "lines/line_type.h"
#include "scene/ids.h"

namespace ink {

/// A piece of a line, straight, no longer than a lattice cell's diagonal.
///
/// What chains of them may rely on: segments that go on from each other across the side of a cell
/// share that end bit by bit, as do those that meet in a junction within a cell; only where a line
/// ends on another, in front of it, does its end lie on the inside of the other segment. Each end
/// on a cell's side is shared by exactly two segments, unless the line ends there. The order of
/// segments, and which end is `a`, mean nothing.
struct Segment {
    Vec2f a, b;  ///< ends, pixels
    LineType type = LineType::silhouette;
    float strength = 1.0F;  ///< [0, 1]; below 1 for creases of small angle
    /// Of its style's width: below 1 where what it is a line of is far away and lines taper, or
    /// small. Among many lines LineThinning takes more of it.
    float width_scale = 1.0F;
    float t = 0.0F;    ///< of the nearer side, distance along the ray as in Sample
    float gap = 0.0F;  ///< by how much the far side lies behind, scene units; where halos ask
    /// Geometry on the left and on the right of the way from a to b (y points down); equal for
    /// lines within one geometry.
    GeometryId left = kBackground, right = kBackground;
    GeometryId owner = kBackground;  ///< the geometry whose line it is: the nearer of the two
    bool left_in_front = true;       ///< which side is nearer to the viewer
    /// The same as found at b: another line may end on this one, and what is behind it change.
    LineType type_at_b = LineType::silhouette;
    GeometryId left_at_b = kBackground, right_at_b = kBackground;
    bool left_in_front_at_b = true;
    /// Lattice points whose colours the two sides have: indices into the grid that was searched.
    std::uint32_t left_sample = 0, right_sample = 0;
    bool spans_cell =
        false;              ///< runs from one side of its cell to another, not to a junction in it
    bool hidden = false;    ///< on a surface behind others
    bool for_data = false;  ///< a line between faces that is drawn without it (FaceEdges)
    /// How many mirrors, panes of glass and transparent surfaces it is seen by: 0 if directly.
    std::uint8_t level = 0;
};

}  // namespace ink
