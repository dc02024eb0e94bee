#include "scene/representation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "scene/bonds.h"
#include "scene/elements.h"

namespace ink {

namespace {

/// Atoms that are worth a task of their own.
constexpr std::size_t kGrain = 16384;

[[noreturn]] void refuse_field(std::string_view flag, std::string_view name, std::string_view words,
                               const Molecule& molecule) {
    throw Error(
        fmt::format("--{}: the atoms have no '{}'; expected {}{}{}", flag, name, words,
                    molecule.fields.empty() ? "" : " or a field: ", field_names(molecule.fields)));
}

std::vector<float> atom_field(const Molecule& molecule, const std::string& name) {
    if (name == "radius" && !molecule.radii.empty()) return molecule.radii;
    return scalar_values(molecule.fields, name);
}

// ---- Radii ----

/// Of balls in ball-and-stick models, as ChimeraX draws them.
constexpr float kBallScale = 0.25F;
constexpr double kStickWithBalls = 0.14;
constexpr double kStickAlone = 0.2;
/// Of sticks between atoms of two colours, where lines would part two halves.
constexpr Rgb8 kStickColor{168, 168, 168};

double stick_radius(const DataSettings& settings) {
    const bool alone = settings.representation == Representation::sticks;
    return settings.stick_radius.value_or(alone ? kStickAlone : kStickWithBalls);
}

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

// ---- Colours ----

/// Along each chain from the first residue (0) to the last (1).
std::vector<float> along_chain(const Molecule& molecule) {
    constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::pair<std::uint32_t, std::uint32_t>> ends(molecule.chains.size(), {kNone, 0});
    const auto is_linked = [](const Residue& residue) {
        return residue.kind == ResidueKind::protein || residue.kind == ResidueKind::nucleic;
    };
    for (std::uint32_t r = 0; r < molecule.residue_table.size(); ++r) {
        if (!is_linked(molecule.residue_table[r])) continue;
        auto& [first, last] = ends[molecule.residue_table[r].chain];
        first = std::min(first, r);
        last = std::max(last, r);
    }
    std::vector<float> places(molecule.atom_count());
    for (std::size_t i = 0; i < places.size(); ++i) {
        const Residue& residue = *molecule.residue(i);
        const auto [first, last] = ends[residue.chain];
        places[i] = is_linked(residue) && last > first
                        ? static_cast<float>(molecule.residues[i] - first) /
                              static_cast<float>(last - first)
                        : std::numeric_limits<float>::quiet_NaN();
    }
    return places;
}

using AtomColor = std::function<Rgb8(std::size_t atom)>;

Rgb8 element_color(const Molecule& molecule, std::size_t atom) {
    return element(molecule.elements[atom]).color;
}

/// Colours that hang on the atom's element or residue; nothing where the word is another.
AtomColor hierarchy_color(const Molecule& m, const std::string& word) {
    if (word.empty() || word == "element") {
        return [&m](std::size_t i) { return element_color(m, i); };
    }
    if (m.residues.empty()) return {};
    if (word == "chain") return [&m](std::size_t i) { return category_color(m.residue(i)->chain); };
    if (word == "chain-hetero") {
        constexpr std::uint8_t kCarbon = 6;
        return [&m](std::size_t i) {
            return m.elements[i] == kCarbon ? category_color(m.residue(i)->chain)
                                            : element_color(m, i);
        };
    }
    if (word == "entity") {
        return [&m](std::size_t i) { return category_color(m.residue(i)->entity); };
    }
    if (word == "residue") {
        std::map<std::string, std::size_t> order;
        for (const Residue& residue : m.residue_table) order.try_emplace(residue.name, 0);
        std::size_t next = 0;
        for (auto& [name, index] : order) index = next++;
        return [&m, order](std::size_t i) { return category_color(order.at(m.residue(i)->name)); };
    }
    return {};
}

std::vector<Rgb8> atom_colors(const Molecule& molecule, const DataSettings& settings) {
    const std::string& word = settings.color_by;
    if (word == "none") return {};
    std::vector<Rgb8> colors(molecule.atom_count());
    if (const auto uniform = parse_color(word)) {
        std::ranges::fill(colors, *uniform);
        return colors;
    }
    if (const AtomColor color = hierarchy_color(molecule, word)) {
        parallel_ranges(colors.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) colors[i] = color(i);
        });
        return colors;
    }
    const bool rainbow = word == "rainbow" && !molecule.residues.empty();
    const std::vector<float> values = rainbow ? along_chain(molecule) : atom_field(molecule, word);
    if (values.size() != molecule.atom_count()) {
        refuse_field("color-by", word,
                     molecule.residues.empty()
                         ? "element, none, a colour"
                         : "element, chain, chain-hetero, residue, entity, rainbow, none, a colour",
                     molecule);
    }
    return field_colors(values, settings);
}

// ---- Parts ----

