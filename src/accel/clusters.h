#pragma once

#include <cstdint>
#include <vector>

#include "base/bounds.h"
#include "base/lanes.h"
#include "scene/scene.h"

namespace ink {

enum class ClusterKind : std::uint8_t { spheres, triangles, solids, glyphs };

/// Of a cluster whose primitives are drawn where they are.
inline constexpr std::uint32_t kNoCopy = 0xFFFFFFFFU;

/// Up to kLanes primitives of one object that lie close together.
struct Cluster {
    std::uint32_t object = 0;
    std::uint32_t first = 0;       ///< into Clusters::order
    std::uint32_t packet = 0;      ///< into the packets of its kind
    std::uint32_t copy = kNoCopy;  ///< into Clusters::copies
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
/// Normals at their corners, packed.
struct CornerNormals {
    Lanes<std::uint32_t> a, b, c;
};
/// Triangles that faces of hexahedra are cut into.
struct SolidLanes {
    TriangleLanes triangles;
    Points normal;  ///< of the face, outward
};
struct GlyphLanes {
    Points origin, x_axis, y_axis, z_axis;
};

/// Where and as which primitives a cluster is drawn whose packet and order others use too.
struct ClusterCopy {
    Motion motion;
    std::uint32_t first_primitive = 0;  ///< that is numbered 0 in the first copy
};

/// Sixteen boxes, corner by corner.
struct BoxLanes {
    Points lower, upper;
};

/// Whether camera rays can be traced by what the screen shows of a shape.
bool has_screen_form(const Shape& shape);

/// The primitives of the scene's shapes with screen forms in clusters of neighbours along a Morton
/// curve, object by object, so that clusters that follow each other are near each other too, and a
/// tree of boxes above them. Copies have clusters and boxes of their own, and share all else.
struct Clusters {
    std::vector<Cluster> clusters;
    std::vector<std::uint32_t> order;  ///< primitives, cluster by cluster
    std::vector<SphereLanes> spheres;
    std::vector<TriangleLanes> triangles;
    std::vector<SolidLanes> solids;
    std::vector<GlyphLanes> glyphs;
    std::vector<ClusterCopy> copies;
    std::vector<UnitShape> unit_shapes;  ///< of objects that are glyphs; an entry an object
    /// Of packets of triangles, of objects whose entry in has_normals is not 0.
    std::vector<CornerNormals> corner_normals;
    std::vector<std::uint8_t> has_normals;

    /// Boxes of the clusters; then boxes whose lanes bound a packet of the level below each, up to
    /// a single packet.
    struct Level {
        std::vector<BoxLanes> boxes;
        std::size_t count = 0;  ///< boxes that are used
    };
    std::vector<Level> levels;

    Clusters() = default;
    explicit Clusters(const Scene& scene);
};

/// The primitives of a cluster where its copy is.
SphereLanes moved(const SphereLanes& spheres, const Motion& motion);
GlyphLanes moved(const GlyphLanes& glyphs, const Motion& motion);

}  // namespace ink
