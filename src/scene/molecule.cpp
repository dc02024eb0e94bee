#include "scene/molecule.h"

#include <cassert>

#include "base/parallel.h"
#include "scene/elements.h"

namespace ink {

namespace {

/// Atoms that are worth a task of their own.
constexpr std::size_t kGrain = 16384;

Spheres atom_spheres(const Molecule& molecule, const Frame& frame) {
    const std::size_t count = molecule.atom_count();
    const bool has_residues = !molecule.residues.empty();
    Spheres out;
    out.spheres.resize(count);
    out.colors.resize(count);
    if (has_residues) out.parts.resize(count);
    parallel_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Element& kind = element(molecule.elements[i]);
            out.spheres[i] = {frame.from_world(molecule.positions[i]), kind.vdw_radius};
            out.colors[i] = kind.color;
            if (has_residues) out.parts[i] = molecule.residue_table[molecule.residues[i]].chain;
        }
    });
    return out;
}

}  // namespace

Object space_filling(const Molecule& molecule) {
    assert(molecule.elements.size() == molecule.atom_count());
    assert(molecule.residues.empty() || molecule.residues.size() == molecule.atom_count());
    Object object;
    object.name = molecule.name;
    object.kind = ObjectKind::molecule;
    if (molecule.atom_count() > 0) object.frame.origin = molecule.positions.front();
    object.shape = atom_spheres(molecule, object.frame);
    if (!molecule.residues.empty()) object.part_names = molecule.chains;
    return object;
}

}  // namespace ink
