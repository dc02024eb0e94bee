#pragma once

#include <cstdint>
#include <span>

#include "base/lanes.h"
#include "lines/detect.h"
#include "lines/predict_lanes.h"
#include "sampling/samples.h"

namespace ink {

/// The balls that a grid's points see, where there is one set of them: ball k has ID `first` + k
/// and is primitive k of `object`.
struct BallTable {
    std::uint32_t object = 0;
    GeometryId first = kBackground;
    const float* balls = nullptr;  ///< four numbers each: centre, scene frame, and radius
};

/// What one end of sixteen edges saw, beside the balls themselves: IDs, and surfaces as
/// SurfaceKeys.
struct EdgeEnds {
    Lanes<GeometryId> id;
    Lanes<std::uint32_t> object, primitive;
};

/// Fills the lanes of up to sixteen edges from the grid's IDs and depths.
void find_edge_balls(const SampleGrid& grid, std::span<const SuspectEdge> edges,
                     const BallTable& table, EdgeLanes& lanes, EdgeEnds& first, EdgeEnds& second);

}  // namespace ink
