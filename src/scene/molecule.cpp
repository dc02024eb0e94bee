#include "scene/molecule.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ink {

AtomName atom_name(std::string_view text) {
    AtomName name{};
    std::ranges::copy(text.substr(0, name.size()), name.begin());
    return name;
}

std::string_view to_text(const AtomName& name) {
    const auto* const end = std::ranges::find(name, '\0');
    return {name.data(), static_cast<std::size_t>(end - name.begin())};
}

namespace {

/// Appends the atoms of `from` that `keep` names, in order.
template <class T>
void append_kept(const std::vector<T>& from, const std::vector<std::uint8_t>& keep,
                 std::size_t width, std::vector<T>& into) {
    if (from.empty()) return;
    for (std::size_t i = 0; i < keep.size(); ++i) {
        if (keep[i] == 0) continue;
        const auto begin = from.begin() + static_cast<std::ptrdiff_t>(i * width);
        into.insert(into.end(), begin, begin + static_cast<std::ptrdiff_t>(width));
    }
}

constexpr std::uint32_t kGone = std::numeric_limits<std::uint32_t>::max();

/// Appends bonds whose ends are both kept; `first` is the first of the appended atoms.
void append_bonds(const Molecule& from, const std::vector<std::uint8_t>& keep, std::uint32_t first,
                  Molecule& into) {
    if (from.bonds.empty()) return;
    std::vector<std::uint32_t> place(keep.size(), kGone);
    std::uint32_t next = first;
    for (std::size_t i = 0; i < keep.size(); ++i) {
        if (keep[i] != 0) place[i] = next++;
    }
    for (const Bond& bond : from.bonds) {
        if (place[bond.a] == kGone || place[bond.b] == kGone) continue;
        into.bonds.push_back({place[bond.a], place[bond.b]});
    }
}

void append_atoms(const Molecule& from, const std::vector<std::uint8_t>& keep, Molecule& into) {
    const auto first = static_cast<std::uint32_t>(into.atom_count());
    append_kept(from.positions, keep, 1, into.positions);
    append_kept(from.elements, keep, 1, into.elements);
    append_kept(from.atom_names, keep, 1, into.atom_names);
    append_kept(from.residues, keep, 1, into.residues);
    append_kept(from.radii, keep, 1, into.radii);
    for (std::size_t f = 0; f < from.fields.size(); ++f) {
        append_kept(from.fields[f].values, keep, from.fields[f].components, into.fields[f].values);
    }
    append_bonds(from, keep, first, into);
}

/// The tables, without atoms.
Molecule without_atoms(const Molecule& from) {
    Molecule out;
    out.name = from.name;
    for (const Field& field : from.fields) out.fields.push_back({field.name, field.components, {}});
    out.residue_table = from.residue_table;
    out.chains = from.chains;
    out.asyms = from.asyms;
    out.entities = from.entities;
    out.has_bond_table = from.has_bond_table;
    return out;
}

/// Which atoms belong to the chains that are copied.
std::vector<std::uint8_t> copied_atoms(const Molecule& molecule, const Assembly::Copies& copies) {
    if (copies.asyms.empty() || molecule.residues.empty()) {
        return std::vector<std::uint8_t>(molecule.atom_count(), 1);
    }
    std::vector<std::uint8_t> wanted;
    for (const std::string& asym : molecule.asyms) {
        wanted.push_back(std::ranges::find(copies.asyms, asym) != copies.asyms.end() ? 1 : 0);
    }
    std::vector<std::uint8_t> keep(molecule.atom_count());
    for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = wanted[molecule.residue(i)->asym];
    return keep;
}

}  // namespace

Molecule filtered(const Molecule& molecule, const std::vector<std::uint8_t>& keep) {
    Molecule out = without_atoms(molecule);
    append_atoms(molecule, keep, out);
    return out;
}

std::size_t atom_count(const Molecule& molecule, const Assembly& assembly) {
    std::size_t count = 0;
    for (const Assembly::Copies& copies : assembly.copies) {
        const auto keep = copied_atoms(molecule, copies);
        count += static_cast<std::size_t>(std::ranges::count(keep, 1)) * copies.motions.size();
    }
    return count;
}

namespace {

/// Gives the atoms from `first_atom` on residues and chains of their own, as copy `copy` of what
/// they are copied from.
void rename_copy(const Molecule& from, std::size_t first_atom, std::size_t copy, Molecule& into) {
    if (into.residues.empty()) return;
    const auto first_residue = static_cast<std::uint32_t>(into.residue_table.size());
    const auto first_chain = static_cast<std::uint32_t>(into.chains.size());
    for (Residue residue : from.residue_table) {
        residue.chain += first_chain;
        into.residue_table.push_back(std::move(residue));
    }
    for (const std::string& chain : from.chains) {
        into.chains.push_back(fmt::format("{}-{}", chain, copy));
    }
    for (std::size_t i = first_atom; i < into.residues.size(); ++i) {
        into.residues[i] += first_residue;
    }
}

/// Whether lengths stay what they are, but for the digits that files round to.
bool is_rigid(const Motion& motion) {
    constexpr double kRounding = 1e-4;
    const auto row = [&](std::size_t k) {
        return Vec3d{motion.rotation[3 * k], motion.rotation[3 * k + 1],
                     motion.rotation[3 * k + 2]};
    };
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = i; k < 3; ++k) {
            if (!(std::abs(dot(row(i), row(k)) - (i == k ? 1.0 : 0.0)) < kRounding)) return false;
        }
    }
    return true;
}

}  // namespace

bool is_repetition(const Assembly& assembly) {
    return assembly.copies.size() == 1 && assembly.copies.front().motions.size() > 1 &&
           std::ranges::all_of(assembly.copies.front().motions, is_rigid);
}

Molecule repeated(const Molecule& molecule, const Assembly& assembly) {
    const Assembly::Copies& copies = assembly.copies.front();
    Molecule out = filtered(molecule, copied_atoms(molecule, copies));
    out.copies = copies.motions;
    return out;
}

Molecule assembled(const Molecule& molecule, const Assembly& assembly) {
    Molecule out = without_atoms(molecule);
    std::size_t most_motions = 0;
    for (const auto& copies : assembly.copies) {
        most_motions = std::max(most_motions, copies.motions.size());
    }
    for (std::size_t k = 0; k < most_motions; ++k) {
        const std::size_t first_of_copy = out.atom_count();
        for (const Assembly::Copies& copies : assembly.copies) {
            if (k >= copies.motions.size()) continue;
            const std::size_t first = out.atom_count();
            append_atoms(molecule, copied_atoms(molecule, copies), out);
            for (std::size_t i = first; i < out.atom_count(); ++i) {
                out.positions[i] = copies.motions[k](out.positions[i]);
            }
        }
        if (k > 0) rename_copy(molecule, first_of_copy, k + 1, out);
    }
    return out;
}

}  // namespace ink
