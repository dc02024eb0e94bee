#include "io/molecule_file.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "io/file_text.h"

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

std::uint32_t MoleculeBuilder::chain_index(std::string_view name) {
    const auto next = static_cast<std::uint32_t>(molecule_.chains.size());
    const auto [entry, is_new] = chain_by_name_.try_emplace(std::string(name), next);
    if (is_new) molecule_.chains.emplace_back(name);
    return entry->second;
}

void MoleculeBuilder::begin_residue(std::string_view chain, std::string_view name,
                                    std::int32_t number) {
    molecule_.residue_table.push_back({std::string(name), number, chain_index(chain)});
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

void MoleculeBuilder::add_atom(Vec3d position, std::uint8_t element) {
    molecule_.positions.push_back(position);
    molecule_.elements.push_back(element);
    if (element == 0) ++unknown_elements_;
    if (!molecule_.residue_table.empty()) {
        molecule_.residues.push_back(
            static_cast<std::uint32_t>(molecule_.residue_table.size() - 1));
    }
}

FileContents MoleculeBuilder::finish(const std::filesystem::path& file, std::string_view format,
                                     int frames) && {
    if (empty()) throw InputError(file, "holds no atoms; a file with coordinates is needed");
    molecule_.name = molecule_name(file);
    FileContents contents;
    contents.format = format;
    contents.length_unit = "angstrom";
    contents.frames = frames;
    contents.counts.emplace_back("atoms", molecule_.atom_count());
    if (!molecule_.residues.empty()) {
        contents.counts.emplace_back("residues", molecule_.residue_table.size());
        contents.counts.emplace_back("chains", molecule_.chains.size());
    }
    if (left_out_ > 0) {
        contents.warnings.push_back(
            fmt::format("{} been left out: of alternate locations only the first is drawn.",
                        atoms_have(left_out_)));
    }
    if (unknown_elements_ > 0) {
        contents.warnings.push_back(
            fmt::format("{} no known element: drawn in pink with a radius of 1.5 angstrom.",
                        atoms_have(unknown_elements_)));
    }
    contents.objects.push_back(space_filling(molecule_));
    return contents;
}

}  // namespace ink
