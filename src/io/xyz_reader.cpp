#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/molecule_file.h"
#include "io/particle_file.h"
#include "scene/elements.h"

namespace ink {

namespace {

/// A property of real or whole numbers in a frame of extended XYZ.
struct Quantity {
    std::string name;
    std::size_t column = 0;  ///< of its first component
    std::size_t components = 1;
};

/// Where a row keeps what is drawn. The default is plain XYZ: symbol x y z.
struct Columns {
    std::optional<std::size_t> species = 0;  ///< none: rows are particles, not atoms
    std::size_t position = 1;                ///< of x; y and z follow
    std::size_t count = 4;                   ///< that every row must have at least
    std::optional<std::size_t> radius = std::nullopt;
    std::vector<Quantity> quantities = {};
    std::vector<std::string> names = {};  ///< a column each, of extended XYZ
};

/// One frame as it lies in the text, not looked into yet.
struct RawFrame {
    std::size_t count_line = 0;
    std::size_t atoms = 0;
    std::string_view comment;
    std::string_view rows;
};

[[noreturn]] void throw_bad_count(std::string_view text, FilePlace place) {
    throw InputError(place.file, place.line,
                     fmt::format("expected a number of atoms, found {}; a count line must be "
                                 "followed by one comment and that many rows",
                                 excerpt(trim(text))));
}

std::size_t parse_count(std::string_view text, FilePlace place) {
    const std::optional<std::int64_t> count = parse_int(text);
    if (!count || *count < 0) throw_bad_count(text, place);
    return static_cast<std::size_t>(*count);
}

/// Steps over the rows of a frame; the number of rows that are missing.
std::size_t skip_rows(LineCursor& lines, RawFrame& frame) {
    const std::string_view begin = lines.rest();
    std::size_t missing = frame.atoms;
    while (missing > 0 && lines.next()) --missing;
    frame.rows = begin.substr(0, begin.size() - lines.rest().size());
    return missing;
}

/// The value of Properties= in the comment of an extended XYZ frame.
std::optional<std::string_view> properties(std::string_view comment) {
    constexpr std::string_view kKey = "properties=";
    const std::size_t begin = to_lower(comment).find(kKey);
    if (begin == std::string::npos) return std::nullopt;
    std::string_view value = comment.substr(begin + kKey.size());
    if (value.starts_with('"')) {
        value.remove_prefix(1);
        return value.substr(0, value.find('"'));
    }
    return take_word(value);
}

/// Of the columns of a property: as in tables, for particles.
void add_names(std::string_view property, std::size_t width, std::vector<std::string>& names) {
    for (std::size_t k = 0; k < width; ++k) {
        if (to_lower(property) == "pos") {
            names.emplace_back(1, "xyz"[std::min<std::size_t>(k, 2)]);
        } else {
            names.push_back(width == 1 ? std::string(property) : fmt::format("{}:{}", property, k));
        }
    }
}

/// Reads "species:S:1:pos:R:3:...".
Columns parse_columns(std::string_view text, FilePlace place) {
    constexpr std::int64_t kMostColumns = 1000;
    const auto check = [&](bool good, std::string_view problem) {
        if (good) return;
        throw InputError(place.file, place.line,
                         fmt::format("{} in Properties={}; expected name:type:count, as in "
                                     "species:S:1:pos:R:3",
                                     problem, excerpt(text)));
    };
    const std::vector<std::string_view> fields = split(text, ':');
    check(fields.size() % 3 == 0, "an incomplete entry");
    Columns columns{.species = std::nullopt, .position = 0, .count = 0};
    bool has_position = false;
    for (std::size_t i = 0; i < fields.size(); i += 3) {
        const std::string name = to_lower(fields[i]);
        const std::int64_t width = parse_int(fields[i + 2]).value_or(0);
        check(width >= 1 && width <= kMostColumns, "a wrong number of columns");
        add_names(fields[i], static_cast<std::size_t>(width), columns.names);
        if (name == "species" || (name == "z" && !columns.species)) columns.species = columns.count;
        if (name == "pos") {
            check(width == 3, "a position without three columns");
            columns.position = columns.count;
            has_position = true;
        }
        const std::string type = to_lower(fields[i + 1]);
        const bool is_number = type == "r" || type == "i";
        if (name == "radius" && is_number && width == 1) {
            columns.radius = columns.count;
        } else if (is_number && name != "pos" && name != "z") {
            columns.quantities.push_back(
                {std::string(fields[i]), columns.count, static_cast<std::size_t>(width)});
        }
        columns.count += static_cast<std::size_t>(width);
    }
    check(has_position, "no entry 'pos'");
    return columns;
}

/// "C", "c", "6", "C12" and "Fe3+" are elements; a word such as "Du" stands for no element.
std::uint8_t parse_element(std::string_view text, FilePlace place) {
    if (const std::optional<std::int64_t> number = parse_int(text)) {
        const bool known = *number > 0 && *number < static_cast<std::int64_t>(kElementCount);
        return known ? static_cast<std::uint8_t>(*number) : std::uint8_t{0};
    }
    const auto is_letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
    const auto end = std::ranges::find_if_not(text, is_letter);
    const auto letters = static_cast<std::size_t>(end - text.begin());
    if (letters == 0) {
        throw InputError(place.file, place.line,
                         fmt::format("expected an element symbol such as C, N or Fe, found {}; "
                                     "does the frame have fewer atoms than its count line says?",
                                     excerpt(text)));
    }
    return atomic_number(text.substr(0, letters)).value_or(0);
}

double parse_number(std::string_view word, std::string_view what, FilePlace place) {
    const std::optional<double> number = parse_double(word);
    if (number) return *number;
    throw InputError(
        place.file, place.line,
        fmt::format("{} {} is not a number; repair or remove the atom", what, excerpt(word)));
}

class RowReader {
  public:
    /// The columns have species.
    RowReader(MoleculeBuilder& molecule, const Columns& columns)
        : molecule_(molecule), columns_(columns) {
        words_.resize(columns.count);
        for (const Quantity& quantity : columns.quantities) {
            molecule.add_field(quantity.name, quantity.components);
        }
    }

