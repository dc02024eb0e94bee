#pragma once

#include <vector>

#include "scene/molecule.h"

namespace ink {

/// Bonds between atoms that lie nearer than the sum of their covalent radii and 0.45 angstrom, and
/// not nearer than 0.4 (the rule of Meng and Lewis 1991, with the radii of Cordero 2008); two
/// hydrogens have none. In order. Time and memory are linear in the number of atoms, whatever their
/// places: of atoms that crowd together, only so many neighbours are looked at.
std::vector<Bond> bonds_by_distance(const Molecule& molecule);

}  // namespace ink
