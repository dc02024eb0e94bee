#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/molecule.h"

namespace ink {

/// Bonds between atoms that lie nearer than the sum of their covalent radii and 0.45 angstrom, and
/// not nearer than 0.4 (the rule of Meng and Lewis 1991, with the radii of Cordero 2008); two
/// hydrogens have none. In order. Time and memory are linear in the number of atoms, whatever their
/// places: of atoms that crowd together, only so many neighbours are looked at.
std::vector<Bond> bonds_by_distance(std::span<const Vec3d> positions,
                                    std::span<const std::uint8_t> elements);

/// A bond between two copies of a molecule's units, or of two units.
struct CopyBond {
    struct End {
        std::uint32_t unit = 0;  ///< into Molecule::units
        std::uint32_t atom = 0;  ///< of all that its copies have, numbered copy by copy
        friend constexpr auto operator<=>(End, End) = default;
    };
    End a, b;  ///< a < b
    friend constexpr auto operator<=>(CopyBond, CopyBond) = default;
};

/// By the same rule, and in order. Memory does not grow with the number of copies.
std::vector<CopyBond> bonds_between_copies(const Molecule& molecule);

}  // namespace ink
