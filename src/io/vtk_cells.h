#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <pugixml.hpp>

#include "io/polygon_mesh.h"
#include "io/vtk_arrays.h"

namespace ink {

/// A DataArray element.
VtkArray describe_vtk_array(const pugi::xml_node& node);

/// Appends the polygons of a piece of PolyData, or the plane cells of an UnstructuredGrid, to
/// `mesh`, as corners and ends of polygons. The piece has `points` points, of which the first is
/// vertex `first`. Returns how many other cells of more than a point there are. Throws InputError
/// where cells use points that are not there.
std::size_t add_vtk_cells(const pugi::xml_node& piece, const VtkEncoding& encoding,
                          std::size_t points, std::size_t first, const std::filesystem::path& file,
                          PolygonMesh& mesh);

}  // namespace ink
