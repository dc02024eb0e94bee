// Tripos MOL2: Tripos Mol2 File Format, Tripos 2005.

#include <fmt/format.h>

#include <array>
#include <optional>
#include <unordered_map>

#include "base/error.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/molecule_file.h"
#include "scene/elements.h"

namespace ink {

namespace {

constexpr std::string_view kSection = "@<TRIPOS>";

/// The lines of one molecule, and how many molecules there are.
struct Mol2Record {
    std::string_view text;
    std::size_t lines_before = 0;
};

int find_record(std::string_view text, int wanted, Mol2Record& found) {
    int count = 0;
    LineCursor lines(text);
    std::string_view rest = text;
    const auto close = [&] {
        if (count - 1 == wanted) found.text = found.text.substr(0, found.text.size() - rest.size());
    };
    for (;;) {
        rest = lines.rest();
        const std::size_t before = lines.number();
        if (!lines.next()) break;
        if (!lines.line().starts_with("@<TRIPOS>MOLECULE")) continue;
        close();
        if (count == wanted) found = {rest, before};
        ++count;
    }
    if (count - 1 != wanted) return count;
    rest = {};
    close();
    return count;
}

/// Reads one molecule section by section.
class RecordReader {
  public:
    RecordReader(const Mol2Record& record, const std::filesystem::path& file)
        : lines_(record.text), lines_before_(record.lines_before), file_(file) {
        molecule_.set_fields(kFields);
    }

    void run() {
        std::string_view section;
        while (lines_.next()) {
            const std::string_view line = lines_.line();
            if (line.starts_with(kSection)) {
                section = trim(line.substr(kSection.size()));
                if (section == "BOND") molecule_.begin_bonds();
                continue;
            }
            if (trim(line).empty() || line.front() == '#') continue;
            if (section == "MOLECULE") read_header(line);
            if (section == "ATOM") read_atom(line);
            if (section == "BOND") read_bond(line);
        }
        if (molecule_.atom_count() >= announced_) return;
        throw fail(
            fmt::format("announces {} atoms, but {} follow; copy the file again if it was cut",
                        announced_, molecule_.atom_count()));
    }
    MoleculeBuilder& molecule() { return molecule_; }

  private:
    static constexpr std::array<std::string_view, 1> kFields{"charge"};

    InputError fail(std::string_view problem) const {
        return {file_, lines_before_ + lines_.number(), problem};
    }

    /// The second line of a header has the counts.
    void read_header(std::string_view line) {
        if (++header_lines_ != 2) return;
        const auto count = parse_int(take_word(line));
        if (!count || *count < 0) throw fail("expected the number of atoms; repair the molecule");
        announced_ = static_cast<std::size_t>(*count);
    }

    void read_atom(std::string_view line) {
        const auto id = parse_int(take_word(line));
        const std::string_view name = take_word(line);
        const std::string_view x = take_word(line);
        const std::string_view y = take_word(line);
        const std::string_view z = take_word(line);
        const Vec3d position = parse_position(x, y, z, {file_, lines_before_ + lines_.number()});
        const std::string_view type = take_word(line);
        if (!id || type.empty()) {
            throw fail(
                fmt::format("expected an atom (number, name, x, y, z, type), found {}; "
                            "repair or remove it",
                            excerpt(lines_.line())));
        }
        const std::string_view number = take_word(line);
        const std::string_view residue = take_word(line);
        if (!residue.empty()) enter_residue(number, residue);
        atoms_[*id] = molecule_.atom_count();
        molecule_.add_atom(position, element_of(type, name), name);
        molecule_.set_value(0, parse_double(take_word(line)).value_or(0.0));
    }

    /// "C.ar" is carbon, "LP" a lone pair, which is no element. Force fields write types of their
    /// own in small letters ("ca" is aromatic carbon); then the name tells.
    static std::uint8_t element_of(std::string_view type, std::string_view name) {
        if (type.front() >= 'a' && type.front() <= 'z') return element_of_name(name, {});
        return atomic_number(type.substr(0, type.find('.'))).value_or(0);
    }

    void enter_residue(std::string_view number, std::string_view name) {
        if (begun_ && number == residue_number_ && name == residue_) return;
        begun_ = true;
        residue_number_ = number;
        residue_ = name;
        const std::int64_t value = parse_int(number).value_or(0);
        molecule_.begin_residue("", name, static_cast<std::int32_t>(value));
    }

    void read_bond(std::string_view line) {
        take_word(line);
        std::array<std::size_t, 2> ends{};
        for (std::size_t& end : ends) {
            const std::string_view word = take_word(line);
            const auto atom = atoms_.find(parse_int(word).value_or(-1));
            if (atom == atoms_.end()) {
                throw fail(
                    fmt::format("the bond names atom {}, which the molecule does not have; "
                                "repair or remove the bond",
                                excerpt(word)));
            }
            end = atom->second;
        }
        if (ends[0] == ends[1]) {
            throw fail("the bond joins an atom with itself; repair or remove the bond");
        }
        molecule_.add_bond(ends[0], ends[1]);
    }

    LineCursor lines_;
    std::size_t lines_before_;
    const std::filesystem::path& file_;
    MoleculeBuilder molecule_;
    std::unordered_map<std::int64_t, std::size_t> atoms_;  ///< by their numbers
    std::size_t announced_ = 0;
    int header_lines_ = 0;
    bool begun_ = false;
    std::string_view residue_number_, residue_;
};

FileContents read_mol2(const std::filesystem::path& file, const ReadOptions& options) {
    const std::string text = read_text(file);
    Mol2Record record;
    const int frames = find_record(text, options.frame, record);
    if (frames == 0) {
        throw InputError(file, "has no line '@<TRIPOS>MOLECULE'; is it a MOL2 file?");
    }
    check_frame(options.frame, frames, file);
    RecordReader reader(record, file);
    reader.run();
    return std::move(reader.molecule()).finish(file, "MOL2", frames, options);
}

constexpr std::array<std::string_view, 1> kExtensions{"mol2"};

}  // namespace

Reader mol2_reader() { return {"MOL2", kExtensions, read_mol2}; }

}  // namespace ink
