// MDL molfiles and SD files: CTfile Formats, Biovia 2016.

#include <fmt/format.h>

#include <algorithm>
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

/// One molecule of an SD file as it lies in the text.
struct SdfRecord {
    std::string_view text;
    std::size_t lines_before = 0;
};

/// Records end with a line "$$$$"; a MOL file is a single one without it. Returns how many there
/// are.
int find_record(std::string_view text, int wanted, SdfRecord& found) {
    int count = 0;
    std::string_view begin = text;
    std::size_t lines_before = 0;
    LineCursor lines(text);
    const auto close = [&] {
        const std::string_view record = begin.substr(0, begin.size() - lines.rest().size());
        const bool is_blank = trim(record).empty();
        if (!is_blank && count == wanted) found = {record, lines_before};
        if (!is_blank) ++count;
        begin = lines.rest();
        lines_before = lines.number();
    };
    while (lines.next()) {
        if (lines.line().starts_with("$$$$")) close();
    }
    close();
    return count;
}

/// Reads one record line by line.
class RecordReader {
  public:
    RecordReader(const SdfRecord& record, const std::filesystem::path& file)
        : lines_(record.text), lines_before_(record.lines_before), file_(file) {}

    /// Throws InputError.
    void run() {
        for (int i = 0; i < 3; ++i) step("the header");
        step("the counts line");
        if (lines_.line().find("V3000") == std::string_view::npos) {
            read_v2000();
        } else {
            read_v3000();
        }
    }
    /// Whether all of four or more atoms have z = 0.
    bool is_flat() const { return flat_ && atoms_ > 3; }
    MoleculeBuilder& molecule() { return molecule_; }

  private:
    void read_v2000();
    void read_v2000_atom();
    void read_v2000_bond();

    void read_v3000();
    void read_v3000_atoms();
    void read_v3000_atom();
    void read_v3000_bonds(std::size_t bonds);
    void skip_to(std::string_view what);
    std::string next_v3000(std::string_view what);

    void step(std::string_view what) {
        if (lines_.next() && !lines_.line().starts_with("$$$$")) return;
        throw fail(
            fmt::format("the molecule ends inside {}; copy the file again if it was cut", what));
    }
    FilePlace place() const { return {file_, lines_before_ + lines_.number()}; }
    InputError fail(std::string_view problem) const { return {file_, place().line, problem}; }
    /// Columns `first` to `last` of the line, from 1, as the format's description counts them.
    std::string_view columns(std::size_t first, std::size_t last) const {
        const std::string_view line = lines_.line();
        if (line.size() < first) return {};
        return line.substr(first - 1, last - first + 1);
    }
    void add_atom(Vec3d position, std::string_view symbol) {
        flat_ = flat_ && position.z == 0.0;
        molecule_.add_atom(position, atomic_number(symbol).value_or(0), symbol);
    }
    std::size_t count(std::string_view text, std::string_view of) const {
        const std::optional<std::int64_t> value = parse_int(text);
        if (value && *value >= 0) return static_cast<std::size_t>(*value);
        throw fail(fmt::format("expected the number of {}, found {}; repair the counts line", of,
                               excerpt(trim(text))));
    }

    LineCursor lines_;
    std::size_t lines_before_;
    const std::filesystem::path& file_;
    std::size_t atoms_ = 0;
    MoleculeBuilder molecule_;
    bool flat_ = true;
    std::unordered_map<std::int64_t, std::size_t> v3000_atoms_;  ///< by their numbers
};

void RecordReader::read_v2000() {
    if (lines_.line().size() < 6) {
        throw fail(
            fmt::format("the counts line {} is too short; expected two numbers of three "
                        "columns each and V2000",
                        excerpt(lines_.line())));
    }
    atoms_ = count(columns(1, 3), "atoms");
    const std::size_t bonds = count(columns(4, 6), "bonds");
    molecule_.begin_bonds();
    for (std::size_t i = 0; i < atoms_; ++i) {
        step("its atoms");
        read_v2000_atom();
    }
    for (std::size_t i = 0; i < bonds; ++i) {
        step("its bonds");
        read_v2000_bond();
    }
}

void RecordReader::read_v2000_atom() {
    const Vec3d position =
        parse_position(columns(1, 10), columns(11, 20), columns(21, 30), place());
    const std::string_view symbol = trim(columns(32, 34));
    if (symbol.empty()) {
        throw fail("the atom has no element in columns 32 to 34; repair or remove the atom");
    }
    add_atom(position, symbol);
}

