#pragma once

#include "io/reader.h"

namespace ink {

// One a file format family; reader.cpp lists them.
Reader pdb_reader();    ///< gemmi_reader.cpp
Reader mmcif_reader();  ///< gemmi_reader.cpp
Reader sdf_reader();    ///< sdf_reader.cpp
Reader xyz_reader();    ///< xyz_reader.cpp
Reader obj_reader();    ///< obj_reader.cpp
Reader ply_reader();    ///< ply_reader.cpp
Reader stl_reader();    ///< stl_reader.cpp

}  // namespace ink
