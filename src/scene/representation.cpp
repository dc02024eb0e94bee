#include "scene/representation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "scene/atom_colors.h"
#include "scene/elements.h"
#include "scene/sticks.h"

namespace ink {

namespace {

/// Atoms that are worth a task of their own.
constexpr std::size_t kGrain = 16384;

// ---- Radii ----

/// Of balls in ball-and-stick models, as ChimeraX draws them.
constexpr float kBallScale = 0.25F;

std::vector<float> atom_radii(const Molecule& molecule, const DataSettings& settings) {
    const std::size_t count = molecule.atom_count();
    if (const auto uniform = uniform_radius(settings.radius)) {
        return std::vector<float>(count, static_cast<float>(*uniform));
    }
    if (!settings.radius.empty()) {
        std::vector<float> radii = atom_field(molecule, settings.radius);
        if (radii.size() != count) refuse_field("radius", settings.radius, "a number", molecule);
        for (const float radius : radii) {
            if (radius > 0.0F && std::isfinite(radius)) continue;
            throw Error(fmt::format("--radius: field '{}' is {} for an atom; a radius is positive",
                                    settings.radius, radius));
        }
        return radii;
    }
    if (settings.representation == Representation::sticks) {
        return std::vector<float>(count, static_cast<float>(stick_radius(settings)));
    }
    std::vector<float> radii = molecule.radii;
    if (radii.empty()) {
        radii.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            radii[i] = atom_radius(settings.radii, molecule.elements[i]);
        }
    }
    if (settings.representation == Representation::ball_and_stick) {
        for (float& radius : radii) radius *= kBallScale;
    }
    return radii;
}

// ---- Parts ----

struct Parts {
    std::vector<std::uint32_t> of_atom;
    std::vector<std::string> names;
    bool own_a_copy = false;              ///< copies of a molecule have parts of their own
    std::vector<std::uint32_t> wholes{};  ///< see Object
};

std::vector<std::string> residue_names(const Molecule& molecule) {
    std::vector<std::string> names;
    for (const Residue& residue : molecule.residue_table) {
        names.push_back(
            fmt::format("{}/{} {}", molecule.chains[residue.chain], residue.name, residue.number));
    }
    return names;
}

Parts element_parts(const Molecule& molecule) {
    Parts parts;
    parts.of_atom.assign(molecule.elements.begin(), molecule.elements.end());
    for (std::size_t z = 0; z < kElementCount; ++z) {
        parts.names.emplace_back(element(static_cast<std::uint8_t>(z)).symbol);
    }
    return parts;
}

template <class Index>
std::vector<std::uint32_t> by_residue(const Molecule& molecule, const Index& index) {
    std::vector<std::uint32_t> parts(molecule.atom_count());
    for (std::size_t i = 0; i < parts.size(); ++i) parts[i] = index(*molecule.residue(i));
    return parts;
}

Parts parts_of_originals(const Molecule& molecule, const DataSettings& settings) {
    const bool by_residue_itself =
        settings.by_residue && settings.parts.empty() && !molecule.residues.empty();
    const std::string level = by_residue_itself ? "residue" : settings.parts;
    if (level == "element") return element_parts(molecule);
    if (molecule.residues.empty()) {
        if (level.empty()) return {};
        throw Error(fmt::format(
            "--ids: part:{}: the file names no residues or chains; expected part:element", level));
    }
    if (level.empty() || level == "chain") {
        return {by_residue(molecule, [](const Residue& r) { return r.chain; }), molecule.chains,
                true};
    }
    if (level == "residue") {
        Parts parts{molecule.residues, residue_names(molecule), true};
        for (const Residue& residue : molecule.residue_table) parts.wholes.push_back(residue.chain);
        return parts;
    }
    if (level == "entity") {
        return {by_residue(molecule, [](const Residue& r) { return r.entity; }), molecule.entities};
    }
    throw Error(
        fmt::format("--ids: part:{}: expected part:chain, residue, entity or element", level));
}

Parts atom_parts(const Molecule& molecule, const DataSettings& settings) {
    Parts parts = parts_of_originals(molecule, settings);
    if (!parts.own_a_copy || molecule.copy_numbers.empty()) return parts;
    for (std::size_t i = 0; i < parts.of_atom.size(); ++i) {
        parts.of_atom[i] +=
            molecule.copy_numbers[i] * static_cast<std::uint32_t>(parts.names.size());
    }
    return parts;
}

// ---- Objects ----

/// The entries of one unit, of which none is needed again.
template <class T>
std::vector<T> taken(std::vector<T>& all, const Unit& unit) {
    if (all.empty() || unit.count == all.size()) return std::move(all);
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(unit.first);
    return {begin, begin + static_cast<std::ptrdiff_t>(unit.count)};
}

/// The units of a molecule as objects of atoms.
class AtomObjects {
  public:
    AtomObjects(const Molecule& molecule, const DataSettings& settings)
        : molecule_(molecule),
          radii_(atom_radii(molecule, settings)),
          elements_(molecule.elements),
          coloring_(color_atoms(molecule, settings)),
          parts_(atom_parts(molecule, settings)) {
        common_.name = molecule.name;
        common_.kind = ObjectKind::molecule;
        if (molecule.atom_count() > 0) common_.frame.origin = molecule.positions.front();
        common_.part_names = parts_.names;
        common_.part_wholes = parts_.wholes;
        if (settings.by_residue && !parts_.wholes.empty()) common_.usual_ids = IdLevel::part;
        if (settings.representation == Representation::sticks) common_.usual_ids = IdLevel::object;
    }

