#pragma once

#include <cstdint>
#include <vector>

#include "lines/line_type.h"
#include "sampling/samples.h"

namespace ink {

/// Where a discontinuity may lie between two samples, and of which kind.
enum class Suspicion : std::uint8_t {
    none,
    id,     ///< the geometry ID differs
    depth,  ///< same ID, and a surface through both would not fit their normals
    normal  ///< same ID, same surface, and the normal turns by more than the crease angle
};

/// Thresholds of detection. None has a length in it: scaling scene and camera changes nothing.
struct DetectSettings {
    /// A surface that is smooth between two hits has their chord nearly at a right angle to the
    /// mean of their normals (exactly so on a sphere). Beyond this sine, a jump in depth is
    /// suspected; the bisection then tells a jump from a strong curve, so this only has to be low
    /// enough.
    float chord_sine = 0.06F;
    /// And the jump must be at least this deep, in scene units: a fifth of the distance between
    /// neighbouring rays, or the wrinkles of every mesh would be suspect.
    float least_jump = 0.0F;
    /// A turn of the normal below this cannot become a crease.
    float crease_cosine = 0.985F;  // 10 degrees
    bool depths = true;            ///< look for self-occlusions
    bool normals = true;           ///< look for creases
};

/// An edge of the lattice that a line may cross: from point (i, j) to its right or lower neighbour.
struct SuspectEdge {
    std::uint16_t i, j;  ///< of the grid
    bool down;
    Suspicion suspicion;
};

/// Finds the suspect edges between all neighbours on a grid, row by row, sixteen points at a time.
void detect(const SampleGrid& grid, const DetectSettings& settings,
            std::vector<SuspectEdge>& edges);

}  // namespace ink