    void add(std::string_view row, FilePlace place) {
        for (std::size_t column = 0; column < columns_.count; ++column) {
            words_[column] = take_word(row);
            if (!words_[column].empty()) continue;
            throw InputError(place.file, place.line,
                             fmt::format("the row has {} of {} columns; does the frame have fewer "
                                         "atoms than its count line says?",
                                         column, columns_.count));
        }
        const std::uint8_t element = parse_element(words_[*columns_.species], place);
        const std::size_t x = columns_.position;
        molecule_.add_atom(parse_position(words_[x], words_[x + 1], words_[x + 2], place), element);
        add_radius(place);
        for (std::size_t q = 0; q < columns_.quantities.size(); ++q) add_quantity(q, place);
    }

  private:
    void add_radius(FilePlace place) {
        if (!columns_.radius) return;
        const double radius = parse_number(words_[*columns_.radius], "radius", place);
        if (!(radius >= 0.0 && radius <= kLargestCoordinate)) {
            throw InputError(place.file, place.line,
                             "the radius is not a positive number; repair or remove the atom");
        }
        molecule_.set_radius(radius);
    }
    void add_quantity(std::size_t index, FilePlace place) {
        const Quantity& quantity = columns_.quantities[index];
        for (std::size_t c = 0; c < quantity.components; ++c) {
            const std::string_view word = words_[quantity.column + c];
            molecule_.set_value(index, parse_number(word, quantity.name, place), c);
        }
    }

    MoleculeBuilder& molecule_;
    const Columns& columns_;
    std::vector<std::string_view> words_;
};

Columns frame_columns(const RawFrame& frame, const std::filesystem::path& file) {
    const std::optional<std::string_view> text = properties(frame.comment);
    return text ? parse_columns(*text, {file, frame.count_line + 1}) : Columns{};
}

void add_atoms(MoleculeBuilder& molecule, const RawFrame& frame, const Columns& columns,
               const std::filesystem::path& file) {
    molecule.reserve(frame.atoms);
    RowReader reader(molecule, columns);
    LineCursor rows(frame.rows);
    while (rows.next()) {
        reader.add(rows.line(), {file, frame.count_line + 1 + rows.number()});
    }
}

/// The frames of a file: how many, and the one that is wanted.
struct Frames {
    int count = 0;
    RawFrame wanted;
    bool last_is_cut = false;
};

/// A simulation that is still running leaves its last frame cut: that one is left out, unless it is
/// the one to draw.
Frames find_frames(std::string_view text, int wanted, const std::filesystem::path& file) {
    Frames frames;
    LineCursor lines(text);
    while (lines.next()) {
        if (trim(lines.line()).empty()) continue;
        RawFrame frame;
        frame.count_line = lines.number();
        frame.atoms = parse_count(lines.line(), {file, lines.number()});
        if (lines.next()) frame.comment = lines.line();
        if (const std::size_t missing = skip_rows(lines, frame); missing > 0) {
            if (frames.count > 0 && frames.count != wanted) {
                frames.last_is_cut = true;
                break;
            }
            throw InputError(file, frame.count_line,
                             fmt::format("announces {} atoms, but only {} rows follow; correct the "
                                         "count, or copy the file again if it was cut",
                                         frame.atoms, frame.atoms - missing));
        }
        if (frames.count == wanted) frames.wanted = frame;
        ++frames.count;
    }
    return frames;
}

constexpr std::string_view kCutFrame = "The last frame is cut short and was left out.";

/// What has no elements is no molecule.
FileContents read_particles(const Frames& frames, const Columns& columns,
                            const std::filesystem::path& file, const ReadOptions& options) {
    ParticleColumns particles(file, columns.names, options);
    LineCursor rows(frames.wanted.rows);
    std::string problem;
    while (rows.next()) {
        if (particles.add_row(rows.line(), ' ', problem)) continue;
        const std::string_view remedy =
            particles.remedy().empty() ? "does the frame have fewer atoms than its count line says?"
                                       : particles.remedy();
        throw InputError(file, frames.wanted.count_line + 1 + rows.number(),
                         fmt::format("{}; {}", problem, remedy));
    }
    FileContents contents;
    contents.frames = frames.count;
    contents.fields = particles.summaries();
    if (frames.last_is_cut) contents.warnings.emplace_back(kCutFrame);
    return particle_contents(file, "XYZ", std::move(particles.particles()), std::move(contents),
                             options);
}

FileContents read_xyz(const std::filesystem::path& file, const ReadOptions& options) {
    const std::string text = read_text(file);
    const Frames frames = find_frames(text, options.frame, file);
    if (frames.count > 0) check_frame(options.frame, frames.count, file);
    const Columns columns = frame_columns(frames.wanted, file);
    if (!columns.species) return read_particles(frames, columns, file, options);
    MoleculeBuilder molecule;
    add_atoms(molecule, frames.wanted, columns, file);
    if (frames.last_is_cut) molecule.warn(std::string(kCutFrame));
    return std::move(molecule).finish(file, "XYZ", frames.count, options);
}

constexpr std::array<std::string_view, 2> kExtensions{"xyz", "extxyz"};

}  // namespace

Reader xyz_reader() { return {"XYZ", kExtensions, read_xyz}; }

}  // namespace ink
