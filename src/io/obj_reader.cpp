// Wavefront OBJ. Assimp builds the mesh; a scan of the text before it names the lines that make no
// sense, which Assimp reports without their place, or not at all.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/bounds.h"
#include "base/error.h"
#include "base/text.h"
#include "io/assimp_reader.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/polygon_mesh.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

/// What a corner of a face refers to: "f 1/2/3" uses vertex 1, texture coordinate 2, normal 3.
struct Reference {
    std::string_view name;
    std::int64_t count = 0;        ///< defined so far
    std::int64_t highest = 0;      ///< used so far, with
    std::size_t highest_line = 0;  ///< the line that does
};

/// As of take_word.
constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

constexpr bool is_number_character(char c) {
    return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' || c == 'e' || c == 'E';
}

class ObjScan {
  public:
    ObjScan(const Path& file, std::string_view text) : file_(file), lines_(text) {}

    void run() {
        while (lines_.next()) scan(joined_line());
        for (const Reference& reference : references_) check_highest(reference);
        if (references_[0].count == 0) {
            throw InputError(file_, "holds no vertices; is it a Wavefront OBJ file?");
        }
        if (!has_faces_) {
            throw InputError(file_, "holds points, no faces; export the surface with its faces");
        }
    }

    /// The centre of a model that lies far from the origin for its size; else nothing.
    std::optional<Vec3d> far_centre() const {
        constexpr double kFar = 10.0;
        const Vec3d centre = bounds_.centre();
        const bool far = length(centre) > kFar * length(bounds_.extent());
        return movable_ && far ? std::optional(centre) : std::nullopt;
    }

  private:
    [[noreturn]] void refuse(std::string_view problem) const {
        throw InputError(file_, lines_.number(), problem);
    }

    /// A backslash at its end joins a line to the next one.
    std::string_view joined_line() {
        std::string_view line = lines_.line();
        if (!line.ends_with('\\')) return line;
        joined_.clear();
        movable_ = false;
        do {
            joined_.append(line.substr(0, line.size() - 1)).push_back(' ');
            if (!lines_.next()) return joined_;
            line = lines_.line();
        } while (line.ends_with('\\'));
        return joined_.append(line);
    }

    void scan(std::string_view line) {
        while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
        if (line.size() < 2) return;
        if (line[0] == 'f' && is_blank(line[1])) {
            scan_face(line.substr(2));
        } else if (line[0] == 'v') {
            scan_vertex(line.substr(1));
        }
    }

    void scan_vertex(std::string_view rest) {
        if (is_blank(rest.front())) {
            scan_coordinates(rest);
            ++references_[0].count;
        } else if (rest.front() == 't') {
            ++references_[1].count;
        } else if (rest.front() == 'n') {
            ++references_[2].count;
        }
    }

    void scan_coordinates(std::string_view rest) {
        std::array<double, 3> place{};
        std::string_view words = rest;
        std::size_t count = 0;
        for (std::string_view word = take_word(words); !word.empty(); word = take_word(words)) {
            if (word.front() == '#') break;
            const double value = coordinate(word, rest);
            if (count < 3) place[count] = value;
            ++count;
        }
        if (count != 3 && count != 4 && count != 6) {
            refuse(fmt::format("vertex with {} numbers; expected x y z, x y z w or x y z r g b",
                               count));
        }
        movable_ = movable_ && count != 4;
        bounds_.add(Vec3d{place[0], place[1], place[2]});
    }

    /// The number, or 0 for a spelling that only Assimp understands (3.1+e2).
    double coordinate(std::string_view word, std::string_view vertex) {
        if (!std::ranges::all_of(word, is_number_character)) {
            refuse(fmt::format("vertex with a coordinate that is not a number ({}); correct it",
                               excerpt(trim(vertex))));
        }
        if (word.front() == '+') word.remove_prefix(1);
        double value = 0.0;
        const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
        // Too small for a double is no harm; too large is.
        const bool small =
            word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos;
        const bool too_large = result.ec == std::errc::result_out_of_range
                                   ? !small
                                   : !(std::abs(value) <= kLargestCoordinate);
        if (too_large) {
            refuse(fmt::format("vertex with a coordinate beyond 1e15 ({}); correct it",
                               excerpt(trim(vertex))));
        }
        movable_ = movable_ && result.ptr == word.data() + word.size();
        return value;
    }

