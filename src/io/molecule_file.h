#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <unordered_map>

#include "base/vec.h"
#include "io/reader.h"
#include "scene/molecule.h"

// What the readers of molecules share.
namespace ink {

/// A place in a file, for messages; `line` counts from 1.
struct FilePlace {
    const std::filesystem::path& file;
    std::size_t line;
};

/// A point from the text of its coordinates. Throws InputError where one is missing, not a number,
/// not finite or beyond kLargestCoordinate.
Vec3d parse_position(std::string_view x, std::string_view y, std::string_view z, FilePlace place);

/// Throws InputError unless `frame` is one of `frames`.
void check_frame(int frame, int frames, const std::filesystem::path& file);

/// Gathers the atoms of one molecule, residue by residue.
class MoleculeBuilder {
  public:
    /// The atoms that follow belong to a new residue.
    void begin_residue(std::string_view chain, std::string_view name, std::int32_t number);

    /// Whether to draw an atom in this alternate location (empty: it has only one). The first
    /// location of a residue wins; `begin_site` starts the next residue, or the next group of
    /// residues that share one place in the chain.
    bool keeps_location(std::string_view location);
    void begin_site() { location_.clear(); }

    void reserve(std::size_t atoms);
    /// `element` 0: unknown.
    void add_atom(Vec3d position, std::uint8_t element);

    bool empty() const { return molecule_.positions.empty(); }

    /// The molecule as a file's contents, with counts and warnings. Throws InputError where there
    /// is no atom.
    FileContents finish(const std::filesystem::path& file, std::string_view format, int frames) &&;

  private:
    std::uint32_t chain_index(std::string_view name);

    Molecule molecule_;
    std::unordered_map<std::string, std::uint32_t> chain_by_name_;
    std::string location_;
    std::uint64_t unknown_elements_ = 0;
    std::uint64_t left_out_ = 0;
};

}  // namespace ink
