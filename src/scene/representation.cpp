#include "scene/representation.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

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

Parts atom_parts(const Molecule& molecule, const DataSettings& settings) {
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

}  // namespace

std::optional<double> uniform_radius(const std::string& text) {
    const std::optional<double> radius = parse_double(text);
    constexpr double kLargest = 1e15;
    if (radius && !(*radius > 0.0 && *radius <= kLargest)) {
        throw UsageError(fmt::format("--radius: '{}' is not a positive number", text));
    }
    return radius;
}

std::vector<Object> represent(const Molecule& molecule, const DataSettings& settings) {
    assert(molecule.elements.size() == molecule.atom_count());
    assert(molecule.residues.empty() || molecule.residues.size() == molecule.atom_count());
    const std::vector<float> radii = atom_radii(molecule, settings);
    Object object;
    object.name = molecule.name;
    object.kind = ObjectKind::molecule;
    if (molecule.atom_count() > 0) object.frame.origin = molecule.positions.front();
    Spheres shape;
    shape.spheres.resize(molecule.atom_count());
    parallel_ranges(molecule.atom_count(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            shape.spheres[i] = {object.frame.from_world(molecule.positions[i]), radii[i]};
        }
    });
    Coloring coloring = color_atoms(molecule, settings);
    shape.colors = std::move(coloring.colors);
    object.color_scale = std::move(coloring.scale);
    Parts parts = atom_parts(molecule, settings);
    shape.parts = std::move(parts.of_atom);
    shape.copies = molecule.copies;
    for (Motion& motion : shape.copies) {
        motion.shift = motion(object.frame.origin) - object.frame.origin;
    }
    if (parts.own_a_copy) shape.parts_a_copy = static_cast<std::uint32_t>(parts.names.size());
    object.part_names = std::move(parts.names);
    object.part_wholes = std::move(parts.wholes);
    if (settings.by_residue && !object.part_wholes.empty()) object.usual_ids = IdLevel::part;
    object.elements = molecule.elements;
    object.shape = std::move(shape);
    std::vector<Object> objects;
    if (settings.representation == Representation::sticks) object.usual_ids = IdLevel::object;
    objects.push_back(std::move(object));
    if (settings.representation != Representation::spheres) {
        if (auto sticks = make_sticks(molecule, objects[0], settings)) {
            objects.push_back(std::move(*sticks));
        }
    }
    return objects;
}

}  // namespace ink
