// Stereolithography files, as text or as a count and 50 bytes a triangle. Read here rather than by
// Assimp, which names no line and loses memory when it refuses a file.

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <bit>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/text.h"
#include "io/byte_order.h"
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
    return load<T>(bytes, is_foreign(std::endian::little));
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

std::array<Vec3d, 3> corners_of(const char* record) {
    constexpr std::size_t kNormalBytes = 12;
    constexpr std::size_t kCornerBytes = 12;
    const char* const corners = record + kNormalBytes;
    return {position_at(corners), position_at(corners + kCornerBytes),
            position_at(corners + 2 * kCornerBytes)};
}

[[noreturn]] void refuse_triangle(const Path& file, const char* record, std::size_t triangle) {
    for (const Vec3d& p : corners_of(record)) {
        if (is_usable_position(p)) continue;
        throw InputError(file, fmt::format("a corner of triangle {} lies at ({:g}, {:g}, {:g}), "
                                           "not a usable place; export the model again",
                                           triangle + 1, p.x, p.y, p.z));
    }
    std::abort();
}

/// The corners of all records. Returns the first record that has an unusable one, or `count`.
std::size_t read_corners(const char* records, std::size_t count, PolygonMesh& mesh) {
    constexpr std::size_t kGrain = 1 << 14;
    mesh.origin = position_at(records + 12);
    std::atomic<std::size_t> bad = count;
    parallel_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            bool usable = true;
            std::size_t at = 3 * i;
            for (const Vec3d& corner : corners_of(records + i * kTriangleBytes)) {
                usable &= is_usable_position(corner);
                mesh.corners[at] = static_cast<std::uint32_t>(at);
                mesh.positions[at++] = to_float(corner - mesh.origin);
            }
            mesh.polygon_ends[i] = static_cast<std::uint32_t>(at);
            if (usable) continue;
            std::size_t known = bad;
            while (i < known && !bad.compare_exchange_weak(known, i)) {
            }
            return;
        }
    });
    return bad;
}

PolygonMesh read_binary(const Path& file, std::string_view bytes) {
    check_size(file, bytes);
    const std::size_t count = promised_triangles(bytes);
    const char* const records = bytes.data() + kHeaderBytes;
    PolygonMesh mesh;
    mesh.format = "binary STL";
    mesh.single_precision = true;
    const auto make_room = [](auto& values, std::size_t size) {
        reserve_large(values, size);
        values.resize(size);
    };
    make_room(mesh.positions, 3 * count);
    make_room(mesh.corners, 3 * count);
    make_room(mesh.polygon_ends, count);
    const std::size_t bad = count == 0 ? 0 : read_corners(records, count, mesh);
    if (bad < count) refuse_triangle(file, records + bad * kTriangleBytes, bad);
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

PolygonMesh read_polygons(const Path& file) {
    const std::string bytes = read_text(file);
    return is_text(bytes) ? AsciiStl(file, bytes).read() : read_binary(file, bytes);
}

FileContents read_stl(const Path& file, const ReadOptions& /*options*/) {
    return mesh_contents(file, read_polygons(file));
}

}  // namespace

Reader stl_reader() {
    static constexpr std::array<std::string_view, 1> kExtensions{"stl"};
    return {"STL", kExtensions, read_stl};
}

}  // namespace ink
