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

/// Fills `corner_normals` with the angle-weighted mean of the geometric normals of those triangles
/// about the vertex that turn from the corner's own triangle by less than `crease_angle_deg`
/// (Thuermer and Wuethrich 1998); sharp edges stay sharp, round ones become smooth. About a vertex
/// of very many triangles, triangles whose normals differ by a degree or two are taken as one.
void smooth_normals(Mesh& mesh, float crease_angle_deg);

}  // namespace ink
