// LAMMPS dumps in text: https://docs.lammps.org/dump.html

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/memory.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/molecule_file.h"
#include "io/particle_file.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

/// One frame as it lies in the text, its rows not looked into yet.
struct DumpFrame {
    std::size_t atoms = 0;
    std::string_view box_kind;  ///< what follows "BOX BOUNDS"
    std::array<std::string_view, 3> box;
    std::size_t box_line = 0;
    std::string_view columns;
    std::string_view rows;
    std::size_t lines_before_rows = 0;
    std::string_view units;
};

/// Walks over the frames of a dump.
class DumpFrames {
  public:
    DumpFrames(const Path& file, std::string_view text) : file_(file), lines_(text) {}

    /// Reads the next frame's headings and steps over its rows. False at the end of the file.
    bool next(DumpFrame& frame) {
        frame = {};
        cut_ = false;
        bool begun = false;
        std::optional<std::size_t> atoms;
        while (lines_.next()) {
            const std::string_view line = lines_.line();
            if (trim(line).empty()) continue;
            begun = true;
            if (line.starts_with("ITEM: TIMESTEP")) {
                step("the time step");
            } else if (line.starts_with("ITEM: UNITS")) {
                frame.units = trim(step("the units"));
            } else if (line.starts_with("ITEM: TIME")) {
                step("the time");
            } else if (line.starts_with("ITEM: NUMBER OF ATOMS")) {
                atoms = count(step("the number of atoms"));
            } else if (line.starts_with("ITEM: BOX BOUNDS")) {
                frame.box_kind = trim(line.substr(16));
                frame.box_line = lines_.number() + 1;
                for (std::string_view& bounds : frame.box) bounds = step("the box");
            } else if (line.starts_with("ITEM: ATOMS")) {
                if (!atoms) fail("'ITEM: ATOMS' comes before 'ITEM: NUMBER OF ATOMS'");
                frame.atoms = *atoms;
                frame.columns = trim(line.substr(11));
                skip_rows(frame);
                return true;
            } else {
                fail(fmt::format("expected an 'ITEM:' line, found {}", excerpt(line)));
            }
        }
        // A writer that was stopped leaves the headings of a frame.
        cut_ = begun;
        return false;
    }

    bool last_is_cut() const { return cut_; }
    std::size_t missing() const { return missing_; }  ///< rows of the frame before

  private:
    [[noreturn]] void fail(std::string_view problem) const {
        throw InputError(
            file_, lines_.number(),
            fmt::format("{}; repair the dump, or copy it again if it was cut", problem));
    }
    std::string_view step(std::string_view what) {
        if (!lines_.next()) fail(fmt::format("the file ends before {}", what));
        return lines_.line();
    }
    std::size_t count(std::string_view text) const {
        const auto value = parse_int(text);
        if (!value || *value < 0)
            fail(fmt::format("expected a number of atoms, found {}", excerpt(text)));
        return static_cast<std::size_t>(*value);
    }
    void skip_rows(DumpFrame& frame) {
        frame.lines_before_rows = lines_.number();
        const std::string_view begin = lines_.rest();
        missing_ = frame.atoms;
        while (missing_ > 0 && lines_.next()) --missing_;
        frame.rows = begin.substr(0, begin.size() - lines_.rest().size());
    }

    const Path& file_;
    LineCursor lines_;
    std::size_t missing_ = 0;
    bool cut_ = false;
};

/// Turns fractions of the box into coordinates.
struct Box {
    Vec3d lower;
    Vec3d a, b, c;  ///< edges

    Vec3d operator()(Vec3d fraction) const {
        return lower + a * fraction.x + b * fraction.y + c * fraction.z;
    }
};

/// Three lines of "lo hi", with a tilt factor each where the box is triclinic.
Box read_box(const Path& file, const DumpFrame& frame) {
    std::array<std::array<double, 3>, 3> numbers{};
    const bool triclinic = frame.box_kind.starts_with("xy xz yz");
    if (frame.box_kind.starts_with("abc")) {
        throw InputError(
            file, frame.box_line,
            "a general triclinic box with scaled coordinates cannot be read; dump x, y, "
            "z instead");
    }
    for (std::size_t row = 0; row < 3; ++row) {
        std::string_view line = frame.box[row];
        for (std::size_t k = 0; k < (triclinic ? 3U : 2U); ++k) {
            const auto value = parse_double(take_word(line));
            if (value && std::abs(*value) <= kLargestCoordinate) {
                numbers[row][k] = *value;
                continue;
            }
            throw InputError(
                file, frame.box_line + row,
                fmt::format("the bounds of the box {} are not numbers; repair the dump",
                            excerpt(frame.box[row])));
        }
    }
    const double xy = numbers[0][2];
    const double xz = numbers[1][2];
    const double yz = numbers[2][2];
    // The bounds are those of the tilted box's bounding box (LAMMPS, Howto_triclinic).
    const double xlo = numbers[0][0] - std::min({0.0, xy, xz, xy + xz});
    const double xhi = numbers[0][1] - std::max({0.0, xy, xz, xy + xz});
    const double ylo = numbers[1][0] - std::min(0.0, yz);
    const double yhi = numbers[1][1] - std::max(0.0, yz);
    return {{xlo, ylo, numbers[2][0]},
            {xhi - xlo, 0, 0},
            {xy, yhi - ylo, 0},
            {xz, yz, numbers[2][1] - numbers[2][0]}};
}

