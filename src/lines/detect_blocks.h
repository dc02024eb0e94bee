#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/vec3_lanes.h"
#include "lines/detect.h"
#include "scene/ids.h"

namespace ink {

/// Samples of a lattice block by block, as rays travel together: lane i of a block is its point
/// (i % 4, i / 4).
struct SampleBlocks {
    static constexpr std::uint32_t kNothing = 0xFFFFFFFFU;

    int width = 0, height = 0;  ///< points
    int across = 0, down = 0;   ///< blocks, some of which may reach beyond the points
    /// Which packet a block has, row by row; kNothing where all is background.
    std::span<const std::uint32_t> packet_at;
    // Of each packet, as in SampleGrid:
    const Lanes<GeometryId>* ids;
    const Lanes<std::uint32_t>* surfaces;
    const Vec3Lanes* places;
    const Vec3Lanes* normals;
};

/// Finds the suspect edges between all neighbours, block by block. What comes on the right and
/// below of the last blocks is taken from theirs.
void detect(const SampleBlocks& blocks, const DetectSettings& settings,
            std::vector<SuspectEdge>& edges);

}  // namespace ink
