#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

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

/// The element that an atom's name begins with, where a file has no column for it: carbon for "CA"
/// of an amino acid, calcium for "CA" of a residue "CA". 0 where there is none.
std::uint8_t element_of_name(std::string_view atom, std::string_view residue);

ResidueKind residue_kind(std::string_view name);  ///< residue_kind.cpp

/// Gathers the atoms of one molecule, residue by residue.
class MoleculeBuilder {
  public:
    /// The atoms that follow belong to a new residue. `asym` is the chain by the name that
    /// assemblies use, `entity` what it is a copy of; empty: chain and kind of residue tell.
    void begin_residue(std::string_view chain, std::string_view name, std::int32_t number,
                       std::string_view asym = {}, std::string_view entity = {});

    /// Whether to draw an atom in this alternate location (empty: it has only one). The first
    /// location of a residue wins; `begin_site` starts the next residue, or the next group of
    /// residues that share one place in the chain.
    bool keeps_location(std::string_view location);
    void begin_site() { location_.clear(); }

    void reserve(std::size_t atoms);
    /// Names the fields of which every atom gets a value, before the first atom.
    void set_fields(std::span<const std::string_view> names);
    void add_field(std::string_view name, std::size_t components);
    /// `element` 0: unknown.
    void add_atom(Vec3d position, std::uint8_t element, std::string_view name = {});
    /// Of the atom that was added last.
    void set_value(std::size_t field, double value, std::size_t component = 0);
    void set_radius(double radius) { molecule_.radii.push_back(static_cast<float>(radius)); }

    /// The file has a table of bonds, even if it is empty.
    void begin_bonds() { molecule_.has_bond_table = true; }
    /// Between two atoms, from 0, that have been added.
    void add_bond(std::size_t a, std::size_t b);

    /// The file says that a crystal goes on from its atoms by the symmetry of a space group, as
    /// "F m -3 m"; empty: by one without a name. A warning tells what is missing, unless it is what
    /// everybody expects: of proteins and nucleic acids the asymmetric unit is drawn.
    void set_space_group(std::string_view name) { space_group_ = name; }
    void add_assembly(Assembly assembly) { assemblies_.push_back(std::move(assembly)); }
    void warn(std::string warning) { warnings_.push_back(std::move(warning)); }

    bool empty() const { return molecule_.positions.empty(); }
    std::size_t atom_count() const { return molecule_.atom_count(); }

    /// What is to be drawn of the molecule as a file's contents, with counts and warnings. Throws
    /// InputError where there is no atom, and Error where the options ask for what is not there.
    FileContents finish(const std::filesystem::path& file, std::string_view format, int frames,
                        const ReadOptions& options) &&;

  private:
    void complete_residues();
    void leave_out_without_radius(const DataSettings& settings, std::vector<std::string>& warnings);
    void select(const DataSettings& settings);
    void assemble(const DataSettings& settings);
    void clip(const DataSettings& settings);
    void describe(FileContents& contents) const;
    void warn_about_symmetry(std::vector<std::string>& warnings) const;
    void describe_names(FileContents& contents) const;

    Molecule molecule_;
    std::unordered_map<std::string, std::uint32_t> chain_by_name_;
    std::unordered_map<std::string, std::uint32_t> asym_by_name_;
    std::unordered_map<std::string, std::uint32_t> entity_by_name_;
    std::vector<Assembly> assemblies_;
    std::vector<std::string> warnings_;
    std::string location_;
    std::optional<std::string> space_group_;
    bool has_entities_ = false;  ///< the file names them
    std::uint64_t unknown_elements_ = 0;
    std::uint64_t left_out_ = 0;
};

}  // namespace ink
