#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "base/vec.h"
#include "sampling/surface_key.h"

namespace ink {

/// What lies on the way from a point of the screen, the first, to its neighbour, the second, each
/// of which sees a mesh or the background, by the shape of the meshes alone.
struct MeshCrossing {
    enum class Kind : std::uint8_t {
        unknown,         ///< the meshes do not tell
        smooth,          ///< one surface, without a crease
        crease,          ///< one surface, and the sharpest of the creases on the way
        first_contour,   ///< the first surface ends there, before the second or the background
        second_contour,  ///< the second surface ends there, before the first or the background
        seam             ///< two surfaces pass through each other there
    };
    Kind kind = Kind::unknown;
    bool at_rim = false;  ///< of a contour: the surface ends at an open edge; else it turns away
    double at = 0.0;      ///< along the way, in [0, 1]
    float t = 0.0F;       ///< of the nearer surface, as in Sample
    /// Of a contour: how far behind it the other surface lies along the ray; infinite on
    /// background.
    float gap = std::numeric_limits<float>::infinity();
    float footprint = 0.0F;  ///< a pixel at that depth; both in scene units
    float turn = 0.0F;       ///< of a crease: of the normal, as the chord on the unit sphere

    /// Of contours and seams the caller must find out that no third surface is in front; where an
    /// end of the way is near the line, that it does not look into a slit: by a ray through this
    /// point.
    bool needs_check = false;
    Vec2f checked;
    float checked_at = -1.0F;  ///< the same along the way, if it lies on it
    /// Which end is so near to the line that it may look into a slit.
    enum class InSlit : std::uint8_t { none, first, second } in_slit = InSlit::none;
    /// It must hit one of these.
    std::uint32_t first_expected = 0, expected = 0;  ///< which, in the list that was given
    /// Past an end, another object than this one is as good; kNothing: none is.
    std::uint32_t unless_object = SurfaceKey::kNothing;
};

/// Where the check goes, in lengths of the way.
struct MeshChecks {
    float offset;  ///< beside a contour
    /// An end of the way that is nearer to a contour or crease than this may look into a slit
    /// between this line and another one: the check goes so far from the line, past that end, at a
    /// right angle. So far beyond it goes at an open edge, too, which may be one side of a slit.
    float slit;
};

/// A point of the screen and its neighbour, and what they see.
struct SeenPair {
    Vec2f from, to;
    SurfaceKey first, second;
    MeshChecks checks;
};

/// Finds the crossings of as many pairs, and adds to a list which surfaces checks may see.
using MeshCrossingFunction =
    std::function<void(std::span<const SeenPair> pairs, std::span<MeshCrossing> crossings,
                       std::vector<SurfaceKey>& expected)>;

}  // namespace ink