    Object make(const Unit& unit) {
        Object object = common_;
        object.color_scale = std::exchange(coloring_.scale, std::nullopt);
        object.elements = taken(elements_, unit);
        Spheres shape;
        shape.spheres.resize(unit.count);
        parallel_ranges(unit.count, kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                shape.spheres[i] = {object.frame.from_world(molecule_.positions[unit.first + i]),
                                    radii_[unit.first + i]};
            }
        });
        shape.colors = taken(coloring_.colors, unit);
        shape.parts = taken(parts_.of_atom, unit);
        shape.copies = unit.copies;
        for (Copy& copy : shape.copies) {
            copy.motion.shift = copy.motion(object.frame.origin) - object.frame.origin;
        }
        if (parts_.own_a_copy) {
            shape.parts_a_copy = static_cast<std::uint32_t>(parts_.names.size());
        }
        object.shape = std::move(shape);
        return object;
    }

  private:
    const Molecule& molecule_;
    std::vector<float> radii_;
    std::vector<std::uint8_t> elements_;
    Coloring coloring_;
    Parts parts_;
    Object common_;
};

/// Bonds between atoms of a unit, which are counted from its first one.
std::vector<Bond> bonds_within(const Molecule& molecule, const Unit& unit) {
    if (!molecule.has_bond_table) {
        return bonds_by_distance(std::span(molecule.positions).subspan(unit.first, unit.count),
                                 std::span(molecule.elements).subspan(unit.first, unit.count));
    }
    const auto first = static_cast<std::uint32_t>(unit.first);
    const auto end = static_cast<std::uint32_t>(unit.first + unit.count);
    std::vector<Bond> bonds;
    for (const Bond& bond : molecule.bonds) {
        if (bond.a >= first && bond.b < end) bonds.push_back({bond.a - first, bond.b - first});
    }
    return bonds;
}

}  // namespace

std::optional<double> uniform_radius(const std::string& text) {
    const std::optional<double> radius = parse_double(text);
    constexpr double kLargest = 1e15;
    if (radius && !(*radius > 0.0 && *radius <= kLargest)) {
        throw UsageError(fmt::format("'{}' is not a positive number", text));
    }
    return radius;
}

std::vector<Object> represent(const Molecule& molecule, const DataSettings& settings) {
    assert(molecule.elements.size() == molecule.atom_count());
    assert(molecule.residues.empty() || molecule.residues.size() == molecule.atom_count());
    std::vector<Unit> units = molecule.units;
    if (units.empty()) units.push_back({0, molecule.atom_count()});
    AtomObjects atoms(molecule, settings);
    std::vector<Object> objects;
    for (const Unit& unit : units) {
        objects.push_back(atoms.make(unit));
        objects.back().continues_previous = objects.size() > 1;
    }
    if (settings.representation == Representation::spheres) return objects;
    std::vector<Object> all_sticks;
    for (std::size_t u = 0; u < units.size(); ++u) {
        if (auto sticks = make_sticks(objects[u], bonds_within(molecule, units[u]), settings)) {
            all_sticks.push_back(std::move(*sticks));
        }
    }
    if (!molecule.units.empty() && !molecule.has_bond_table) {
        if (auto sticks = make_sticks(objects, bonds_between_copies(molecule), settings)) {
            all_sticks.push_back(std::move(*sticks));
        }
    }
    std::ranges::move(all_sticks, std::back_inserter(objects));
    return objects;
}

}  // namespace ink
