#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <gemmi/pdb.hpp>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/molecule_file.h"
#include "scene/elements.h"

namespace ink {

namespace {

// PDB.
//
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

constexpr std::array<std::string_view, 2> kFields{"bfactor", "occupancy"};

void add_chain(MoleculeBuilder& molecule, const gemmi::Chain& chain) {
    const gemmi::SeqId* site = nullptr;
    for (const gemmi::Residue& residue : chain.residues) {
        if (site == nullptr || *site != residue.seqid) molecule.begin_site();
        site = &residue.seqid;
        const ResidueKind kind = residue_kind(residue.name);
        const bool in_polymer = kind == ResidueKind::protein || kind == ResidueKind::nucleic;
        bool begun = false;
        for (const gemmi::Atom& atom : residue.atoms) {
            const std::string_view location(&atom.altloc, atom.altloc == '\0' ? 0 : 1);
            if (!molecule.keeps_location(location)) continue;
            if (!begun) molecule.begin_residue(chain.name, residue.name, residue.seqid.num.value);
            begun = true;
            const gemmi::Position& p = atom.pos;
            molecule.add_atom({p.x, p.y, p.z}, element_of(atom, in_polymer), atom.name);
            molecule.set_value(0, atom.b_iso);
            molecule.set_value(1, atom.occ);
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

/// Biological assemblies of REMARK 350, in the layout of the PDB format 3.3.
class AssemblyRemarks {
  public:
    AssemblyRemarks(std::string_view text, const std::filesystem::path& file)
        : lines_(text), file_(file) {}

    std::vector<Assembly> read() {
        constexpr std::string_view kRemark = "REMARK 350";
        bool begun = false;
        while (lines_.next()) {
            std::string_view line = lines_.line();
            // Remarks stand before the atoms: no need to look through these.
            if (record_of(line) == Record::atom) break;
            if (!line.starts_with(kRemark)) {
                if (begun) break;
                continue;
            }
            begun = true;
            line.remove_prefix(kRemark.size());
            read_line(trim(line));
        }
        return std::move(assemblies_);
    }

  private:
    void read_line(std::string_view line) {
        if (line.starts_with("BIOMOLECULE:")) {
            assemblies_.push_back({std::string(trim(line.substr(12))), {}});
        } else if (line.starts_with("APPLY THE FOLLOWING TO CHAINS:")) {
            current().copies.push_back({});
            add_chains(line.substr(30));
        } else if (line.starts_with("AND CHAINS:")) {
            add_chains(line.substr(11));
        } else if (line.starts_with("BIOMT")) {
            add_row(line);
        }
    }

    Assembly& current() {
        if (assemblies_.empty()) assemblies_.push_back({"1", {}});
        return assemblies_.back();
    }
    Assembly::Copies& copies() {
        if (current().copies.empty()) current().copies.push_back({});
        return current().copies.back();
    }
    void add_chains(std::string_view list) {
        for (const std::string_view chain : split(list, ',')) {
            if (!chain.empty()) copies().asyms.emplace_back(chain);
        }
    }

    /// "BIOMT2   1  0.000000  1.000000  0.000000        0.00000"
    void add_row(std::string_view line) {
        const char digit = line.size() > 5 ? line[5] : ' ';
        take_word(line);
        take_word(line);
        std::array<double, 4> row{};
        for (double& number : row) {
            const auto value = parse_double(take_word(line));
            if (!value || !(std::abs(*value) <= kLargestCoordinate)) {
                throw InputError(file_, lines_.number(),
                                 "expected four numbers after BIOMT; repair or remove the line");
            }
            number = *value;
        }
        const int axis = digit - '1';
        if (axis < 0 || axis > 2) return;
        std::copy_n(row.begin(), 3, motion_.rotation.begin() + std::ptrdiff_t{3} * axis);
        (axis == 0 ? motion_.shift.x : axis == 1 ? motion_.shift.y : motion_.shift.z) = row[3];
        if (axis == 2) copies().motions.push_back(motion_);
    }

    LineCursor lines_;
    const std::filesystem::path& file_;
    std::vector<Assembly> assemblies_;
    Motion motion_;
};

/// Of the CRYST1 record, which stands before the atoms; empty where there is none.
std::string_view space_group(std::string_view text) {
    constexpr std::size_t kColumn = 55;
    constexpr std::size_t kWidth = 11;
    LineCursor lines(text);
    while (lines.next() && record_of(lines.line()) != Record::atom) {
        const std::string_view line = lines.line();
        if (line.starts_with("CRYST1") && line.size() > kColumn) {
            return trim(line.substr(kColumn, kWidth));
        }
    }
    return {};
}

FileContents read_pdb(const std::filesystem::path& file, const ReadOptions& options) {
    const std::string text = read_text(file);
    PdbFrame frame;
    const int frames = find_frame(text, options.frame, frame);
    if (frames > 0) check_frame(options.frame, frames, file);
    const gemmi::Structure structure = parse_frame(frame, file);
    MoleculeBuilder molecule;
    molecule.reserve(frame.atoms);
    molecule.set_fields(kFields);
    for (const gemmi::Chain& chain : structure.models.front().chains) add_chain(molecule, chain);
    for (Assembly& assembly : AssemblyRemarks(text, file).read()) {
        molecule.add_assembly(std::move(assembly));
    }
    if (const std::string_view group = space_group(text); !group.empty()) {
        molecule.set_space_group(group);
    }
    return std::move(molecule).finish(file, "PDB", frames, options);
}

constexpr std::array<std::string_view, 3> kExtensions{"pdb", "ent", "pdb1"};

}  // namespace

Reader pdb_reader() { return {"PDB", kExtensions, read_pdb}; }

}  // namespace ink
