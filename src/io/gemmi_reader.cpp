#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <gemmi/pdb.hpp>
#include <gemmi/resinfo.hpp>
#include <optional>

#include "base/error.h"
#include "base/text.h"
#include "io/cif_grammar.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/molecule_file.h"
#include "scene/elements.h"

namespace ink {

namespace {

// ---- PDB ----
// gemmi reads a damaged number as 0 and stops at END. So we find the frames, hand gemmi the atom
// lines of one, and check the coordinates of each line on the way.

enum class Record : std::uint8_t { atom, frame_end, other };

/// gemmi, like most programs, looks at four letters in any case.
Record record_of(std::string_view line) {
    if (line.size() < 3) return Record::other;
    std::array<char, 4> name{' ', ' ', ' ', ' '};
    for (std::size_t i = 0; i < std::min(line.size(), name.size()); ++i) {
        name[i] =
            line[i] >= 'a' && line[i] <= 'z' ? static_cast<char>(line[i] - 'a' + 'A') : line[i];
    }
    const std::string_view word(name.data(), name.size());
    if (word == "ATOM" || word == "HETA") return Record::atom;
    if (word == "MODE" || word == "ENDM" || word == "END ") return Record::frame_end;
    return Record::other;
}

/// The lines of one frame of a PDB file.
struct PdbFrame {
    std::string_view text;
    std::size_t lines_before = 0;
    std::size_t atoms = 0;
};

/// A frame is a run of atoms between MODEL, ENDMDL and END lines; some programs write only END.
/// Returns how many there are.
int find_frame(std::string_view text, int wanted, PdbFrame& found) {
    int count = 0;
    PdbFrame frame;
    std::string_view begin = text;
    LineCursor lines(text);
    const auto close = [&] {
        if (frame.atoms > 0) {
            frame.text = begin.substr(0, begin.size() - lines.rest().size());
            if (count == wanted) found = frame;
            ++count;
        }
        begin = lines.rest();
        frame = {.text = {}, .lines_before = lines.number()};
    };
    while (lines.next()) {
        const Record record = record_of(lines.line());
        if (record == Record::atom) ++frame.atoms;
        if (record == Record::frame_end) close();
    }
    close();
    return count;
}

/// Gives gemmi the atom lines of a frame, checked and cut to the columns that we need.
class AtomLines {
  public:
    AtomLines(const PdbFrame& frame, const std::filesystem::path& file)
        : lines_(frame.text), lines_before_(frame.lines_before), file_(file) {}

    char* gets(char* out, int) {
        while (lines_.next()) {
            if (record_of(lines_.line()) == Record::atom) return copy_checked(out);
        }
        return nullptr;
    }
    static int getc() { return EOF; }

  private:
    /// Up to the element; the charge after it is not needed, and gemmi gives up on an odd one.
    static constexpr std::size_t kColumns = 78;
    static constexpr std::size_t kCoordinateEnd = 54;

    char* copy_checked(char* out) const {
        const std::string_view line = lines_.line();
        const FilePlace place{file_, lines_before_ + lines_.number()};
        if (line.size() < kCoordinateEnd) {
            throw InputError(place.file, place.line,
                             fmt::format("the line ends at column {}, but coordinates reach to "
                                         "column {}; repair or remove the atom",
                                         line.size(), kCoordinateEnd));
        }
        parse_position(line.substr(30, 8), line.substr(38, 8), line.substr(46, 8), place);
        // A control character would end the line early for gemmi.
        const std::size_t size = std::min(line.size(), kColumns);
        std::ranges::replace_copy_if(
            line.substr(0, size), out, [](char c) { return c < ' ' || c > '~'; }, ' ');
        out[size] = '\n';
        out[size + 1] = '\0';
        return out;
    }

