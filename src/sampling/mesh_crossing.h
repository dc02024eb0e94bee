#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "base/vec.h"
#include "sampling/surface_key.h"

namespace ink {

/// What lies on the way from a point of the screen, the first, to its neighbour, the second, each
/// of which sees a mesh or the background, by the shape of the meshes alone.
struct MeshCrossing {
    enum class Kind : std::uint8_t {
        unknown,      ///< the meshes do not tell
        smooth,       ///< one surface, without a crease
        crease,       ///< one surface, and the sharpest of the creases on the way
        first_limb,   ///< the first surface ends there, before the second or the background
        second_limb,  ///< the second surface ends there, before the first or the background
        seam          ///< two surfaces pass through each other there
    };
    Kind kind = Kind::unknown;
    bool at_rim = false;  ///< of a limb: the surface ends at an open edge; else it turns away
    double at = 0.0;      ///< along the way, in [0, 1]
    float t = 0.0F;       ///< of the nearer surface, as in Sample
    /// Of a limb: how far behind it the other surface lies along the ray; infinite on background.
    float gap = std::numeric_limits<float>::infinity();
    float footprint = 0.0F;  ///< a pixel at that depth; both in scene units
    float turn = 0.0F;       ///< of a crease: of the normal, as the chord on the unit sphere

    /// Limbs and seams: that no third surface is in front is for the caller to find out, by a ray
    /// at this place of the way, which may lie beyond its end. It must hit one of these.
    float checked_at = 0.0F;
    std::uint32_t first_expected = 0, expected = 0;  ///< which, in the list that was given
    /// Beyond the end, another object than this one is as good; kNothing: none is.
    std::uint32_t unless_object = SurfaceKey::kNothing;
};

/// Where the check goes, in lengths of the way.
struct MeshChecks {
    float offset;  ///< beside a limb
    /// Where an open edge, or a limb near the end of the way, may be one side of a slit that is
    /// narrower than this, beyond it.
    float slit;
};

/// Finds the crossing between two points, and adds to a list which surfaces a check may see.
using MeshCrossingFunction =
    std::function<MeshCrossing(Vec2f from, SurfaceKey first, Vec2f to, SurfaceKey second,
                               const MeshChecks& checks, std::vector<SurfaceKey>& expected)>;

}  // namespace ink
