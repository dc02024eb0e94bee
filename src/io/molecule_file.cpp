#include "io/molecule_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/error.h"
#include "base/text.h"
#include "io/file_text.h"
#include "scene/elements.h"
#include "scene/facts.h"
#include "scene/representation.h"
#include "scene/selection.h"

namespace ink {

namespace {

double parse_coordinate(std::string_view text, char axis, FilePlace place) {
    const auto fail = [&](std::string_view problem) -> InputError {
        return {place.file, place.line, fmt::format("{}; repair or remove the atom", problem)};
    };
    text = trim(text);
    if (text.empty()) throw fail(fmt::format("coordinate {} is missing", axis));
    const std::optional<double> value = parse_double(text);
    if (!value || !std::isfinite(*value)) {
        throw fail(fmt::format("coordinate {} {} is not a number", axis, excerpt(text)));
    }
    if (std::abs(*value) > kLargestCoordinate) {
        throw fail(fmt::format("coordinate {} {} is too large", axis, excerpt(text)));
    }
    return *value;
}

/// "1 atom has", "3 atoms have".
std::string atoms_have(std::uint64_t count) {
    return count == 1 ? "1 atom has" : fmt::format("{} atoms have", count);
}

/// The file's name without folder, ".gz" and format extension.
std::string molecule_name(const std::filesystem::path& file) {
    const std::filesystem::path name = file.filename();
    const bool compressed = to_lower(name.extension().string()) == ".gz";
    return (compressed ? name.stem().stem() : name.stem()).string();
}

}  // namespace

Vec3d parse_position(std::string_view x, std::string_view y, std::string_view z, FilePlace place) {
    return {parse_coordinate(x, 'x', place), parse_coordinate(y, 'y', place),
            parse_coordinate(z, 'z', place)};
}

void check_frame(int frame, int frames, const std::filesystem::path& file) {
    if (frame >= 0 && frame < frames) return;
    throw InputError(file, frames == 1 ? fmt::format("has no frame {}; its only frame is 0", frame)
                                       : fmt::format("has no frame {}; its {} frames are 0 to {}",
                                                     frame, frames, frames - 1));
}

std::uint8_t element_of_name(std::string_view atom, std::string_view residue) {
    const auto is_letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
    while (!atom.empty() && !is_letter(atom.front())) atom.remove_prefix(1);
    const auto end = std::ranges::find_if_not(atom, is_letter);
    const std::string_view letters = atom.substr(0, static_cast<std::size_t>(end - atom.begin()));
    const std::uint8_t one = atomic_number(letters.substr(0, 1)).value_or(0);
    const std::uint8_t two =
        letters.size() > 1 ? atomic_number(letters.substr(0, 2)).value_or(0) : 0;
    const ResidueKind kind = residue_kind(residue);
    if (kind != ResidueKind::other) {
        // Selenium is the one element of two letters in amino acids (selenomethionine).
        constexpr std::uint8_t kSelenium = 34;
        return two == kSelenium && kind == ResidueKind::protein ? two : one;
    }
    // "CA" in "CA" or "CA2+" is an ion; so is "Na" anywhere, in the spelling of a symbol.
    const bool spelled = letters.size() == 2 && letters[1] >= 'a';
    const bool is_ion = two != 0 && to_lower(residue).starts_with(to_lower(letters.substr(0, 2)));
    if (two != 0 && (spelled || is_ion)) return two;
    constexpr std::uint8_t kChlorine = 17;
    constexpr std::uint8_t kBromine = 35;
    return two == kChlorine || two == kBromine || one == 0 ? two : one;
}

namespace {

/// The index of a name in a list that grows by names that are new.
std::uint32_t index_of(std::string_view name, std::unordered_map<std::string, std::uint32_t>& known,
                       std::vector<std::string>& list) {
    const auto [entry, is_new] =
        known.try_emplace(std::string(name), static_cast<std::uint32_t>(list.size()));
    if (is_new) list.emplace_back(name);
    return entry->second;
}

}  // namespace

void MoleculeBuilder::begin_residue(std::string_view chain, std::string_view name,
                                    std::int32_t number, std::string_view asym,
                                    std::string_view entity) {
    if (molecule_.residue_table.empty() && !empty()) {
        // Atoms before the first residue that has a name are in one of their own.
        molecule_.residue_table.push_back(
            {"", 0, index_of(chain, chain_by_name_, molecule_.chains),
             index_of(asym.empty() ? chain : asym, asym_by_name_, molecule_.asyms)});
        molecule_.residues.assign(molecule_.atom_count(), 0);
    }
    Residue residue{std::string(name), number};
    residue.chain = index_of(chain, chain_by_name_, molecule_.chains);
    residue.asym = index_of(asym.empty() ? chain : asym, asym_by_name_, molecule_.asyms);
    residue.kind = residue_kind(name);
    if (!entity.empty()) {
        has_entities_ = true;
        residue.entity = index_of(entity, entity_by_name_, molecule_.entities);
    }
    molecule_.residue_table.push_back(std::move(residue));
}

bool MoleculeBuilder::keeps_location(std::string_view location) {
    if (location.empty()) return true;
    if (location_.empty()) location_ = location;
    if (location == location_) return true;
    ++left_out_;
    return false;
}

void MoleculeBuilder::reserve(std::size_t atoms) {
    molecule_.positions.reserve(atoms);
    molecule_.elements.reserve(atoms);
}

void MoleculeBuilder::set_fields(std::span<const std::string_view> names) {
    for (const std::string_view name : names) add_field(name, 1);
}

void MoleculeBuilder::add_field(std::string_view name, std::size_t components) {
    molecule_.fields.push_back({std::string(name), components, {}});
}

void MoleculeBuilder::add_atom(Vec3d position, std::uint8_t element, std::string_view name) {
    molecule_.positions.push_back(position);
    molecule_.elements.push_back(element);
    if (!name.empty() || !molecule_.atom_names.empty()) {
        molecule_.atom_names.resize(molecule_.positions.size() - 1);
        molecule_.atom_names.push_back(atom_name(name));
    }
    for (Field& field : molecule_.fields) {
        field.values.resize(field.values.size() + field.components);
    }
    if (element == 0) ++unknown_elements_;
    if (!molecule_.residue_table.empty()) {
        molecule_.residues.push_back(
            static_cast<std::uint32_t>(molecule_.residue_table.size() - 1));
    }
}

void MoleculeBuilder::set_value(std::size_t field, double value, std::size_t component) {
    Field& changed = molecule_.fields[field];
    const std::size_t place = changed.values.size() - changed.components + component;
    changed.values[place] = static_cast<float>(value);
}

void MoleculeBuilder::add_bond(std::size_t a, std::size_t b) {
    if (a == b) return;
    const auto [first, second] = std::minmax(a, b);
    molecule_.bonds.push_back(
        {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(second)});
}

/// Lone atoms that are no gas or part of organic matter are ions. Where the file names no entities,
/// chains of the same sequence are one, and so are ligands of the same name.
void MoleculeBuilder::complete_residues() {
    std::vector<std::uint32_t> sizes(molecule_.residue_table.size());
    std::vector<std::uint8_t> last_element(sizes.size());
    for (std::size_t i = 0; i < molecule_.residues.size(); ++i) {
        ++sizes[molecule_.residues[i]];
        last_element[molecule_.residues[i]] = molecule_.elements[i];
    }
    std::vector<std::string> sequences(molecule_.chains.size());
    const auto is_linked = [](const Residue& r) {
        return r.kind == ResidueKind::protein || r.kind == ResidueKind::nucleic;
    };
    for (std::size_t r = 0; r < sizes.size(); ++r) {
        Residue& residue = molecule_.residue_table[r];
        constexpr std::uint8_t kOxygen = 8;
        const bool organic =
            last_element[r] <= kOxygen && last_element[r] != 3 && last_element[r] != 4;
        if (residue.kind == ResidueKind::other && sizes[r] == 1 && !organic) {
            residue.kind = ResidueKind::ion;
        }
        if (is_linked(residue)) sequences[residue.chain] += residue.name + ' ';
    }
    if (has_entities_) return;
    std::map<std::string, std::uint32_t> entity_of_sequence;
    // A sequence is as long as its chain: it is looked up once a chain, not once a residue.
    constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> entity_of_chain(sequences.size(), kNone);
    for (Residue& residue : molecule_.residue_table) {
        if (!is_linked(residue)) {
            residue.entity = index_of(residue.name, entity_by_name_, molecule_.entities);
            continue;
        }
        std::uint32_t& entity = entity_of_chain[residue.chain];
        if (entity == kNone) {
            const auto next = static_cast<std::uint32_t>(molecule_.entities.size());
            const auto [entry, is_new] =
                entity_of_sequence.try_emplace(sequences[residue.chain], next);
            if (is_new) molecule_.entities.push_back("chain " + molecule_.chains[residue.chain]);
            entity = entry->second;
        }
        residue.entity = entity;
    }
}

/// Force fields give some hydrogens no radius: they lie inside their neighbours.
void MoleculeBuilder::leave_out_without_radius(const DataSettings& settings,
                                               std::vector<std::string>& warnings) {
    const auto without = std::ranges::count(molecule_.radii, 0.0F);
    if (without == 0 || !settings.radius.empty()) return;
    std::vector<std::uint8_t> keep(molecule_.atom_count());
    for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = molecule_.radii[i] > 0.0F ? 1 : 0;
    molecule_ = filtered(molecule_, keep);
    warnings.push_back(
        fmt::format("{} no radius in the file and were left out; --radius draws all.",
                    atoms_have(static_cast<std::uint64_t>(without))));
    if (molecule_.atom_count() == 0) throw Error("no atom has a radius; set one with --radius");
}

namespace {

[[noreturn]] void refuse_empty_clip() { throw Error("--clip: no atom is inside the box"); }

}  // namespace

void MoleculeBuilder::select(const DataSettings& settings) {
    if (settings.select.empty()) return;
    const auto keep = Selection::parse(settings.select).evaluate(molecule_);
    if (std::ranges::count(keep, 1) == 0) {
        throw Error(
            fmt::format("--select: no atom is '{}'; 'inktrace info' tells what is in the file",
                        settings.select));
    }
    molecule_ = filtered(molecule_, keep);
}

void MoleculeBuilder::assemble(const DataSettings& settings) {
    const auto found = std::ranges::find(assemblies_, settings.assembly, &Assembly::name);
    if (found == assemblies_.end()) {
        std::string names;
        for (const Assembly& assembly : assemblies_) {
            names += (names.empty() ? "" : ", ") + assembly.name;
        }
        throw Error(names.empty()
                        ? std::string("--assembly: the file describes none; leave it out")
                        : fmt::format("--assembly: there is no '{}'; the file describes {}",
                                      settings.assembly, names));
    }
    // Atoms are counted in 32 bits, here and in what is drawn of them.
    constexpr std::size_t kMostAtoms = std::size_t{1} << 31;
    if (ink::atom_count(molecule_, *found) > kMostAtoms) {
        throw Error("--assembly: has more than 2^31 atoms; repair its operators");
    }
    if (ink::atom_count(molecule_, *found) == 0) {
        throw Error(
            fmt::format("--assembly: '{}' copies no chain that is drawn", settings.assembly));
    }
    molecule_ = assembled(molecule_, *found, settings.clip);
    if (molecule_.atom_count() == 0) refuse_empty_clip();
}

void MoleculeBuilder::clip(const DataSettings& settings) {
    if (settings.clip.everything()) return;
    std::vector<std::uint8_t> keep(molecule_.atom_count());
    for (std::size_t i = 0; i < keep.size(); ++i) {
        keep[i] = settings.clip.holds(molecule_.positions[i]) ? 1 : 0;
    }
    if (std::ranges::count(keep, 1) == 0) refuse_empty_clip();
    molecule_ = filtered(molecule_, keep);
}

/// What `--select` and `--assembly` can ask for.
void MoleculeBuilder::describe_names(FileContents& contents) const {
    const auto add = [&](std::string_view what, std::vector<std::string> names) {
        if (!names.empty()) contents.names.emplace_back(what, std::move(names));
    };
    std::vector<std::string> ligands;
    std::vector<std::string> ions;
    for (const Residue& residue : molecule_.residue_table) {
        if (residue.kind != ResidueKind::other && residue.kind != ResidueKind::ion) continue;
        auto& kind = residue.kind == ResidueKind::ion ? ions : ligands;
        if (std::ranges::find(kind, residue.name) == kind.end()) kind.push_back(residue.name);
    }
    std::vector<std::string> assemblies;
    for (const Assembly& assembly : assemblies_) assemblies.push_back(assembly.name);
    if (!molecule_.residues.empty()) add("chains", molecule_.chains);
    add("ligands", std::move(ligands));
    add("ions", std::move(ions));
    add("assemblies", std::move(assemblies));
}

void MoleculeBuilder::describe(FileContents& contents) const {
    contents.counts.emplace_back("atoms", molecule_.atom_count());
    if (!molecule_.residues.empty()) {
        contents.counts.emplace_back("residues", molecule_.residue_table.size());
        contents.counts.emplace_back("chains", molecule_.chains.size());
        contents.counts.emplace_back("entities", molecule_.entities.size());
    }
    if (molecule_.has_bond_table) contents.counts.emplace_back("bonds", molecule_.bonds.size());
    if (!assemblies_.empty()) contents.counts.emplace_back("assemblies", assemblies_.size());
    describe_names(contents);
    if (!molecule_.radii.empty()) {
        contents.fields.push_back(summarize({"radius", 1, molecule_.radii}));
    }
    for (const Field& field : molecule_.fields) contents.fields.push_back(summarize(field));
}

void MoleculeBuilder::warn_about_symmetry(std::vector<std::string>& warnings) const {
    if (!space_group_) return;
    std::string name = *space_group_;
    std::erase(name, ' ');
    const bool is_polymer = std::ranges::any_of(molecule_.residue_table, [](const Residue& r) {
        return r.kind == ResidueKind::protein || r.kind == ResidueKind::nucleic;
    });
    if (to_lower(name) == "p1" || is_polymer) return;
    warnings.push_back(
        fmt::format("Only the atoms of the file are drawn: the symmetry of its crystal{} is not "
                    "applied.",
                    name.empty() ? "" : fmt::format(" ({})", *space_group_)));
}

FileContents MoleculeBuilder::finish(const std::filesystem::path& file, std::string_view format,
                                     int frames, const ReadOptions& options) && {
    if (empty()) throw InputError(file, "holds no atoms; a file with coordinates is needed");
    molecule_.name = molecule_name(file);
    if (!molecule_.atom_names.empty()) molecule_.atom_names.resize(molecule_.atom_count());
    complete_residues();
    FileContents contents;
    contents.format = format;
    contents.length_unit = "angstrom";
    contents.frames = frames;
    describe(contents);
    contents.warnings = std::move(warnings_);
    if (left_out_ > 0) {
        contents.warnings.push_back(
            fmt::format("{} been left out: of alternate locations only the first is drawn.",
                        atoms_have(left_out_)));
    }
    if (unknown_elements_ > 0 && molecule_.radii.empty()) {
        contents.warnings.push_back(
            fmt::format("{} no known element: drawn in pink with a radius of 1.5 angstrom.",
                        atoms_have(unknown_elements_)));
    }
    warn_about_symmetry(contents.warnings);
    leave_out_without_radius(options.data, contents.warnings);
    select(options.data);
    if (options.data.assembly.empty()) {
        clip(options.data);
    } else {
        assemble(options.data);
    }
    contents.objects = represent(molecule_, options.data);
    if (options.facts) {
        std::vector<FactSource> facts = molecule_facts(std::move(molecule_));
        for (std::size_t u = 0; u < facts.size(); ++u) {
            contents.objects[u].facts = std::move(facts[u]);
        }
    }
    return contents;
}

}  // namespace ink
