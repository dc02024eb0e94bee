#include "scene/atom_colors.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>

#include "base/error.h"
#include "base/parallel.h"
#include "scene/elements.h"

namespace ink {

void refuse_field(std::string_view flag, std::string_view name, std::string_view words,
                  const Molecule& molecule) {
    throw Error(
        fmt::format("--{}: the atoms have no '{}'; expected {}{}{}", flag, name, words,
                    molecule.fields.empty() ? "" : " or a field: ", field_names(molecule.fields)));
}

std::vector<float> atom_field(const Molecule& molecule, const std::string& name) {
    if (name == "radius" && !molecule.radii.empty()) return molecule.radii;
    return scalar_values(molecule.fields, name);
}

namespace {

/// Atoms that are worth a task of their own.
constexpr std::size_t kGrain = 16384;

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

/// Kinds that atoms are of: elements, chains, residues by name, entities.
struct Kinds {
    std::string title;
    std::vector<ColorScale::Entry> table;
    std::function<std::uint32_t(std::size_t atom)> of_atom;
    bool carbon_only = false;  ///< other atoms have their element's colour
};

std::vector<ColorScale::Entry> with_colors(const std::vector<std::string>& names) {
    std::vector<ColorScale::Entry> table;
    table.reserve(names.size());
    for (const std::string& name : names) table.push_back({name, category_color(table.size())});
    return table;
}

Kinds element_kinds(const Molecule& m) {
    Kinds kinds{"element", {}, [&m](std::size_t i) { return m.elements[i]; }};
    for (std::size_t z = 0; z < kElementCount; ++z) {
        const Element& known = element(static_cast<std::uint8_t>(z));
        kinds.table.push_back({std::string(known.symbol), known.color});
    }
    return kinds;
}

Kinds residue_kinds(const Molecule& m) {
    std::map<std::string, std::uint32_t> order;
    for (const Residue& residue : m.residue_table) order.try_emplace(residue.name, 0);
    std::vector<std::string> names;
    for (auto& [name, index] : order) {
        index = static_cast<std::uint32_t>(names.size());
        names.push_back(name);
    }
    return {"residue", with_colors(names),
            [&m, order](std::size_t i) { return order.at(m.residue(i)->name); }};
}

/// The kinds of a word of `--color-by`; nothing where it is another.
std::optional<Kinds> find_kinds(const Molecule& m, const std::string& word) {
    if (word == "element") return element_kinds(m);
    if (m.residues.empty()) return std::nullopt;
    if (word == "chain" || word == "chain-hetero") {
        return Kinds{"chain", with_colors(m.chains),
                     [&m](std::size_t i) { return m.residue(i)->chain; }, word == "chain-hetero"};
    }
    if (word == "entity") {
        return Kinds{"entity", with_colors(m.entities),
                     [&m](std::size_t i) { return m.residue(i)->entity; }};
    }
    if (word == "residue") return residue_kinds(m);
    return std::nullopt;
}

Coloring color_kinds(const Molecule& molecule, const Kinds& kinds) {
    constexpr std::uint8_t kCarbon = 6;
    Coloring coloring;
    coloring.colors.resize(molecule.atom_count());
    parallel_ranges(coloring.colors.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint8_t z = molecule.elements[i];
            coloring.colors[i] = kinds.carbon_only && z != kCarbon
                                     ? element(z).color
                                     : kinds.table[kinds.of_atom(i)].color;
        }
    });
    std::vector<std::uint8_t> seen(kinds.table.size());
    for (std::size_t i = 0; i < coloring.colors.size(); ++i) seen[kinds.of_atom(i)] = 1;
    coloring.scale.emplace();
    coloring.scale->title = kinds.title;
    for (std::size_t k = 0; k < seen.size(); ++k) {
        if (seen[k] != 0) coloring.scale->entries.push_back(kinds.table[k]);
    }
    return coloring;
}

}  // namespace

std::string_view usual_coloring(const Molecule& molecule) {
    constexpr std::size_t kMostInElements = 10'000;
    return molecule.drawn_count() > kMostInElements && molecule.chains.size() > 1 ? "chain"
                                                                                  : "element";
}

Coloring color_atoms(const Molecule& molecule, const DataSettings& settings) {
    const std::string word =
        settings.color_by.empty() ? std::string(usual_coloring(molecule)) : settings.color_by;
    if (word == "none") return {};
    if (const auto uniform = parse_color(word)) {
        return {std::vector<Rgb8>(molecule.atom_count(), *uniform), std::nullopt};
    }
    if (const auto kinds = find_kinds(molecule, word)) return color_kinds(molecule, *kinds);
    const bool rainbow = word == "rainbow" && !molecule.residues.empty();
    const std::vector<float> values = rainbow ? along_chain(molecule) : atom_field(molecule, word);
    if (values.size() != molecule.atom_count()) {
        refuse_field("color-by", word,
                     molecule.residues.empty()
                         ? "element, none, a colour"
                         : "element, chain, chain-hetero, residue, entity, rainbow, none, a colour",
                     molecule);
    }
    return color_field(rainbow ? "along chain" : word, values, settings);
}

}  // namespace ink