struct Parts {
    std::vector<std::uint32_t> of_atom;
    std::vector<std::string> names;
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
    const std::string& level = settings.parts;
    if (level == "element") return element_parts(molecule);
    if (molecule.residues.empty()) {
        if (level.empty()) return {};
        throw Error(fmt::format(
            "--ids: part:{}: the file names no residues or chains; expected part:element", level));
    }
    if (level.empty() || level == "chain") {
        return {by_residue(molecule, [](const Residue& r) { return r.chain; }), molecule.chains};
    }
    if (level == "residue") return {molecule.residues, residue_names(molecule)};
    if (level == "entity") {
        return {by_residue(molecule, [](const Residue& r) { return r.entity; }), molecule.entities};
    }
    throw Error(
        fmt::format("--ids: part:{}: expected part:chain, residue, entity or element", level));
}

// ---- Bonds ----

/// A stick a bond, in the colour and part of its ends. Where these differ, sticks alone are two
/// halves.
class StickBuilder {
  public:
    StickBuilder(const Spheres& atoms, double radius, bool in_halves)
        : atoms_(atoms), radius_(radius), in_halves_(in_halves) {
        sticks_.shape = {.kind = GlyphKind::frustum, .capped = false};
    }

    void add(const Bond& bond) {
        const Vec3d from = to_double(atoms_.spheres[bond.a].centre);
        const Vec3d to = to_double(atoms_.spheres[bond.b].centre);
        if (from == to) return;
        if (!in_halves_ || (color(bond.a) == color(bond.b) && part(bond.a) == part(bond.b))) {
            const bool same = color(bond.a) == color(bond.b);
            add(from, to, same ? color(bond.a) : kStickColor, part(bond.a));
            return;
        }
        const Vec3d middle = (from + to) * 0.5;
        add(from, middle, color(bond.a), part(bond.a));
        add(middle, to, color(bond.b), part(bond.b));
    }
    Glyphs take() { return std::move(sticks_); }

  private:
    Rgb8 color(std::uint32_t atom) const {
        return atoms_.colors.empty() ? kStickColor : atoms_.colors[atom];
    }
    std::uint32_t part(std::uint32_t atom) const {
        return atoms_.parts.empty() ? 0 : atoms_.parts[atom];
    }
    void add(Vec3d from, Vec3d to, Rgb8 color, std::uint32_t part) {
        sticks_.placements.push_back(placement_between(from, to, radius_));
        sticks_.colors.push_back(color);
        if (!atoms_.parts.empty()) sticks_.parts.push_back(part);
    }

    const Spheres& atoms_;
    double radius_;
    bool in_halves_;
    Glyphs sticks_;
};

/// The bonds of the molecule as an object that belongs to that of its atoms; nothing where there
/// are none.
std::optional<Object> make_sticks(const Molecule& molecule, const Object& atoms,
                                  const DataSettings& settings) {
    const auto& spheres = std::get<Spheres>(atoms.shape);
    StickBuilder builder(spheres, stick_radius(settings),
                         settings.representation == Representation::sticks);
    for (const Bond& bond :
         molecule.has_bond_table ? molecule.bonds : bonds_by_distance(molecule)) {
        builder.add(bond);
    }
    Glyphs sticks = builder.take();
    if (sticks.placements.empty()) return std::nullopt;
    Object object;
    object.name = atoms.name + " bonds";
    object.kind = atoms.kind;
    object.frame = atoms.frame;
    object.shape = std::move(sticks);
    object.material = atoms.material;
    object.part_names = atoms.part_names;
    object.usual_ids = atoms.usual_ids;
    object.continues_previous = true;
    return object;
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

std::vector<Rgb8> field_colors(std::span<const float> values, const DataSettings& settings) {
    constexpr double kMax = std::numeric_limits<double>::max();
    std::pair<double, double> range = settings.color_range.value_or(std::pair{kMax, -kMax});
    if (!settings.color_range) {
        for (const float value : values) {
            if (!std::isfinite(value)) continue;
            range.first = std::min<double>(range.first, value);
            range.second = std::max<double>(range.second, value);
        }
    }
    constexpr std::size_t kSteps = 1024;
    std::array<Rgb8, kSteps> table;
    for (std::size_t k = 0; k < kSteps; ++k) {
        table[k] = settings.color_map->at(static_cast<double>(k) / (kSteps - 1));
    }
    const double span = range.second - range.first;
    const Rgb8 undefined = settings.color_map->at(std::numeric_limits<double>::quiet_NaN());
    std::vector<Rgb8> colors(values.size());
    parallel_ranges(values.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const double share = span > 0.0 ? (values[i] - range.first) / span : 0.5;
            const double step = std::clamp(share, 0.0, 1.0) * (kSteps - 1);
            colors[i] = std::isfinite(values[i])
                            ? table[static_cast<std::size_t>(std::lround(step))]
                            : undefined;
        }
    });
    return colors;
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
    shape.colors = atom_colors(molecule, settings);
    Parts parts = atom_parts(molecule, settings);
    shape.parts = std::move(parts.of_atom);
    object.part_names = std::move(parts.names);
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
