#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "scene/mesh.h"

namespace ink {

/// 3 * triangle + k: the triangle's corner k, and its edge from there to the next corner.
using Corner = std::uint32_t;

constexpr Corner next(Corner c) { return c % 3 == 2 ? c - 2 : c + 1; }
constexpr Corner previous(Corner c) { return c % 3 == 0 ? c + 2 : c - 1; }

/// Which corners and edges of a welded mesh belong together.
class MeshTopology {
  public:
    static constexpr Corner kBoundary = Mesh::kNoTwin;
    static constexpr Corner kBranching = Mesh::kManyTwins;  ///< three or more triangles meet

    /// Linear in time and memory. Keeps a reference to `mesh`.
    explicit MeshTopology(const Mesh& mesh);

    std::uint32_t vertex(Corner corner) const { return mesh_->triangles[corner / 3][corner % 3]; }
    /// The corners that meet in a vertex, in ascending order.
    std::span<const Corner> about(std::size_t vertex) const {
        return std::span(corners_).subspan(begin_[vertex], begin_[vertex + 1] - begin_[vertex]);
    }
    /// The same edge in the other triangle, or kBoundary, or kBranching.
    Corner twin(Corner edge) const { return twins_[edge]; }
    /// The twins of all edges; nothing else may be asked of the topology afterwards.
    std::vector<Corner> take_twins() && { return std::move(twins_); }
    bool has_twin(Corner edge) const { return twins_[edge] < kBranching; }
    /// Whether the other triangle runs the edge in the same direction, so that its normal points to
    /// the other side of the surface.
    bool twin_is_flipped(Corner edge) const { return vertex(edge) == vertex(twins_[edge]); }

  private:
    void sort_corners();
    void match_edges();
    void match(std::span<const std::uint64_t> edges);

    const Mesh* mesh_;
    std::vector<std::uint32_t> begin_;  ///< a vertex: its first place in `corners_`; and the end
    std::vector<Corner> corners_;
    std::vector<Corner> twins_;
};

/// Whether the corners of a triangle lie neither in one place nor on one line.
bool has_area(const Mesh& mesh, const Mesh::Triangle& triangle);

/// A triangle's unit normal (0 without an area) and the angles at its corners, radians.
struct Facet {
    Vec3f normal;
    std::array<float, 3> angles{};
};

/// The facets of all triangles. The normal of a needle, a triangle so thin that rounded coordinates
/// leave its plane open, is that of the triangle across its longest edge.
std::vector<Facet> facets_of(const Mesh& mesh, const MeshTopology& topology);

/// Mesh::edge_flags. See CreaseSettings.
std::vector<std::uint8_t> classify_edges(const Mesh& mesh, const MeshTopology& topology,
                                         std::span<const Facet> facets,
                                         const CreaseSettings& settings);

/// The functions of mesh.h for a mesh whose topology is known. `stitch` makes a new one if it must,
/// `smooth_normals` leaves the twins where they are.
std::size_t stitch(Mesh& mesh, MeshTopology& topology, const StitchSettings& settings = {});
void smooth_normals(Mesh& mesh, const MeshTopology& topology, const CreaseSettings& settings = {});

}  // namespace ink
