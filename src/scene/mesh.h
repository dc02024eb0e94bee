#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/color.h"
#include "base/vec.h"

namespace ink {

/// Triangles that share their corners. Optional arrays are empty or complete.
struct Mesh {
    using Triangle = std::array<std::uint32_t, 3>;  ///< indices into `vertices`

    std::vector<Vec3f> vertices;  ///< in the frame of the object or scene that holds the mesh
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> faces;  ///< a triangle: the polygon it was cut from; else itself
    std::vector<std::uint32_t> parts;  ///< a triangle: index into the object's `part_names`
    std::vector<Rgb8> colors;          ///< a vertex: instead of the material's

    /// Shading normals, one a corner of each triangle, octahedrally packed (pack_normal); empty:
    /// flat. Kept by corner, not by vertex, so that a crease needs no split vertex.
    std::vector<std::array<std::uint32_t, 3>> corner_normals;
    /// Normals that creases are found by, packed likewise; empty: the same as `corner_normals`.
    /// Normals of a file may run smoothly over its sharpest edges.
    std::vector<std::array<std::uint32_t, 3>> line_normals;

    /// A triangle: bit k is set if its edge from corner k to the next is a boundary of the surface,
    /// bit 3 + k if it is a crease, that is, if normals are discontinuous across it.
    std::vector<std::uint8_t> edge_flags;
    static constexpr unsigned kBoundaryEdge = 1;
    static constexpr unsigned kCreaseEdge = 1 << 3;

    /// An edge, 3 * triangle + k: the same edge in the other triangle, or kNoTwin where there is
    /// none, or kManyTwins where three or more triangles meet.
    std::vector<std::uint32_t> twins;
    static constexpr std::uint32_t kNoTwin = 0xFFFFFFFFU;
    static constexpr std::uint32_t kManyTwins = kNoTwin - 1;

    bool is_boundary(std::size_t triangle, std::size_t edge) const {
        return (edge_flags[triangle] & kBoundaryEdge << edge) != 0;
    }
    bool is_crease(std::size_t triangle, std::size_t edge) const {
        return (edge_flags[triangle] & kCreaseEdge << edge) != 0;
    }
};

/// Unit vector to 2 x 16 bits and back, within 7e-5 rad, exact along the axes: octahedral mapping,
/// Cigolle et al., A Survey of Efficient Representations for Independent Unit Vectors, JCGT 2014.
/// u is in the low half; u - 32767 and v - 32767 are x and y on an octahedron of radius 32767.
std::uint32_t pack_normal(Vec3f unit);
Vec3f unpack_normal(std::uint32_t packed);

/// Merges vertices at bitwise equal positions (STL and flat-shaded files repeat them; 0 equals -0),
/// drops triangles without area and vertices without a triangle. Vertices are renumbered in the
/// order of their first use and keep the first of their colours; `faces` keeps its values. Returns
/// how many triangles were dropped. Linear in time and memory.
std::size_t weld(Mesh& mesh);

/// How near two corners on open edges must be to be one.
struct StitchSettings {
    /// Of the shortest edge at either corner: what is farther apart is of the shape.
    float share_of_edge = 0.1F;
    /// And of the mesh's diagonal: a tenth of a pixel where it fills a picture of 1000 pixels.
    float share_of_size = 1e-4F;
};

/// Closes the seams of a welded mesh: CAD programs cut each face of a body into triangles on its
/// own, and round the corners along their common edge differently. Moves pairs of corners on open
/// edges of one part, each of which is the other's nearest, to one place, and welds again. Returns
/// how many were moved. A closed mesh costs one look at its triangles.
std::size_t stitch(Mesh& mesh, const StitchSettings& settings = {});

/// Which edges of a mesh are creases of the shape that it stands for: those where the surface turns
/// sharply, and those where it turns by more than the round surface about them does. Edges inside a
/// polygon are none. The numbers were chosen by looking at CAD parts (fandisk, plates with holes, a
/// gearbox), where every edge must show, at scans (bunny, armadillo), where what turns sharply is
/// noise, and at round shapes cut into few sides.
struct CreaseSettings {
    float sharp_deg = 40.0F;  ///< always a crease from here on: round shapes of 9 sides stay round
    float min_deg = 10.0F;    ///< never a crease below; lines begin at the same angle
    /// In between, a crease turns by more than this times its surroundings. Edges of a round shape
    /// cut evenly turn as much as their surroundings do; 2 leaves room for uneven cutting.
    float isolation = 2.0F;

    /// Connected creases that reach over this share of the diagonal of their piece of the mesh (an
    /// assembly has many pieces) are kept: groups of noise in scans reach up to 0.14, long lines of
    /// CAD parts 0.4 and more.
    float line_extent = 0.15F;
    /// Shorter ones are kept if they are so many and without a loose end: creases of a shape close
    /// up or end at the rim of the surface. Noise that does so is a spike of a triangle or two,
    /// with 3 or 5 edges around it; a hole in a plate has more sides.
    std::uint32_t closed_edges = 6;
    /// A piece of fewer triangles is drawn by hand and has no noise.
    std::size_t fine_triangles = 500;
};

/// Classifies the edges (`edge_flags`), pairs them (`twins`) and computes normals that are
/// continuous across every edge but boundaries and creases: the angle-weighted mean (Thuermer and
/// Wuethrich 1998) over the triangles about a vertex that can be reached without crossing one. They
/// become the `line_normals` of a mesh that has `corner_normals` already, else its
/// `corner_normals`. The mesh must be welded. Linear in time and memory.
void smooth_normals(Mesh& mesh, const CreaseSettings& settings = {});

}  // namespace ink
