#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/vec.h"
#include "scene/scene.h"

namespace ink {

struct Residue {
    std::string name;  ///< "ALA"
    std::int32_t number = 0;
    std::uint32_t chain = 0;  ///< index into Molecule::chains
};

/// One frame of a molecule, as flat arrays of its atoms.
struct Molecule {
    std::string name;
    std::vector<Vec3d> positions;        ///< angstrom
    std::vector<std::uint8_t> elements;  ///< atomic numbers, 0: unknown
    std::vector<std::uint32_t>
        residues;  ///< an atom: index into `residue_table`; empty: none known
    std::vector<Residue> residue_table;
    std::vector<std::string> chains;

    std::size_t atom_count() const { return positions.size(); }
};

/// Each atom as a sphere of its van der Waals radius in its element's colour (Corey and Pauling
/// 1953). Parts are chains.
Object space_filling(const Molecule& molecule);

}  // namespace ink
