#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "accel/projection.h"
#include "base/vec.h"
#include "scene/mesh.h"

// Walks over a mesh side by side: eight at a time, step by step. The arithmetic of each is that of
// doubles one by one, whatever the instruction set.
namespace ink {

/// What the ways of a picture have in common. W, the length of a pixel at a depth, is
/// pixel_at_start + pixel_a_depth * depth.
struct WayView {
    Vec3d start, forward;
    double pixel_at_start, pixel_a_depth;

    explicit WayView(const Projection& projection)
        : start(projection.start),
          forward(projection.forward),
          pixel_at_start(projection.origin_step),
          pixel_a_depth(projection.slope_step) {}
};

/// The way from one point of the screen to another, as numbers that are linear in a point X of the
/// scene: on which side of the way it lies and how far along, both times W.
struct WayLine {
    Vec3d side, along;
    double side_at_start, along_at_from;

    WayLine(const Projection& projection, Vec2f from, Vec2f to);
};

/// Where a vertex is, seen from a line.
struct Foot {
    double side, along, depth;
};

/// The two ends of an edge.
using Feet = std::array<Foot, 2>;

Foot foot_of(const WayView& view, const WayLine& line, Vec3f vertex);

/// Between two places of a way that are nearer than this, rounding decides.
inline constexpr double kWayRounding = 1e-7;

inline constexpr std::size_t kWalkLanes = 8;
inline constexpr std::size_t kMostWalkSteps = 64;
using WalkNumbers = std::array<double, kWalkLanes>;
using WalkIndices = std::array<std::uint32_t, kWalkLanes>;

/// Where walks begin, and what for. Lanes without a walk must hold that of another one.
struct alignas(64) WalkStarts {
    WalkNumbers side_x, side_y, side_z, along_x, along_y, along_z, side_at_start, along_at_from;
    WalkNumbers triangle, target;  ///< where a walk begins, and where it has arrived
    WalkNumbers limit;             ///< it goes no farther along its way
    WalkNumbers backwards;         ///< 1: from the line's second point to its first; else 0

    void put(std::size_t lane, const WayLine& line, std::uint32_t from, std::uint32_t to,
             double far_enough, bool turned_round);
};

/// Step k of each walk: the triangle that it enters, from where on, and by which edge of the
/// triangle before. The last step says where the way ends.
struct alignas(64) WalkRow {
    WalkNumbers at, nearness;  ///< linear on the screen over any plane, larger in front
    WalkIndices edge, triangle;
};
inline constexpr std::size_t kMostWalkRows = kMostWalkSteps + 2;

enum class WalkEnd : std::uint8_t {
    unknown,
    arrived,  ///< at the triangle it was to lead to
    beyond,   ///< of what was asked for
    turned,   ///< the surface turns away from the viewer
    rim       ///< the surface ends
};

struct alignas(64) WalkEnds {
    std::array<WalkNumbers, 6> feet;  ///< of the edge at which a walk ends: side, along, depth of
                                      ///< its first corner, then of its second
    WalkIndices count;                ///< of its steps
    WalkIndices end;                  ///< WalkEnd
};

/// As many triangles and vertices a mesh may have.
inline constexpr std::size_t kMostWalked = (std::size_t{1} << 31U) / 3;

/// So many groups of walks may go together: the more, the less each waits for the mesh.
inline constexpr std::size_t kMostWalkGroups = 16;

/// Walks group by group: `rows[k]` has room for kMostWalkRows rows of group k. By which edge a way
/// leaves a triangle is decided by signs that belong to vertices alone, so that it never slips
/// between two triangles.
void walk_side_by_side(const Mesh& mesh, const WayView& view, std::span<const WalkStarts> starts,
                       std::span<WalkRow* const> rows, std::span<WalkEnds> ends);

}  // namespace ink
