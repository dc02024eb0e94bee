// Geomview's Object File Format: [ST][C][N]OFF in text, http://www.geomview.org/docs/html/OFF.html.
// Read here rather than by Assimp, which believes the counts.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/memory.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/polygon_mesh.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

class OffReader {
  public:
    OffReader(const Path& file, std::string_view text) : file_(file), text_(text), lines_(text) {}

    PolygonMesh read() {
        read_keyword();
        const std::size_t vertices = count("vertices");
        const std::size_t faces = count("faces");
        // The number of edges is there, but may be anything.
        if (rest_.find_first_not_of(" \t\r") != std::string_view::npos) take_word(rest_);
        // A vertex is at least "0 0 0\n", a face "1 0\n".
        if (vertices > text_.size() / 6 + 1 || faces > text_.size() / 4 + 1) {
            refuse(
                fmt::format("announces {} vertices and {} faces, more than fit in the file; was "
                            "it written to the end?",
                            vertices, faces));
        }
        for (std::size_t i = 0; i < vertices; ++i) read_vertex(i, vertices);
        for (std::size_t i = 0; i < faces; ++i) read_face(i, faces, vertices);
        mesh_.format = "OFF";
        return std::move(mesh_);
    }

  private:
    [[noreturn]] void refuse(std::string_view problem) const {
        throw InputError(file_, std::max<std::size_t>(lines_.number(), 1), problem);
    }

    /// Steps to the next line that says something; false at the end.
    bool next_line() {
        while (lines_.next()) {
            rest_ = lines_.line();
            rest_ = trim(rest_.substr(0, rest_.find('#')));
            if (!rest_.empty()) return true;
        }
        return false;
    }

    void read_keyword() {
        if (!next_line()) throw InputError(file_, "holds no text; is it an OFF file?");
        std::string_view line = rest_;
        const std::string_view word = take_word(line);
        if (!word.ends_with("OFF")) {
            refuse(fmt::format("the first word is {}, not OFF; is it an OFF file?", excerpt(word)));
        }
        std::string_view prefix = word.substr(0, word.size() - 3);
        if (prefix.starts_with("ST")) prefix.remove_prefix(2);
        if (prefix.starts_with("C")) {
            has_colors_ = true;
            prefix.remove_prefix(1);
        }
        if (prefix.starts_with("N")) {
            has_normals_ = true;
            prefix.remove_prefix(1);
        }
        if (!prefix.empty() || trim(line) == "BINARY") {
            refuse(fmt::format("{} cannot be read; write plain OFF in text", excerpt(rest_)));
        }
        rest_ = trim(line);
    }

    std::size_t count(std::string_view what) {
        if (rest_.empty() && !next_line()) refuse(fmt::format("the number of {} is missing", what));
        const std::string_view word = take_word(rest_);
        const std::optional<std::int64_t> value = parse_int(word);
        if (!value || *value < 0) {
            refuse(fmt::format("expected the number of {}, found {}", what, excerpt(word)));
        }
        rest_ = trim(rest_);
        return static_cast<std::size_t>(*value);
    }

    template <std::size_t N>
    std::array<double, N> numbers(std::string_view what) {
        std::array<double, N> values{};
        for (double& value : values) {
            const std::string_view word = take_word(rest_);
            const std::optional<double> number = parse_double(word);
            if (!number) {
                refuse(fmt::format("{} with {} for a number; expected {}", what, excerpt(word), N));
            }
            value = *number;
        }
        return values;
    }

    void read_vertex(std::size_t index, std::size_t count) {
        if (!next_line()) {
            refuse(fmt::format("the file ends after {} of {} vertices; was it written to the end?",
                               index, count));
        }
        const auto place = numbers<3>("vertex");
        if (!mesh_.add_position({place[0], place[1], place[2]})) {
            refuse("vertex with a coordinate that is not finite or beyond 1e15; correct it");
        }
        if (has_normals_) {
            const auto normal = numbers<3>("normal");
            mesh_.normals.push_back(to_float({normal[0], normal[1], normal[2]}));
        }
        if (has_colors_) {
            const std::string_view written = rest_;
            mesh_.colors.push_back(color(written, numbers<3>("colour")));
        }
    }

    /// Whole numbers go to 255, others to 1.
    static Rgb8 color(std::string_view written, std::array<double, 3> c) {
        const double scale = written.find('.') != std::string_view::npos ? 255.0 : 1.0;
        const auto byte = [&](double x) {
            return static_cast<std::uint8_t>(x > 0.0 ? std::lround(std::min(x * scale, 255.0)) : 0);
        };
        return {byte(c[0]), byte(c[1]), byte(c[2])};
    }

    void read_face(std::size_t index, std::size_t count, std::size_t vertices) {
        if (!next_line()) {
            refuse(fmt::format("the file ends after {} of {} faces; was it written to the end?",
                               index, count));
        }
        const std::string_view word = take_word(rest_);
        const std::optional<std::int64_t> corners = parse_int(word);
        if (!corners || *corners < 0) {
            refuse(fmt::format("expected a face's number of corners, found {}", excerpt(word)));
        }
        for (std::int64_t k = 0; k < *corners; ++k) {
            const std::string_view corner = take_word(rest_);
            const std::optional<std::int64_t> vertex = parse_int(corner);
            if (!vertex || *vertex < 0 || static_cast<std::size_t>(*vertex) >= vertices) {
                refuse(
                    fmt::format("face {} uses vertex {}, but they go from 0 to {}; the file is "
                                "damaged: export it again",
                                index, excerpt(corner), vertices - 1));
            }
            mesh_.corners.push_back(static_cast<std::uint32_t>(*vertex));
        }
        mesh_.end_polygon();
    }

    const Path& file_;
    std::string_view text_;
    LineCursor lines_;
    std::string_view rest_;  ///< of the line
    bool has_colors_ = false;
    bool has_normals_ = false;
    PolygonMesh mesh_;
};

FileContents read_off(const Path& file, const ReadOptions& /*options*/) {
    std::string text = read_text(file);
    PolygonMesh mesh = OffReader(file, text).read();
    release(text);
    return mesh_contents(file, std::move(mesh));
}

}  // namespace

Reader off_reader() {
    static constexpr std::array<std::string_view, 1> kExtensions{"off"};
    return {"OFF", kExtensions, read_off};
}

}  // namespace ink
