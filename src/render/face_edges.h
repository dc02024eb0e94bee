#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "accel/projection.h"
#include "render/face_map.h"
#include "render/nearest_edges.h"
#include "render/screen_vertices.h"
#include "render/tiles.h"
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
        : projection_(projection), map_(map), vertices_(vertices) {}

    /// Gathers the edges of all faces that the tile's pixels see: at once, since they lie scattered
    /// in memory, and the machine can wait for many of them at a time.
    void enter(const Tile& tile);
    /// Whether the 4 x 4 pixels at (x, y) of the tile see any face.
    bool sees(int x, int y) const {
        const std::size_t block = block_at(x, y);
        return begins_[block] < begins_[block + 1];
    }
    /// Edges within `reach`, pixels, of the 4 x 4 pixels at (x, y) of the tile. False if there are
    /// none.
    bool measure(int x, int y, float reach, NearestEdges& nearest);

  private:
    /// A vertex of a mesh, and where it is seen.
    struct Corner {
        std::uint32_t vertex;
        ScreenPoint seen;
    };
    /// A triangle that is seen somewhere in the tile.
    struct Seen {
        std::uint32_t number;  ///< over all meshes
        FaceMap::Triangle triangle;
        std::uint32_t listed_for;  ///< the last block that it was listed for
        std::uint32_t face = 0;
        Mesh::Triangle corners{};
    };
    struct Entry {
        std::uint32_t key = FaceMap::kNone;  ///< number of a triangle; kNone: free
        std::uint32_t value = 0;
    };
    using Table = std::vector<Entry>;  ///< hashed by key

    std::size_t block_at(int x, int y) const {
        return static_cast<std::size_t>((y - y0_) / kBlockSide * across_ + (x - x0_) / kBlockSide);
    }
    void list_triangles(const Tile& tile);
    void list(std::uint32_t number, std::uint32_t block);
    void gather_faces();
    std::uint32_t face_of(const Seen& seen);
    void prefetch(const Seen& seen) const;
    void list_directed(const Mesh& mesh, TriangleRange triangles);
    void add_edges(std::uint32_t object, std::uint32_t triangle, const Mesh::Triangle& corners);
    void add_edge(const Mesh& mesh, Corner a, Corner b);
    SeenFace near_part(SeenFace face, int x, int y, float reach);

    static Entry& entry(Table& table, std::uint32_t key);
    static void make_room(Table& table, std::size_t count);
    static TriangleRange triangles_of(const Mesh& mesh, std::uint32_t triangle);

    const Projection& projection_;
    const FaceMap& map_;
    const ScreenVertices& vertices_;
    int x0_ = 0, y0_ = 0, across_ = 0;   ///< of the tile; across: blocks
    std::vector<std::uint32_t> begins_;  ///< a block: where its triangles begin in listed_
    std::vector<std::uint32_t> listed_;  ///< of each block, each once: indices into seen_
    std::vector<Seen> seen_;
    Table triangles_;  ///< a triangle: index into seen_
    std::vector<SeenFace> faces_;
    Table polygons_;  ///< the first triangle of a face of several: index into faces_
    std::vector<ScreenEdge> edges_;
    std::size_t gathered_ = 0;             ///< of edges_; the rest is the block's at hand
    std::vector<SeenFace> here_;           ///< those that the block at hand sees
    std::vector<std::uint64_t> directed_;  ///< edges of a face of several triangles, sorted
};

}  // namespace ink
