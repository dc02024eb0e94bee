#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/vec.h"

namespace ink {

/// How the arrays of a VTK XML file are written, as its first element says.
struct VtkEncoding {
    bool big_endian = false;
    bool wide_headers = false;  ///< UInt64, else UInt32
    bool compressed = false;    ///< zlib, in blocks
    std::string_view appended;  ///< the data after "_"; empty: none
    bool appended_base64 = false;
};

/// One DataArray element.
struct VtkArray {
    std::string name;
    std::string type;    ///< "Float32", "Int64", ...
    std::string format;  ///< "ascii", "binary" or "appended"
    std::size_t components = 1;
    std::size_t offset = 0;  ///< of appended data
    std::string_view text;   ///< of ascii and binary data
};

/// Whether the type is one of numbers that can be read.
bool is_vtk_number(std::string_view type);

/// The numbers of an array, of which there must be `count`; more are left out. Throws InputError
/// where there are fewer, or the data are damaged. Memory is set aside only for what the file's
/// bytes can hold.
std::vector<float> read_vtk_array(const VtkArray& array, const VtkEncoding& encoding,
                                  std::size_t count, const std::filesystem::path& file);
/// The same in full precision.
std::vector<double> read_vtk_doubles(const VtkArray& array, const VtkEncoding& encoding,
                                     std::size_t count, const std::filesystem::path& file);
/// The same, three numbers a point, behind the positions that are there.
void append_vtk_points(const VtkArray& array, const VtkEncoding& encoding, std::size_t points,
                       const std::filesystem::path& file, std::vector<Vec3f>& positions);

}  // namespace ink
