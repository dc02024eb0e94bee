#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/projection.h"
#include "render/face_map.h"
#include "scene/scene.h"

namespace ink {

/// For each of 4 x 4 pixels, the nearest edge of the face that it sees.
struct NearestEdges {
    Lanes<float> distance;  ///< from the pixel's centre, pixels; infinite where there is none
    Lanes<float> nx, ny;    ///< unit, across the edge
    Lanes<float> t;         ///< of the edge's middle, distance along the ray
    Lanes<std::uint32_t> triangle;  ///< that the pixel sees: see FaceMap
};

/// An edge on the screen: start, unit direction and length, pixels.
struct ScreenEdge {
    Vec2f a, along;
    float length;
    float t;  ///< of its middle, distance along the ray
};

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
    FaceEdges(const Projection& projection, const FaceMap& map)
        : projection_(projection), map_(map), table_(1024) {}

    /// Clears what was kept of the edges of the faces that were met so far.
    void begin();
    /// Edges within `reach`, pixels, of the 4 x 4 pixels at (x, y). False if there are none.
    bool measure(int x, int y, float reach, NearestEdges& nearest);

  private:
    struct Corner {
        Vec3d position;
        Vec2d point;   ///< pixels
        double depth;  ///< along the axis, scene units
        double width;  ///< of a pixel there, likewise
    };
    struct Face {
        std::uint32_t key = FaceMap::kNone;  ///< its first triangle; kNone: free
        std::uint32_t first = 0, count = 0;  ///< in edges_
    };

    static TriangleRange triangles_of(const Mesh& mesh, std::uint32_t triangle);
    std::span<const ScreenEdge> edges_of(std::uint32_t first, const Mesh& mesh,
                                         TriangleRange triangles);
    std::span<const ScreenEdge> near_edges(std::span<const ScreenEdge> edges, int x, int y,
                                           float reach);
    void add_edges(const Mesh& mesh, TriangleRange triangles);
    void add_edge(Corner a, Corner b);
    Corner project(const Vec3d& position) const;
    std::size_t place_of(std::uint32_t key) const;
    void grow();

    const Projection& projection_;
    const FaceMap& map_;
    std::vector<ScreenEdge> edges_, near_;
    std::vector<Face> table_;  ///< hashed by key
    std::size_t faces_ = 0;
    std::vector<std::uint64_t> directed_;  ///< edges of a face of several triangles, sorted
};

}  // namespace ink