/// Where coordinates are not scaled, nothing needs the box; but something is wrong with the file.
void warn_about_box(const DumpFrame& frame, std::vector<std::string>& warnings) {
    if (frame.box_line == 0) return;
    for (std::size_t row = 0; row < frame.box.size(); ++row) {
        std::string_view bounds = frame.box[row];
        const auto lower = parse_double(take_word(bounds));
        const auto upper = parse_double(take_word(bounds));
        if (lower && upper) continue;
        warnings.push_back(
            fmt::format("Line {}: the bounds of the box are not numbers; they are not needed here.",
                        frame.box_line + row));
        return;
    }
}

std::vector<std::string> column_names(std::string_view line) {
    std::vector<std::string> names;
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
        names.emplace_back(word);
    }
    return names;
}

/// Places in the box's fractions become places in space.
void unscale(const Box& box, std::array<bool, 3> scaled, Particles& particles) {
    const Vec3d origin = particles.origin;
    const auto place = [&](Vec3d p) {
        const Vec3d fractional{scaled[0] ? p.x : 0.0, scaled[1] ? p.y : 0.0, scaled[2] ? p.z : 0.0};
        Vec3d result = box(fractional);
        if (!scaled[0]) result.x = p.x;
        if (!scaled[1]) result.y = p.y;
        if (!scaled[2]) result.z = p.z;
        return result;
    };
    particles.origin = place(origin);
    for (Vec3f& p : particles.positions)
        p = to_float(place(origin + to_double(p)) - particles.origin);
}

std::string_view length_unit(std::string_view units) {
    if (units == "real" || units == "metal") return "angstrom";
    if (units == "si") return "m";
    return units == "cgs" ? "cm" : "";
}

/// Frees `text`, to which `frame` refers, when it is not needed any more.
FileContents read_frame(const Path& file, std::string& text, const DumpFrame& frame, int frames,
                        std::vector<std::string> warnings, const ReadOptions& options) {
    ParticleColumns columns(file, column_names(frame.columns), options);
    // A row has at least a digit and a line end for each coordinate.
    columns.reserve(std::min(frame.atoms, frame.rows.size() / 6 + 1));
    LineCursor rows(frame.rows);
    std::string problem;
    while (rows.next()) {
        if (columns.add_row(rows.line(), ' ', problem)) continue;
        const std::string_view remedy = columns.remedy().empty()
                                            ? "does the frame have fewer atoms than it says?"
                                            : columns.remedy();
        throw InputError(file, frame.lines_before_rows + rows.number(),
                         fmt::format("{}; {}", problem, remedy));
    }
    FileContents contents;
    contents.frames = frames;
    contents.fields = columns.summaries();
    contents.warnings = std::move(warnings);
    const std::array<bool, 3> scaled = columns.scaled();
    if (scaled[0] || scaled[1] || scaled[2]) {
        unscale(read_box(file, frame), scaled, columns.particles());
    } else {
        warn_about_box(frame, contents.warnings);
    }
    contents.length_unit = length_unit(frame.units);
    release(text);
    return particle_contents(file, "LAMMPS dump", std::move(columns.particles()),
                             std::move(contents), options);
}

FileContents read_dump(const Path& file, const ReadOptions& options) {
    std::string text = read_text(file);
    DumpFrames dump(file, text);
    DumpFrame frame;
    DumpFrame wanted;
    std::vector<std::string> warnings;
    int frames = 0;
    while (dump.next(frame)) {
        if (dump.missing() > 0) {
            // A run that is still going leaves its last frame cut.
            if (frames > 0 && frames != options.frame) break;
            throw InputError(file, frame.lines_before_rows,
                             fmt::format("the frame announces {} atoms, but only {} rows follow; "
                                         "copy the dump again if it was cut",
                                         frame.atoms, frame.atoms - dump.missing()));
        }
        if (frames == options.frame) wanted = frame;
        ++frames;
    }
    if (dump.last_is_cut() || dump.missing() > 0) {
        warnings.emplace_back("The last frame is cut short and was left out.");
    }
    if (frames == 0) throw InputError(file, "has no 'ITEM: ATOMS'; is it a LAMMPS dump in text?");
    check_frame(options.frame, frames, file);
    return read_frame(file, text, wanted, frames, std::move(warnings), options);
}

constexpr std::array<std::string_view, 2> kExtensions{"dump", "lammpstrj"};

}  // namespace

Reader lammps_reader() { return {"LAMMPS dump", kExtensions, read_dump}; }

}  // namespace ink
