#pragma once

#include "io/reader.h"

namespace ink {

// One a file format family; reader.cpp lists them.
Reader pdb_reader();     ///< pdb_reader.cpp
Reader cif_reader();     ///< cif_reader.cpp: mmCIF and small-molecule CIF
Reader gro_reader();     ///< gro_reader.cpp
Reader mol2_reader();    ///< mol2_reader.cpp
Reader pqr_reader();     ///< pqr_reader.cpp
Reader sdf_reader();     ///< sdf_reader.cpp
Reader xyz_reader();     ///< xyz_reader.cpp
Reader table_reader();   ///< table_reader.cpp: CSV, TSV, columns between blanks
Reader lammps_reader();  ///< lammps_reader.cpp
Reader vtk_reader();     ///< vtk_reader.cpp: VTP and VTU
Reader bgeo_reader();    ///< bgeo_reader.cpp: Houdini's classic geometry
Reader uda_reader();     ///< uda_reader.cpp: archives of Uintah's, each a folder
Reader obj_reader();     ///< obj_reader.cpp
Reader ply_reader();     ///< ply_reader.cpp
Reader stl_reader();     ///< stl_reader.cpp
Reader off_reader();     ///< off_reader.cpp
Reader gltf_reader();    ///< gltf_reader.cpp

}  // namespace ink
