#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/color.h"
#include "base/vec.h"
#include "io/reader.h"

namespace ink {

/// Whether a coordinate is finite and not beyond kLargestCoordinate.
bool is_usable_position(Vec3d position);

/// A mesh as its file gives it, before it is cut into triangles. Arrays of one entry a vertex or a
/// polygon are empty or complete.
struct PolygonMesh {
    std::string format;  ///< "OBJ", "binary STL"

    Vec3d origin;                  ///< the first vertex
    std::vector<Vec3f> positions;  ///< a vertex, from `origin`
    std::vector<Vec3f> normals;    ///< a vertex, of any length
    std::vector<Rgb8> colors;      ///< a vertex

    std::vector<std::uint32_t> corners;       ///< vertices of all polygons, one after another
    std::vector<std::uint32_t> polygon_ends;  ///< a polygon: the end of its corners
    std::vector<std::uint32_t> parts;         ///< a polygon: index into `part_names`
    std::vector<std::string> part_names;

    std::optional<Rgb8> color;
    std::vector<std::string> warnings;
    std::size_t faces_read = 0;     ///< by a library, before copies were made of them; 0: not known
    bool single_precision = false;  ///< coordinates were rounded to 32 bits before they came here

    /// False when the position cannot be used; then nothing is added.
    bool add_position(Vec3d position);
    void end_polygon() { polygon_ends.push_back(static_cast<std::uint32_t>(corners.size())); }
};

/// "bunny" for "scans/bunny.ply.gz".
std::string model_name(const std::filesystem::path& file);

/// The mesh as an object: triangulated, welded, with normals. Throws InputError where no face is
/// left or a face uses a vertex that is not there.
FileContents mesh_contents(const std::filesystem::path& file, PolygonMesh polygons);

}  // namespace ink
