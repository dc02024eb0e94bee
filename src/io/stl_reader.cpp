// Stereolithography files, as text or as a count and 50 bytes a triangle. Read here rather than by
// Assimp, which names no line and loses memory when it refuses a file.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/polygon_mesh.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

constexpr std::size_t kHeaderBytes = 84;  ///< 80 of comment, 4 of count
constexpr std::size_t kTriangleBytes = 50;
constexpr std::size_t kCountPlace = 80;

template <class T>
T little_endian(const char* bytes) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes, sizeof(T));
    if constexpr (std::endian::native == std::endian::big) std::ranges::reverse(raw);
    return std::bit_cast<T>(raw);
}

std::size_t promised_triangles(std::string_view bytes) {
    if (bytes.size() < kHeaderBytes) return 0;
    return little_endian<std::uint32_t>(bytes.data() + kCountPlace);
}

/// Many programs begin binary files, too, with "solid"; a size that fits the count decides, then
/// zero bytes, which text does not have.
bool is_text(std::string_view bytes) {
    const bool fits = bytes.size() == kHeaderBytes + kTriangleBytes * promised_triangles(bytes);
    if (fits && bytes.size() > kHeaderBytes) return false;
    const std::string_view start = bytes.substr(0, 4096);
    return to_lower(trim(start).substr(0, 5)) == "solid" &&
           start.find('\0') == std::string_view::npos;
}

void check_size(const Path& file, std::string_view bytes) {
    if (bytes.size() < kHeaderBytes) {
        throw InputError(file,
                         "is not an STL file (too short for a header, and not text that "
                         "begins with 'solid'); check the file's name");
    }
    const std::size_t promised = promised_triangles(bytes);
    const std::size_t held = (bytes.size() - kHeaderBytes) / kTriangleBytes;
    if (promised > held) {
        throw InputError(file, fmt::format("the header promises {} triangles, the file holds {}; "
                                           "was it written to the end?",
                                           promised, held));
    }
}

Vec3d position_at(const char* bytes) {
    return {little_endian<float>(bytes), little_endian<float>(bytes + 4),
            little_endian<float>(bytes + 8)};
}

void add_triangle(const Path& file, const char* record, std::size_t triangle, PolygonMesh& mesh) {
    constexpr std::size_t kNormalBytes = 12;
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const Vec3d position = position_at(record + kNormalBytes + corner * 12);
        mesh.corners.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
        if (mesh.add_position(position)) continue;
        throw InputError(file, fmt::format("a corner of triangle {} lies at ({:g}, {:g}, {:g}), "
                                           "not a usable place; export the model again",
                                           triangle + 1, position.x, position.y, position.z));
    }
    mesh.end_polygon();
}

PolygonMesh read_binary(const Path& file, std::string_view bytes) {
    check_size(file, bytes);
    const std::size_t count = promised_triangles(bytes);
    PolygonMesh mesh;
    mesh.format = "binary STL";
    mesh.single_precision = true;
    mesh.positions.reserve(count * 3);
    mesh.corners.reserve(count * 3);
    mesh.polygon_ends.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        add_triangle(file, bytes.data() + kHeaderBytes + i * kTriangleBytes, i, mesh);
    }
    if (bytes.size() > kHeaderBytes + count * kTriangleBytes) {
        mesh.warnings.emplace_back("The bytes after the last triangle were left out.");
    }
    return mesh;
}

class AsciiStl {
  public:
    AsciiStl(const Path& file, std::string_view text) : file_(file), lines_(text) {}

    PolygonMesh read() {
        while (lines_.next()) read_line(lines_.line());
        if (corners_ != 0) refuse("the file ends in a facet; was it written to the end?");
        if (!ended_) {
            mesh_.warnings.emplace_back(
                "The file does not end in 'endsolid'; some triangles may be missing.");
        }
        if (mesh_.part_names.size() < 2) {
            mesh_.part_names.clear();
            mesh_.parts.clear();
        }
        mesh_.format = "ASCII STL";
        return std::move(mesh_);
    }

  private:
    [[noreturn]] void refuse(std::string_view problem) const {
        throw InputError(file_, lines_.number(), problem);
    }

    void read_line(std::string_view rest) {
        for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
            const std::string keyword = to_lower(word);
            if (keyword == "vertex") {
                read_vertex(rest);
            } else if (keyword == "endfacet") {
                end_facet();
            } else if (keyword == "normal") {
                // It says nothing that the corners do not.
                for (int i = 0; i < 3; ++i) take_word(rest);
            } else if (keyword == "solid") {
                begin_solid(trim(rest));
                return;
            } else if (keyword == "endsolid") {
                ended_ = true;
                return;
            } else if (keyword != "facet" && keyword != "outer" && keyword != "loop" &&
                       keyword != "endloop") {
                refuse(fmt::format("unknown word {}; expected facet, vertex or endsolid",
                                   excerpt(word)));
            }
        }
    }

    void begin_solid(std::string_view name) {
        const std::size_t number = mesh_.part_names.size() + 1;
        mesh_.part_names.push_back(name.empty() ? fmt::format("part {}", number)
                                                : std::string(name));
        ended_ = false;
    }

    void read_vertex(std::string_view& rest) {
        std::array<double, 3> place{};
        for (double& coordinate : place) {
            const std::string_view word = take_word(rest);
            const std::optional<double> number = parse_double(word);
            if (!number) {
                refuse(fmt::format("vertex with {} for a coordinate; expected three numbers",
                                   excerpt(word)));
            }
            coordinate = *number;
        }
        mesh_.corners.push_back(static_cast<std::uint32_t>(mesh_.positions.size()));
        if (!mesh_.add_position({place[0], place[1], place[2]})) {
            refuse("vertex with a coordinate that is not finite or beyond 1e15; correct it");
        }
        ++corners_;
    }

    void end_facet() {
        if (corners_ != 3) {
            refuse(fmt::format("facet with {} vertices; expected three", corners_));
        }
        corners_ = 0;
        mesh_.end_polygon();
        mesh_.parts.push_back(static_cast<std::uint32_t>(mesh_.part_names.size() - 1));
    }

    const Path& file_;
    LineCursor lines_;
    PolygonMesh mesh_;
    int corners_ = 0;  ///< of the facet so far
    bool ended_ = false;
};

FileContents read_stl(const Path& file, const ReadOptions& /*options*/) {
    const std::string bytes = read_text(file);
    return mesh_contents(file,
                         is_text(bytes) ? AsciiStl(file, bytes).read() : read_binary(file, bytes));
}

}  // namespace

Reader stl_reader() {
    static constexpr std::array<std::string_view, 1> kExtensions{"stl"};
    return {"STL", kExtensions, read_stl};
}

}  // namespace ink
