#pragma once

#include <cstdint>
#include <vector>

#include "base/bounds.h"
#include "base/lanes.h"
#include "scene/scene.h"

namespace ink {

/// Up to kLanes primitives of one object that lie close together.
struct Cluster {
    Bounds3f bounds;
    std::uint32_t object = 0;
    std::uint32_t first = 0;  ///< into Clusters::order
    std::uint32_t count = 0;
};

/// The scene's spheres and triangles in clusters along a Morton curve, object by object, so that
/// clusters that follow each other are near each other too.
struct Clusters {
    std::vector<Cluster> clusters;
    std::vector<std::uint32_t> order;  ///< primitives, cluster by cluster

    Clusters() = default;
    explicit Clusters(const Scene& scene);
};

}  // namespace ink
