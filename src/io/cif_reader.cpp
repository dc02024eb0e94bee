#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "base/error.h"
#include "base/text.h"
#include "io/cif_grammar.h"
#include "io/cif_tables.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/molecule_file.h"
#include "scene/elements.h"

namespace ink {

const std::vector<CifValue>& column(const CifTables& tables, const std::string& tag) {
    static const std::vector<CifValue> kNone;
    const auto found = tables.find(tag);
    return found == tables.end() ? kNone : found->second;
}

std::string_view plain_value(std::string_view value) {
    if (value == "?" || value == ".") return {};
    if (value.size() >= 2 && (value.front() == '\'' || value.front() == '"')) {
        return value.substr(1, value.size() - 2);
    }
    if (value.size() >= 2 && value.front() == ';') return trim(value.substr(1, value.size() - 2));
    return value;
}

std::string_view without_uncertainty(std::string_view number) {
    return number.ends_with(')') ? number.substr(0, number.find('(')) : number;
}

namespace {

// gemmi's grammar, without its document: the values of the atom table are used as they go by, so
// that nothing is stored twice and each value still has its line.

enum Column : std::uint8_t {
    kX,
    kY,
    kZ,
    kSymbol,
    kLocation,
    kModel,
    kChain,
    kAuthorChain,
    kResidue,
    kAuthorResidue,
    kNumber,
    kAuthorNumber,
    kInsertion,
    kAtom,
    kAuthorAtom,
    kEntity,
    kBFactor,
    kOccupancy,
    kColumnCount,
    kNoColumn = kColumnCount
};

constexpr std::array<std::string_view, kColumnCount> kColumnTags{
    "cartn_x",           "cartn_y",        "cartn_z",
    "type_symbol",       "label_alt_id",   "pdbx_pdb_model_num",
    "label_asym_id",     "auth_asym_id",   "label_comp_id",
    "auth_comp_id",      "label_seq_id",   "auth_seq_id",
    "pdbx_pdb_ins_code", "label_atom_id",  "auth_atom_id",
    "label_entity_id",   "b_iso_or_equiv", "occupancy"};

constexpr std::array<std::string_view, 2> kFields{"bfactor", "occupancy"};

constexpr std::string_view kCategory = "_atom_site.";

/// Takes in the values of the _atom_site table one by one.
class AtomTable {
  public:
    AtomTable(const std::filesystem::path& file, int wanted) : file_(file), wanted_(wanted) {
        molecule_.set_fields(kFields);
    }

    void begin_loop() {
        columns_.clear();
        next_ = 0;
    }
    /// `name` is the tag in lower case.
    void add_tag(std::string_view name);
    void add_value(std::string_view value, std::size_t line);
    void end_loop();

    /// Whether a frame has been seen.
    bool has_frames() const { return frames_ > 0; }
    /// The molecule, when all is read. Throws InputError.
    FileContents finish(const CifTables& tables, const ReadOptions& options) &&;

  private:
    bool is_atom_table() const { return !columns_.empty() && !done_; }
    void check_columns(std::size_t line) const;
    void add_row();
    void add_atom();
    bool enters_residue();
    std::string_view row(Column first, Column second) const {
        return row_[first].empty() ? row_[second] : row_[first];
    }

    const std::filesystem::path& file_;
    int wanted_;
    std::vector<Column> columns_;  ///< of the table that is being read; empty: of no interest
    std::size_t next_ = 0;         ///< column of the next value
    std::size_t line_ = 0;
    std::array<std::string_view, kColumnCount> row_;
    bool done_ = false;

