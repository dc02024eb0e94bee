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
    append_kept(from.copy_numbers, keep, 1, into.copy_numbers);
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

/// Chains that are copied by the same motions together, so that they are one unit.
std::vector<Assembly::Copies> merged(const std::vector<Assembly::Copies>& groups) {
    std::vector<Assembly::Copies> out;
    for (const Assembly::Copies& group : groups) {
        const auto same = std::ranges::find(out, group.motions, &Assembly::Copies::motions);
        if (same == out.end()) {
            out.push_back(group);
        } else if (same->asyms.empty() || group.asyms.empty()) {
            same->asyms.clear();
        } else {
            same->asyms.insert(same->asyms.end(), group.asyms.begin(), group.asyms.end());
        }
    }
    return out;
}

/// Appends the atoms that `keep` names where copy `number` of them is.
void append_copy(const Molecule& from, const std::vector<std::uint8_t>& keep, const Copy& copy,
                 Molecule& into) {
    const std::size_t first = into.atom_count();
    append_atoms(from, keep, into);
    for (std::size_t i = first; i < into.atom_count(); ++i) {
        into.positions[i] = copy.motion(into.positions[i]);
    }
    into.copy_numbers.resize(into.atom_count(), copy.number);
}

/// Which atoms of a copy lie in the box.
std::vector<std::uint8_t> inside(const Molecule& molecule, const Motion& motion,
                                 const ClipBox& clip) {
    std::vector<std::uint8_t> keep(molecule.atom_count());
    for (std::size_t i = 0; i < keep.size(); ++i) {
        keep[i] = clip.holds(motion(molecule.positions[i])) ? 1 : 0;
    }
    return keep;
}

/// The copies of a group that can be a unit: rigid ones that lie in the box, if there are several.
std::vector<Copy> whole_copies(const Molecule& chains, const std::vector<Motion>& motions,
                               const ClipBox& clip) {
    std::vector<Copy> whole;
    for (std::size_t k = 0; k < motions.size(); ++k) {
        const auto is_inside = [&](Vec3d p) { return clip.holds(motions[k](p)); };
        if (is_rigid(motions[k]) &&
            (clip.everything() || std::ranges::all_of(chains.positions, is_inside))) {
            whole.push_back({motions[k], static_cast<std::uint32_t>(k)});
        }
    }
    if (whole.size() == 1) whole.clear();
    return whole;
}

/// Appends the copies of one group: those that are no unit go into `apart`.
void append_group(const Molecule& chains, const std::vector<Motion>& motions, const ClipBox& clip,
                  Molecule& units, Molecule& apart) {
    std::vector<Copy> whole = whole_copies(chains, motions, clip);
    for (std::size_t k = 0; k < motions.size(); ++k) {
        const Copy copy{motions[k], static_cast<std::uint32_t>(k)};
        if (std::ranges::find(whole, copy.number, &Copy::number) != whole.end()) continue;
        append_copy(chains, inside(chains, copy.motion, clip), copy, apart);
    }
    if (whole.empty()) return;
    units.units.push_back({units.atom_count(), chains.atom_count(), std::move(whole)});
    append_atoms(chains, std::vector<std::uint8_t>(chains.atom_count(), 1), units);
}

}  // namespace

std::size_t Molecule::drawn_count() const {
    std::size_t count = units.empty() ? atom_count() : 0;
    for (const Unit& unit : units) {
        count += unit.count * std::max<std::size_t>(unit.copies.size(), 1);
    }
    return count;
}

Molecule assembled(const Molecule& molecule, const Assembly& assembly, const ClipBox& clip) {
    Molecule out = without_atoms(molecule);
    Molecule apart = without_atoms(molecule);
    for (const Assembly::Copies& group : merged(assembly.copies)) {
        const Molecule chains = filtered(molecule, copied_atoms(molecule, group));
        if (chains.atom_count() > 0) append_group(chains, group.motions, clip, out, apart);
    }
    if (apart.atom_count() == 0) return out;
    if (out.units.empty()) return apart;
    out.units.push_back({out.atom_count(), apart.atom_count()});
    out.copy_numbers.resize(out.atom_count());
    append_atoms(apart, std::vector<std::uint8_t>(apart.atom_count(), 1), out);
    return out;
}

}  // namespace ink
