#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "scene/molecule.h"

namespace ink {

/// Which atoms to draw, in the words that PyMOL and ChimeraX share:
///
///     chain A and not water            protein or resn HEM+FE
///     resi 10-20+35 and name CA+CB     not hydrogens and bfactor < 40
///
/// `and`, `or`, `not` (also `&`, `|`, `!`) and brackets; `not` binds strongest, then `and`.
/// Alone: all, none, protein, nucleic, polymer, water (solvent), ligand (organic), ions
/// (inorganic), hydrogens (hydro), backbone, sidechain. With names joined by `+` or `,`: chain,
/// resn, resi (with ranges), name, elem, entity. A field with <, <=, >, >=, = and a number.
class Selection {
  public:
    /// Throws UsageError with what is wrong and what is allowed.
    static Selection parse(std::string_view text);

    /// An entry an atom, 1: selected. Throws Error where a field is not there.
    std::vector<std::uint8_t> evaluate(const Molecule& molecule) const;

    struct Node;

  private:
    explicit Selection(std::shared_ptr<const Node> root) : root_(std::move(root)) {}
    std::shared_ptr<const Node> root_;
};

}  // namespace ink
