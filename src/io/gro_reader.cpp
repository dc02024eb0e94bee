// GROMACS coordinate files: a title, a count, atoms in columns, the box; again for each frame.

#include <fmt/format.h>

#include <array>
#include <optional>

#include "base/error.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/molecule_file.h"

namespace ink {

namespace {

constexpr double kAngstromPerNm = 10.0;

/// One frame as it lies in the text, not looked into yet.
struct GroFrame {
    std::string_view rows;
    std::size_t lines_before = 0;  ///< before its rows
    std::size_t atoms = 0;
};

std::size_t parse_count(std::string_view text, FilePlace place) {
    const std::optional<std::int64_t> count = parse_int(text);
    if (count && *count >= 0) return static_cast<std::size_t>(*count);
    throw InputError(place.file, place.line,
                     fmt::format("expected the number of atoms, found {}; a frame is a title, a "
                                 "count, that many atoms and the box",
                                 excerpt(trim(text))));
}

/// Steps over the frames; `found` becomes the one that is wanted. Returns how many there are.
int find_frame(std::string_view text, int wanted, GroFrame& found,
               const std::filesystem::path& file) {
    int count = 0;
    LineCursor lines(text);
    while (lines.next()) {
        if (trim(lines.line()).empty() && trim(lines.rest()).empty()) break;
        if (!lines.next()) throw InputError(file, lines.number(), "the file ends after a title");
        GroFrame frame;
        frame.atoms = parse_count(lines.line(), {file, lines.number()});
        frame.lines_before = lines.number();
        const std::string_view begin = lines.rest();
        std::size_t missing = frame.atoms;
        while (missing > 0 && lines.next()) --missing;
        frame.rows = begin.substr(0, begin.size() - lines.rest().size());
        if (missing > 0 || !lines.next()) {
            throw InputError(file, frame.lines_before,
                             fmt::format("announces {} atoms and a box, but only {} lines follow; "
                                         "correct the count, or copy the file again if it was cut",
                                         frame.atoms, frame.atoms - missing));
        }
        if (count == wanted) found = frame;
        ++count;
    }
    return count;
}

/// Columns of one coordinate: as far as one decimal point is from the next.
std::size_t coordinate_width(std::string_view line, FilePlace place) {
    constexpr std::size_t kFirst = 20;
    const std::size_t first = line.find('.', kFirst);
    const std::size_t second = first == std::string_view::npos ? first : line.find('.', first + 1);
    if (second != std::string_view::npos) return second - first;
    throw InputError(place.file, place.line,
                     fmt::format("expected three coordinates from column 21 on, found {}; does the "
                                 "frame have fewer atoms than its count says?",
                                 excerpt(trim(line))));
}

class RowReader {
  public:
    RowReader(MoleculeBuilder& molecule, const std::filesystem::path& file)
        : molecule_(molecule), file_(file) {}

    void add(std::string_view line, std::size_t number) {
        const FilePlace place{file_, number};
        const auto columns = [&](std::size_t begin, std::size_t width) {
            return begin < line.size() ? line.substr(begin, width) : std::string_view();
        };
        if (width_ == 0) width_ = coordinate_width(line, place);
        const Vec3d nm = parse_position(columns(20, width_), columns(20 + width_, width_),
                                        columns(20 + 2 * width_, width_), place);
        const std::string_view residue = trim(columns(5, 5));
        enter_residue(columns(0, 5), residue);
        const std::string_view name = trim(columns(10, 5));
        molecule_.add_atom(nm * kAngstromPerNm, element_of_name(name, residue), name);
    }

  private:
    void enter_residue(std::string_view number, std::string_view name) {
        if (!molecule_.empty() && number == number_ && name == name_) return;
        number_ = number;
        name_ = name;
        molecule_.begin_residue("", name, static_cast<std::int32_t>(parse_int(number).value_or(0)));
    }

    MoleculeBuilder& molecule_;
    const std::filesystem::path& file_;
    std::size_t width_ = 0;
    std::string_view number_, name_;  ///< of the residue
};

FileContents read_gro(const std::filesystem::path& file, const ReadOptions& options) {
    const std::string text = read_text(file);
    GroFrame frame;
    const int frames = find_frame(text, options.frame, frame, file);
    if (frames > 0) check_frame(options.frame, frames, file);
    MoleculeBuilder molecule;
    molecule.reserve(frame.atoms);
    RowReader reader(molecule, file);
    LineCursor rows(frame.rows);
    while (rows.next()) reader.add(rows.line(), frame.lines_before + rows.number());
    return std::move(molecule).finish(file, "GRO", frames, options);
}

constexpr std::array<std::string_view, 1> kExtensions{"gro"};

}  // namespace

Reader gro_reader() { return {"GRO", kExtensions, read_gro}; }

}  // namespace ink