    void scan_face(std::string_view rest) {
        has_faces_ = true;
        for (;;) {
            while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
            if (rest.empty() || rest.front() == '#') return;
            scan_corner(rest);
        }
    }

    /// Takes "7", "7/1", "7//3" or "7/1/3" off the front.
    void scan_corner(std::string_view& rest) {
        const std::string_view corner = rest;
        for (std::size_t k = 0; k < references_.size(); ++k) {
            const bool skipped =
                k > 0 && (rest.empty() || rest.front() == '/' || is_blank(rest.front()));
            if (!skipped) scan_index(rest, references_[k], corner);
            if (rest.empty() || is_blank(rest.front())) return;
            if (k == 2 || rest.front() != '/') refuse_corner(corner);
            rest.remove_prefix(1);
        }
    }

    void scan_index(std::string_view& rest, Reference& reference, std::string_view corner) {
        std::int64_t index = 0;
        const auto result = std::from_chars(rest.data(), rest.data() + rest.size(), index);
        if (result.ec != std::errc{}) refuse_corner(corner);
        rest.remove_prefix(static_cast<std::size_t>(result.ptr - rest.data()));
        if (index == 0) refuse("face with index 0; OBJ counts from 1: export the file again");
        if (index < -reference.count) {
            refuse(fmt::format("face uses {} {}, but only {} come before it; export the file again",
                               reference.name, index, reference.count));
        }
        // Indices may point forward, so the highest can be judged only at the end.
        if (index > reference.highest) {
            reference.highest = index;
            reference.highest_line = lines_.number();
        }
    }

    [[noreturn]] void refuse_corner(std::string_view corner) const {
        const std::string_view word = take_word(corner);
        refuse(fmt::format("face with the corner {}; expected numbers such as 7, 7/1 or 7/1/3",
                           excerpt(word)));
    }

    void check_highest(const Reference& reference) const {
        if (reference.highest <= reference.count) return;
        throw InputError(
            file_, reference.highest_line,
            fmt::format("face uses {} {}, but there are only {}; export the file again",
                        reference.name, reference.highest, reference.count));
    }

    const Path& file_;
    LineCursor lines_;
    std::string joined_;
    std::array<Reference, 3> references_{Reference{"vertex"}, Reference{"texture coordinate"},
                                         Reference{"normal"}};
    bool has_faces_ = false;
    Bounds3d bounds_;
    bool movable_ = true;  ///< `moved` understands every vertex
};

/// The text with the vertices moved by -centre. Assimp keeps 32 bits of a coordinate: far from the
/// origin they hold the distance and not the shape.
std::string moved(std::string_view text, Vec3d centre) {
    std::string out;
    out.reserve(text.size() + text.size() / 2);
    LineCursor lines(text);
    while (lines.next()) {
        std::string_view rest = lines.line();
        if (take_word(rest) == "v") {
            out += 'v';
            for (const double shift : {centre.x, centre.y, centre.z}) {
                const double value = parse_double(take_word(rest)).value_or(0.0) - shift;
                fmt::format_to(std::back_inserter(out), " {:.12g}", value);
            }
            out += rest;
        } else {
            out += lines.line();
        }
        out += '\n';
    }
    return out;
}

FileContents read_obj(const Path& file, const ReadOptions& /*options*/) {
    std::string text = read_text(file);
    ObjScan scan(file, text);
    scan.run();
    const std::optional<Vec3d> centre = scan.far_centre();
    if (centre) text = moved(text, *centre);
    PolygonMesh mesh = assimp_mesh(file, text, ".obj", "OBJ");
    if (centre) {
        mesh.origin = mesh.origin + *centre;
        mesh.single_precision = false;
    }
    return mesh_contents(file, std::move(mesh));
}

}  // namespace

Reader obj_reader() {
    static constexpr std::array<std::string_view, 1> kExtensions{"obj"};
    return {"OBJ", kExtensions, read_obj};
}

}  // namespace ink
