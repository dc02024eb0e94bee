#pragma once

#include <cstdint>
#include <vector>

#include "base/bounds.h"
#include "base/lanes.h"
#include "scene/scene.h"

namespace ink {

enum class ClusterKind : std::uint8_t { spheres, triangles };

/// Up to kLanes primitives of one object that lie close together.
struct Cluster {
    Bounds3f bounds;
    std::uint32_t object = 0;
    std::uint32_t first = 0;   ///< into Clusters::order
    std::uint32_t packet = 0;  ///< into the packets of its kind
    std::uint8_t count = 0;
    ClusterKind kind = ClusterKind::spheres;
};

/// Points in the scene frame. Unused lanes repeat the last one that is used.
struct Points {
    Lanes<float> x, y, z;
};

/// The primitives of a cluster side by side: to gather them from the scene each time takes longer
/// than all that is done with them.
struct SphereLanes {
    Points centre;
    Lanes<float> radius;
};
struct TriangleLanes {
    Points a, b, c;
};

/// The scene's spheres and triangles in clusters along a Morton curve, object by object, so that
/// clusters that follow each other are near each other too.
struct Clusters {
    std::vector<Cluster> clusters;
    std::vector<std::uint32_t> order;  ///< primitives, cluster by cluster
    std::vector<SphereLanes> spheres;
    std::vector<TriangleLanes> triangles;

    Clusters() = default;
    explicit Clusters(const Scene& scene);
};

}  // namespace ink
