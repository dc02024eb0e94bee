#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/projection.h"
#include "render/face_map.h"
#include "render/nearest_edges.h"
#include "render/screen_vertices.h"
#include "scene/scene.h"

namespace ink {

/// The triangles of a face, one after the other in the mesh.
struct TriangleRange {
    std::uint32_t begin, end;
};

/// Lines between the faces of meshes need no search. Of all edges that are seen, the nearest to a
/// pixel is one of the face that the pixel sees, since the way to any other leaves that face first.
/// So the distance to it, in closed form, is all that there is to inking a pixel. Only near other
/// lines, where edges may be hidden, they are found as crossings, like those.
class FaceEdges {
  public:
    FaceEdges(const Projection& projection, const FaceMap& map, const ScreenVertices& vertices)
        : projection_(projection), map_(map), vertices_(vertices), table_(1024) {}

    /// Clears what was kept of the edges of the faces that were met so far.
    void begin();
    /// Edges within `reach`, pixels, of the 4 x 4 pixels at (x, y). False if there are none.
    bool measure(int x, int y, float reach, NearestEdges& nearest);

  private:
    /// A vertex of a mesh and where it is seen.
    struct Corner {
        Vec3f position;
        ScreenPoint seen;
    };
    struct Face {
        std::uint32_t key = FaceMap::kNone;  ///< its first triangle; kNone: free
        std::uint32_t first = 0, count = 0;  ///< in edges_
    };

    static TriangleRange triangles_of(const Mesh& mesh, std::uint32_t triangle);
    std::span<const ScreenEdge> edges_of(std::uint32_t first, FaceMap::Triangle seen,
                                         TriangleRange triangles);
    void collect(std::span<const ScreenEdge> edges, TriangleRange numbers, int x, int y,
                 float reach);
    void add_edges(std::uint32_t object, TriangleRange triangles);
    void add_edge(Corner a, Corner b);
    std::size_t place_of(std::uint32_t key) const;
    void grow();

    const Projection& projection_;
    const FaceMap& map_;
    const ScreenVertices& vertices_;
    std::vector<ScreenEdge> edges_;
    std::vector<FaceEdge> near_;  ///< of the faces that the block at hand sees
    std::vector<Face> table_;     ///< hashed by key
    std::size_t faces_ = 0;
    std::vector<std::uint64_t> directed_;  ///< edges of a face of several triangles, sorted
};

}  // namespace ink