    LineCursor lines_;
    std::size_t lines_before_;
    const std::filesystem::path& file_;
};

bool is_polymer_residue(const std::string& name) {
    const gemmi::ResidueInfo info = gemmi::find_tabulated_residue(name);
    return info.is_standard() && (info.is_amino_acid() || info.is_nucleic_acid());
}

/// The elements of standard amino acids and nucleotides have one letter. Where there is no element
/// column and the atom name starts in the wrong one, gemmi takes an alpha carbon for calcium.
std::uint8_t element_of(const gemmi::Atom& atom, bool in_polymer) {
    const auto number = static_cast<std::uint8_t>(atom.element.atomic_number());
    if (in_polymer && number > 0 && element(number).symbol.size() > 1 &&
        atom.element != gemmi::El::Se) {
        return atomic_number(std::string_view(atom.name).substr(0, 1)).value_or(number);
    }
    return number;
}

void add_chain(MoleculeBuilder& molecule, const gemmi::Chain& chain) {
    const gemmi::SeqId* site = nullptr;
    for (const gemmi::Residue& residue : chain.residues) {
        if (site == nullptr || *site != residue.seqid) molecule.begin_site();
        site = &residue.seqid;
        const bool in_polymer = is_polymer_residue(residue.name);
        bool begun = false;
        for (const gemmi::Atom& atom : residue.atoms) {
            const std::string_view location(&atom.altloc, atom.altloc == '\0' ? 0 : 1);
            if (!molecule.keeps_location(location)) continue;
            if (!begun) molecule.begin_residue(chain.name, residue.name, residue.seqid.num.value);
            begun = true;
            const gemmi::Position& p = atom.pos;
            molecule.add_atom({p.x, p.y, p.z}, element_of(atom, in_polymer));
        }
    }
}

gemmi::Structure parse_frame(const PdbFrame& frame, const std::filesystem::path& file) {
    try {
        return gemmi::pdb_impl::read_pdb_from_stream(AtomLines(frame, file), file.string(), {});
    } catch (const Error&) {
        throw;
    } catch (const std::runtime_error& error) {
        throw InputError(file, fmt::format("is not a PDB file that can be understood ({}); check "
                                           "its columns",
                                           error.what()));
    }
}

FileContents read_pdb(const std::filesystem::path& file, const ReadOptions& options) {
    const std::string text = read_text(file);
    PdbFrame frame;
    const int frames = find_frame(text, options.frame, frame);
    if (frames > 0) check_frame(options.frame, frames, file);
    const gemmi::Structure structure = parse_frame(frame, file);
    MoleculeBuilder molecule;
    molecule.reserve(frame.atoms);
    for (const gemmi::Chain& chain : structure.models.front().chains) add_chain(molecule, chain);
    return std::move(molecule).finish(file, "PDB", frames);
}

// ---- mmCIF ----
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
    kColumnCount,
    kNoColumn = kColumnCount
};

constexpr std::array<std::string_view, kColumnCount> kColumnTags{
    "cartn_x",          "cartn_y",      "cartn_z",
    "type_symbol",      "label_alt_id", "pdbx_pdb_model_num",
    "label_asym_id",    "auth_asym_id", "label_comp_id",
    "auth_comp_id",     "label_seq_id", "auth_seq_id",
    "pdbx_pdb_ins_code"};

constexpr std::string_view kCategory = "_atom_site.";

/// A value without quotes; "?" and "." mean that there is none.
std::string_view plain_value(std::string_view value) {
    if (value == "?" || value == ".") return {};
    if (value.size() >= 2 && (value.front() == '\'' || value.front() == '"')) {
        return value.substr(1, value.size() - 2);
    }
    if (value.size() >= 2 && value.front() == ';') return trim(value.substr(1, value.size() - 2));
    return value;
}

/// A number without its standard uncertainty: "1.234" of "1.234(5)".
std::string_view without_uncertainty(std::string_view number) {
    return number.ends_with(')') ? number.substr(0, number.find('(')) : number;
}

/// Takes in the values of the _atom_site table one by one.
class AtomTable final : public CifLoops {
  public:
    AtomTable(const std::filesystem::path& file, int wanted) : file_(file), wanted_(wanted) {}

    void begin_loop() override {
        columns_.clear();
        next_ = 0;
    }
    void add_tag(std::string_view tag) override;
    void add_value(std::string_view value, std::size_t line) override;
    void end_loop() override;

    /// The molecule, when all is read. Throws InputError.
    FileContents finish() &&;

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
    bool has_fractional_ = false;

    int frames_ = 0;
    std::string_view model_;
    std::string_view chain_, residue_, number_, insertion_;  ///< of the row before
    MoleculeBuilder molecule_;
};

void AtomTable::add_tag(std::string_view tag) {
    const std::string name = to_lower(tag);
    has_fractional_ = has_fractional_ || name == "_atom_site_fract_x";
    if (!name.starts_with(kCategory)) return;
    const auto* const found =
        std::ranges::find(kColumnTags, std::string_view(name).substr(kCategory.size()));
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
        molecule_.begin_residue(chain_, residue_, static_cast<std::int32_t>(number));
    }
    const Vec3d position =
        parse_position(without_uncertainty(row_[kX]), without_uncertainty(row_[kY]),
                       without_uncertainty(row_[kZ]), {file_, line_});
    molecule_.add_atom(position, atomic_number(row_[kSymbol]).value_or(0));
}

FileContents AtomTable::finish() && {
    if (frames_ == 0 && has_fractional_) {
        throw InputError(file_,
                         "is a crystal structure with fractional coordinates, which cannot be read "
                         "yet; convert it to XYZ, for example with 'obabel IN.cif -O OUT.xyz'");
    }
    if (frames_ > 0) check_frame(wanted_, frames_, file_);
    return std::move(molecule_).finish(file_, "mmCIF", frames_);
}

FileContents read_mmcif(const std::filesystem::path& file, const ReadOptions& options) {
    const std::string text = read_text(file);
    AtomTable table(file, options.frame);
    try {
        walk_cif(text, table);
    } catch (const CifSyntaxError& error) {
        throw InputError(
            file, error.line,
            fmt::format("{}; repair the file, or copy it again if it was cut", error.what()));
    }
    return std::move(table).finish();
}

constexpr std::array<std::string_view, 3> kPdbExtensions{"pdb", "ent", "pdb1"};
constexpr std::array<std::string_view, 2> kMmcifExtensions{"cif", "mmcif"};

}  // namespace

Reader pdb_reader() { return {"PDB", kPdbExtensions, read_pdb}; }
Reader mmcif_reader() { return {"mmCIF", kMmcifExtensions, read_mmcif}; }

}  // namespace ink