    int frames_ = 0;
    std::string_view model_;
    std::string_view chain_, residue_, number_, insertion_;  ///< of the row before
    MoleculeBuilder molecule_;
};

void AtomTable::add_tag(std::string_view name) {
    if (!name.starts_with(kCategory)) return;
    const auto* const found = std::ranges::find(kColumnTags, name.substr(kCategory.size()));
    columns_.push_back(static_cast<Column>(found - kColumnTags.begin()));
}

void AtomTable::check_columns(std::size_t line) const {
    for (const Column column : {kX, kY, kZ}) {
        if (std::ranges::find(columns_, column) != columns_.end()) continue;
        throw InputError(file_, line,
                         fmt::format("the atom table has no column _atom_site.Cartn_{}; it needs "
                                     "Cartn_x, Cartn_y and Cartn_z",
                                     "xyz"[column]));
    }
}

void AtomTable::add_value(std::string_view value, std::size_t line) {
    if (!is_atom_table()) return;
    if (frames_ == 0 && next_ == 0) check_columns(line);
    line_ = line;
    const Column column = columns_[next_];
    if (column != kNoColumn) row_[column] = plain_value(value);
    if (++next_ < columns_.size()) return;
    next_ = 0;
    add_row();
}

void AtomTable::end_loop() {
    if (!is_atom_table()) return;
    if (next_ != 0) {
        throw InputError(file_, line_,
                         fmt::format("the last row of the atom table has {} of {} values; copy the "
                                     "file again if it was cut",
                                     next_, columns_.size()));
    }
    // Further data blocks are other structures.
    done_ = frames_ > 0;
}

void AtomTable::add_row() {
    if (frames_ == 0 || row_[kModel] != model_) {
        model_ = row_[kModel];
        ++frames_;
    }
    if (frames_ - 1 == wanted_) add_atom();
}

bool AtomTable::enters_residue() {
    const std::string_view chain = row(kAuthorChain, kChain);
    const std::string_view number = row(kAuthorNumber, kNumber);
    const std::string_view residue = row(kResidue, kAuthorResidue);
    const bool same_site = !molecule_.empty() && chain == chain_ && number == number_ &&
                           row_[kInsertion] == insertion_;
    if (same_site && residue == residue_) return false;
    if (!same_site) molecule_.begin_site();
    return true;
}

void AtomTable::add_atom() {
    const bool new_residue = enters_residue();
    if (!molecule_.keeps_location(row_[kLocation])) return;
    if (new_residue) {
        chain_ = row(kAuthorChain, kChain);
        number_ = row(kAuthorNumber, kNumber);
        residue_ = row(kResidue, kAuthorResidue);
        insertion_ = row_[kInsertion];
        const std::int64_t number = parse_int(number_).value_or(0);
        molecule_.begin_residue(chain_, residue_, static_cast<std::int32_t>(number), row_[kChain],
                                row_[kEntity]);
    }
    const Vec3d position =
        parse_position(without_uncertainty(row_[kX]), without_uncertainty(row_[kY]),
                       without_uncertainty(row_[kZ]), {file_, line_});
    molecule_.add_atom(position, atomic_number(row_[kSymbol]).value_or(0), row(kAuthorAtom, kAtom));
    molecule_.set_value(0, parse_double(without_uncertainty(row_[kBFactor])).value_or(0.0));
    molecule_.set_value(1, parse_double(without_uncertainty(row_[kOccupancy])).value_or(1.0));
}

FileContents AtomTable::finish(const CifTables& tables, const ReadOptions& options) && {
    if (frames_ > 0) check_frame(wanted_, frames_, file_);
    for (Assembly& assembly : cif_assemblies(tables, file_)) {
        molecule_.add_assembly(std::move(assembly));
    }
    if (const std::string_view group = space_group(tables); !group.empty()) {
        molecule_.set_space_group(group);
    }
    return std::move(molecule_).finish(file_, "mmCIF", frames_, options);
}

/// Sends the atoms of the first block that has any to the atom table, and small tables to
/// CifTables.
class CifFile final : public CifVisitor {
  public:
    CifFile(const std::filesystem::path& file, int frame) : atoms_(file, frame) {}

    void begin_block() override { closed_ = atoms_.has_frames() || is_crystal(tables_); }
    void add_item(std::string_view tag, std::string_view value, std::size_t line) override {
        std::string name = to_lower(tag);
        if (is_kept(name)) tables_[std::move(name)] = {{value, line}};
    }
    void begin_loop() override {
        atoms_.begin_loop();
        loop_.clear();
        next_ = 0;
    }
    void add_tag(std::string_view tag) override {
        std::string name = to_lower(tag);
        atoms_.add_tag(name);
        const bool kept = is_kept(name) && !name.starts_with(kCategory);
        loop_.push_back(kept ? &tables_[std::move(name)] : nullptr);
        if (kept) loop_.back()->clear();
    }
    void add_value(std::string_view value, std::size_t line) override {
        atoms_.add_value(value, line);
        if (loop_[next_] != nullptr) loop_[next_]->push_back({value, line});
        if (++next_ == loop_.size()) next_ = 0;
    }
    void end_loop() override { atoms_.end_loop(); }

    FileContents finish(const std::filesystem::path& file, const ReadOptions& options) && {
        if (!atoms_.has_frames()) {
            if (is_crystal(tables_)) return read_crystal(tables_, file, options);
            add_lone_atom();
        }
        return std::move(atoms_).finish(tables_, options);
    }

  private:
    bool is_kept(const std::string& name) const {
        return !closed_ && (name.starts_with("_atom_site") || name.starts_with("_cell_") ||
                            name.starts_with("_symmetry") || name.starts_with("_space_group") ||
                            name.starts_with("_pdbx_struct_assembly_gen.") ||
                            name.starts_with("_pdbx_struct_oper_list."));
    }
    /// A table of one row may be written without a loop.
    void add_lone_atom() {
        atoms_.begin_loop();
        std::vector<CifValue> row;
        for (const auto& [tag, values] : tables_) {
            if (!tag.starts_with(kCategory) || values.size() != 1) continue;
            atoms_.add_tag(tag);
            row.push_back(values[0]);
        }
        for (const CifValue& value : row) atoms_.add_value(value.text, value.line);
        atoms_.end_loop();
    }

    AtomTable atoms_;
    CifTables tables_;
    bool closed_ = false;
    std::vector<std::vector<CifValue>*> loop_;  ///< a column: where it is kept, or null
    std::size_t next_ = 0;
};

FileContents read_cif(const std::filesystem::path& file, const ReadOptions& options) {
    const std::string text = read_text(file);
    CifFile cif(file, options.frame);
    try {
        walk_cif(text, cif);
    } catch (const CifSyntaxError& error) {
        throw InputError(
            file, error.line,
            fmt::format("{}; repair the file, or copy it again if it was cut", error.what()));
    }
    return std::move(cif).finish(file, options);
}

constexpr std::array<std::string_view, 2> kExtensions{"cif", "mmcif"};

}  // namespace

Reader cif_reader() { return {"CIF", kExtensions, read_cif}; }

}  // namespace ink
