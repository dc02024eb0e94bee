#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/vec.h"
#include "scene/field.h"
#include "scene/motion.h"

namespace ink {

enum class ResidueKind : std::uint8_t { protein, nucleic, water, ion, other };

struct Residue {
    std::string name = {};  ///< "ALA"
    std::int32_t number = 0;
    std::uint32_t chain = 0;   ///< index into Molecule::chains
    std::uint32_t asym = 0;    ///< index into Molecule::asyms
    std::uint32_t entity = 0;  ///< index into Molecule::entities
    ResidueKind kind = ResidueKind::other;
};

/// The name of an atom, "CA", padded with zeros; longer names are cut.
using AtomName = std::array<char, 6>;
AtomName atom_name(std::string_view text);
std::string_view to_text(const AtomName& name);

struct Bond {
    std::uint32_t a, b;  ///< atoms, a < b
    friend constexpr bool operator==(Bond, Bond) = default;
    friend constexpr auto operator<=>(Bond, Bond) = default;
};

/// One frame of a molecule, as flat arrays of its atoms. Arrays of one entry an atom are complete
/// or, but for the first two, empty.
struct Molecule {
    std::string name;
    std::vector<Vec3d> positions;        ///< angstrom
    std::vector<std::uint8_t> elements;  ///< atomic numbers, 0: unknown
    std::vector<AtomName> atom_names;
    std::vector<std::uint32_t> residues;  ///< index into `residue_table`
    std::vector<float> radii;             ///< angstrom, > 0, where the file gives them
    std::vector<Field> fields;            ///< "bfactor", "charge", ...

    std::vector<Residue> residue_table;
    std::vector<std::string> chains;    ///< as the authors name them
    std::vector<std::string> asyms;     ///< as assemblies name them; in PDB files the chains
    std::vector<std::string> entities;  ///< chains and ligands of one kind are one entity

    std::vector<Bond> bonds;      ///< that the file gives
    bool has_bond_table = false;  ///< else bonds are found by distance

    /// All atoms are drawn once for each of these, by which they are moved; empty: once.
    std::vector<Motion> copies;

    std::size_t atom_count() const { return positions.size(); }
    const Residue* residue(std::size_t atom) const {
        return residues.empty() ? nullptr : &residue_table[residues[atom]];
    }
};

/// The molecule with only the atoms whose entry in `keep` is not 0, and the bonds between them.
/// Tables of residues and chains stay as they are.
Molecule filtered(const Molecule& molecule, const std::vector<std::uint8_t>& keep);

/// A biological assembly: groups of chains, each with the motions that it is copied by.
struct Assembly {
    struct Copies {
        std::vector<std::string> asyms;  ///< empty: all
        std::vector<Motion> motions;
    };
    std::string name;
    std::vector<Copies> copies;
};

/// Atoms that the assembly has.
std::size_t atom_count(const Molecule& molecule, const Assembly& assembly);

/// Whether all that the assembly copies is copied by the same motions, several of them, which are
/// rigid: then it can be drawn as copies of what is stored once.
bool is_repetition(const Assembly& assembly);
/// The chains of such an assembly, with its motions as their copies.
Molecule repeated(const Molecule& molecule, const Assembly& assembly);

/// All copies as one molecule; chains of the second copy on are named "A-2", "A-3", ...
Molecule assembled(const Molecule& molecule, const Assembly& assembly);

}  // namespace ink