void RecordReader::read_v2000_bond() {
    std::array<std::size_t, 2> ends{};
    const std::array<std::string_view, 2> texts{columns(1, 3), columns(4, 6)};
    for (std::size_t end = 0; end < 2; ++end) {
        const std::int64_t atom = parse_int(texts[end]).value_or(0);
        if (atom < 1 || static_cast<std::size_t>(atom) > atoms_) {
            throw fail(fmt::format(
                "the bond names atom {}, but there are {} atoms; repair or remove the bond",
                excerpt(trim(texts[end])), atoms_));
        }
        ends[end] = static_cast<std::size_t>(atom) - 1;
    }
    molecule_.add_bond(ends[0], ends[1]);
}

/// The next line after "M  V30 ", with its continuation lines (a dash at the end) appended.
std::string RecordReader::next_v3000(std::string_view what) {
    constexpr std::string_view kPrefix = "M  V30 ";
    std::string text;
    do {
        if (text.ends_with('-')) text.pop_back();
        step(what);
        const std::string_view line = lines_.line();
        if (!line.starts_with(kPrefix)) {
            throw fail(
                fmt::format("expected 'M  V30' inside {}, found {}; copy the file again if "
                            "it was cut",
                            what, excerpt(line)));
        }
        text += line.substr(kPrefix.size());
    } while (text.ends_with('-'));
    return text;
}

void RecordReader::skip_to(std::string_view what) {
    while (!std::string_view(next_v3000("its V3000 table")).starts_with(what)) {
    }
}

void RecordReader::read_v3000() {
    skip_to("BEGIN CTAB");
    const std::string text = next_v3000("the counts");
    std::string_view counts = text;
    if (take_word(counts) != "COUNTS") {
        throw fail(fmt::format("expected COUNTS, found {}; repair the V3000 table", excerpt(text)));
    }
    atoms_ = count(take_word(counts), "atoms");
    const std::size_t bonds = count(take_word(counts), "bonds");
    skip_to("BEGIN ATOM");
    read_v3000_atoms();
    if (bonds > 0) {
        skip_to("BEGIN BOND");
        read_v3000_bonds(bonds);
    }
}

void RecordReader::read_v3000_atoms() {
    molecule_.begin_bonds();
    for (std::size_t i = 0; i < atoms_; ++i) read_v3000_atom();
    if (trim(next_v3000("its atoms")) != "END ATOM") {
        throw fail(fmt::format("expected END ATOM after {} atoms; repair the counts line", atoms_));
    }
}

void RecordReader::read_v3000_atom() {
    const std::string text = next_v3000("its atoms");
    std::string_view rest = text;
    const std::optional<std::int64_t> number = parse_int(take_word(rest));
    const std::string_view symbol = take_word(rest);
    if (!number || *number < 1 || symbol.empty()) {
        throw fail(
            fmt::format("expected an atom (number, element, x, y, z), found {}; the "
                        "counts line announces {} atoms",
                        excerpt(text), atoms_));
    }
    const std::string_view x = take_word(rest);
    const std::string_view y = take_word(rest);
    const std::string_view z = take_word(rest);
    const Vec3d position = parse_position(x, y, z, place());
    v3000_atoms_[*number] = molecule_.atom_count();
    add_atom(position, symbol);
}

void RecordReader::read_v3000_bonds(std::size_t bonds) {
    for (std::size_t i = 0; i < bonds; ++i) {
        const std::string text = next_v3000("its bonds");
        std::string_view rest = text;
        take_word(rest);
        take_word(rest);
        std::array<std::size_t, 2> ends{};
        for (std::size_t& end : ends) {
            const std::string_view word = take_word(rest);
            const auto atom = v3000_atoms_.find(parse_int(word).value_or(0));
            if (atom == v3000_atoms_.end()) {
                throw fail(
                    fmt::format("the bond names atom {}, which the molecule does not have; "
                                "repair or remove the bond",
                                excerpt(word)));
            }
            end = atom->second;
        }
        molecule_.add_bond(ends[0], ends[1]);
    }
}

FileContents read_sdf(const std::filesystem::path& file, const ReadOptions& options) {
    const std::string text = read_text(file);
    SdfRecord record;
    const int frames = find_record(text, options.frame, record);
    if (frames == 0) throw InputError(file, "is blank; is it an SDF file?");
    check_frame(options.frame, frames, file);
    RecordReader reader(record, file);
    reader.run();
    FileContents contents = std::move(reader.molecule()).finish(file, "SDF", frames, options);
    if (reader.is_flat()) {
        contents.warnings.emplace_back(
            "All atoms have z = 0: the file seems to hold a flat drawing, not a 3D structure.");
    }
    return contents;
}

constexpr std::array<std::string_view, 3> kExtensions{"sdf", "sd", "mol"};

}  // namespace

Reader sdf_reader() { return {"SDF", kExtensions, read_sdf}; }

}  // namespace ink
