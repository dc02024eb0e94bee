#pragma once

#include <cstdint>

#include "base/lanes.h"
#include "lines/predict.h"

namespace ink {

/// What sixteen rays saw of spheres.
struct BallLanes {
    Lanes<float> x, y, z;  ///< centre, scene frame
    Lanes<float> radius;   ///< 0: the background
    Lanes<float> t;        ///< of the hit, as in Sample
};

/// Sixteen lattice edges between screen points a and b.
struct EdgeLanes {
    Lanes<float> ax, ay, bx, by;
    BallLanes first, second;
};

struct PredictionLanes {
    /// A Prediction::Kind, or one of those below.
    Lanes<std::int32_t> kind;
    Lanes<float> at, t, squared_radius;  ///< as in Prediction

    static constexpr std::int32_t kNone = -1;
    /// The seam is ambiguous: only `predict_crossing` finds it.
    static constexpr std::int32_t kSearch = -2;
};

/// `predict_crossing` for sixteen edges at once.
void predict_crossings(const Viewpoint& viewpoint, const EdgeLanes& edges,
                       PredictionLanes& predictions);

}  // namespace ink
