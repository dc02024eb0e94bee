#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/vec.h"
#include "scene/clip_box.h"
#include "scene/copies.h"
#include "scene/field.h"

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

/// Atoms in a row that are drawn once for each of `copies`; empty: once, where they are.
struct Unit {
    std::size_t first = 0, count = 0;
    std::vector<Copy> copies{};
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

    /// Of atoms that are copies themselves: which one, from 0, as Copy::number. Empty: all 0.
    std::vector<std::uint32_t> copy_numbers;
    std::vector<Unit> units;  ///< all atoms, in order; empty: they are drawn once, where they are

    std::size_t atom_count() const { return positions.size(); }
    std::size_t drawn_count() const;  ///< with all copies
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

/// What of the assembly lies in the box. What is copied by rigid motions stays there once, as units
/// with copies; copies that the box cuts, motions that stretch, and what is there once anyway
/// follow as atoms of their own.
Molecule assembled(const Molecule& molecule, const Assembly& assembly, const ClipBox& clip = {});

}  // namespace ink
