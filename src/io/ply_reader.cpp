// The Stanford PLY format. Read here rather than by Assimp, whose PLY importer writes out of bounds
// when a header repeats an element and waits for ever when it has no end.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/ply_file.h"
#include "io/polygon_mesh.h"

namespace ink {

namespace {

using namespace ply;
using Path = std::filesystem::path;

constexpr std::size_t kGrain = 1 << 14;

/// Which number of a vertex a property holds.
enum Slot : std::size_t { kX, kY, kZ, kNx, kNy, kNz, kRed, kGreen, kBlue, kOther, kSlots };

Slot slot_of(const Property& property) {
    static constexpr std::pair<std::string_view, Slot> kNames[] = {{"x", kX},
                                                                   {"y", kY},
                                                                   {"z", kZ},
                                                                   {"nx", kNx},
                                                                   {"ny", kNy},
                                                                   {"nz", kNz},
                                                                   {"red", kRed},
                                                                   {"green", kGreen},
                                                                   {"blue", kBlue},
                                                                   {"diffuse_red", kRed},
                                                                   {"diffuse_green", kGreen},
                                                                   {"diffuse_blue", kBlue}};
    if (property.length_type) return kOther;
    for (const auto& [name, slot] : kNames) {
        if (property.name == name) return slot;
    }
    return kOther;
}

/// Where the numbers of a vertex go.
struct VertexLayout {
    std::vector<Slot> slots;           ///< a property
    std::array<Type, kSlots> types{};  ///< a slot
    bool has_normals = false;
    bool has_colors = false;

    explicit VertexLayout(const Element& vertices) {
        for (const Property& property : vertices.properties) {
            slots.push_back(slot_of(property));
            types[slots.back()] = property.type;
        }
        has_normals = has(kNx) && has(kNy) && has(kNz);
        has_colors = has(kRed) && has(kGreen) && has(kBlue);
    }

    bool has(Slot slot) const { return std::ranges::find(slots, slot) != slots.end(); }
};

std::uint8_t color_byte(double value, Type type) {
    const bool real = type == Type::float32 || type == Type::float64;
    const double scale = real ? 255.0 : type == Type::uint16 ? 1.0 / 257.0 : 1.0;
    const double scaled = value * scale;
    // Written so that NaN becomes 0.
    return static_cast<std::uint8_t>(scaled > 0.0 ? std::lround(std::min(scaled, 255.0)) : 0);
}

template <class Values>
class BodyReader {
  public:
    BodyReader(const Path& file, const Header& header, Values values)
        : file_(file), vertex_count_(header.find("vertex")->count), values_(values) {}

    void read(const Element& element) {
        element_ = &element;
        if (element.name == "vertex") {
            read_vertices();
        } else if (element.name == "face") {
            read_faces();
        } else {
            for (index_ = 0; index_ < element.count; ++index_) skip(element.properties);
        }
    }

    PolygonMesh take_mesh() { return std::move(mesh_); }

  private:
    [[noreturn]] void refuse(std::string_view problem) const {
        if (const std::optional<std::size_t> line = values_.line()) {
            throw InputError(file_, *line, problem);
        }
        throw InputError(file_, problem);
    }

    double value(Type type) {
        double result = 0.0;
        if (!values_.read(type, result)) {
            refuse(
                fmt::format("the data end or are unreadable in {} {} of {}; was the file "
                            "written to the end?",
                            element_->name, index_ + 1, element_->count));
        }
        return result;
    }

    std::size_t list_length(const Property& property) {
        const double length = value(*property.length_type);
        // A list without end runs into the end of the data; only nonsense is refused here.
        if (!(length >= 0.0 && length <= std::numeric_limits<std::uint32_t>::max())) {
            refuse(
                fmt::format("{} {} has a list of {} entries; the file is damaged: export it "
                            "again",
                            element_->name, index_ + 1, length));
        }
        return static_cast<std::size_t>(length);
    }

    void skip(const Property& property) {
        const std::size_t count = property.length_type ? list_length(property) : 1;
        for (std::size_t i = 0; i < count; ++i) value(property.type);
    }

    void skip(const std::vector<Property>& properties) {
        for (const Property& property : properties) skip(property);
    }

    void read_vertices() {
        const VertexLayout layout(*element_);
        mesh_.single_precision = layout.types[kX] == Type::float32;
        reserve_large(mesh_.positions, element_->count);
        if constexpr (std::is_same_v<Values, BinaryValues>) {
            if (take_vertices(layout)) return;
        }
        for (index_ = 0; index_ < element_->count; ++index_)
            add_vertex(layout, read_vertex(layout));
    }

    /// All vertices at once, on all threads, where they are of one size. False where one by one
    /// will tell what is wrong.
    bool take_vertices(const VertexLayout& layout) {
        const std::vector<Property>& properties = element_->properties;
        std::size_t stride = 0;
        for (const Property& property : properties) {
            if (property.length_type) return false;
            stride += size_of(property.type);
        }
        const std::string_view bytes = values_.take(element_->count, stride);
        if (bytes.empty()) return false;
        const auto vertex_at = [&](std::size_t i) {
            std::array<double, kSlots> vertex{};
            const char* from = bytes.data() + i * stride;
            for (std::size_t k = 0; k < properties.size(); ++k) {
                vertex[layout.slots[k]] = values_.at(from, properties[k].type);
                from += size_of(properties[k].type);
            }
            return vertex;
        };
        const auto first = vertex_at(0);
        mesh_.origin = {first[kX], first[kY], first[kZ]};
        mesh_.positions.resize(element_->count);
        if (layout.has_normals) mesh_.normals.resize(element_->count);
        if (layout.has_colors) mesh_.colors.resize(element_->count);
        std::atomic<bool> usable = true;
        parallel_ranges(element_->count, kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const auto vertex = vertex_at(i);
                const Vec3d position{vertex[kX], vertex[kY], vertex[kZ]};
                if (!is_usable_position(position)) usable = false;
                mesh_.positions[i] = to_float(position - mesh_.origin);
                if (layout.has_normals) mesh_.normals[i] = normal_of(vertex);
                if (layout.has_colors) mesh_.colors[i] = color_of(layout, vertex);
            }
        });
        if (usable) return true;
        mesh_.positions.clear();
        mesh_.normals.clear();
        mesh_.colors.clear();
        values_.put_back(bytes);
        return false;
    }

    std::array<double, kSlots> read_vertex(const VertexLayout& layout) {
        std::array<double, kSlots> vertex{};
        for (std::size_t i = 0; i < layout.slots.size(); ++i) {
            const Property& property = element_->properties[i];
            if (property.length_type) {
                skip(property);
            } else {
                vertex[layout.slots[i]] = value(property.type);
            }
        }
        return vertex;
    }

    void add_vertex(const VertexLayout& layout, const std::array<double, kSlots>& vertex) {
        add_position(vertex);
        if (layout.has_normals) mesh_.normals.push_back(normal_of(vertex));
        if (layout.has_colors) mesh_.colors.push_back(color_of(layout, vertex));
    }

    static Vec3f normal_of(const std::array<double, kSlots>& vertex) {
        return to_float({vertex[kNx], vertex[kNy], vertex[kNz]});
    }

    static Rgb8 color_of(const VertexLayout& layout, const std::array<double, kSlots>& vertex) {
        return {color_byte(vertex[kRed], layout.types[kRed]),
                color_byte(vertex[kGreen], layout.types[kGreen]),
                color_byte(vertex[kBlue], layout.types[kBlue])};
    }

    void add_position(const std::array<double, kSlots>& vertex) {
        if (mesh_.add_position({vertex[kX], vertex[kY], vertex[kZ]})) return;
        refuse(
            fmt::format("vertex {} lies at ({:g}, {:g}, {:g}), not a usable place; correct or "
                        "remove it",
                        index_, vertex[kX], vertex[kY], vertex[kZ]));
    }

    void read_faces() {
        const Element& faces = *element_;
        reserve_large(mesh_.polygon_ends, faces.count);
        reserve_large(mesh_.corners, faces.count * 3);
        const bool plain = are_plain(faces);
        if constexpr (std::is_same_v<Values, BinaryValues>) {
            if (plain && take_triangles()) return;
        }
        std::array<std::uint32_t, 3> triangle{};
        for (index_ = 0; index_ < faces.count; ++index_) {
            if (plain && values_.take_triangle(vertex_count_, triangle)) {
                mesh_.corners.insert(mesh_.corners.end(), triangle.begin(), triangle.end());
                mesh_.end_polygon();
                continue;
            }
            bool done = false;
            for (const Property& property : faces.properties) {
                if (is_corner_list(property) && !done) {
                    read_corners(property);
                    done = true;
                } else {
                    skip(property);
                }
            }
            mesh_.end_polygon();
        }
    }

    /// All faces at once, on all threads, where each is a triangle of a byte and three 32-bit
    /// numbers in range.
    bool take_triangles() {
        constexpr std::size_t kStride = 1 + 3 * sizeof(std::uint32_t);
        const std::size_t count = element_->count;
        const std::string_view bytes = values_.take(count, kStride);
        if (bytes.empty()) return false;
        mesh_.corners.resize(3 * count);
        mesh_.polygon_ends.resize(count);
        std::atomic<bool> plain = true;
        parallel_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
            BinaryValues own = values_.over(bytes.substr(begin * kStride));
            std::array<std::uint32_t, 3> corners{};
            for (std::size_t i = begin; i < end && plain; ++i) {
                if (!own.take_triangle(vertex_count_, corners)) plain = false;
                std::ranges::copy(corners,
                                  mesh_.corners.begin() + static_cast<std::ptrdiff_t>(3 * i));
                mesh_.polygon_ends[i] = static_cast<std::uint32_t>(3 * (i + 1));
            }
        });
        if (plain) return true;
        mesh_.corners.clear();
        mesh_.polygon_ends.clear();
        values_.put_back(bytes);
        return false;
    }

    static bool are_plain(const Element& faces) {
        if (faces.properties.size() != 1 || !is_corner_list(faces.properties[0])) return false;
        const Property& list = faces.properties[0];
        const bool short_length = list.length_type == Type::uint8 || list.length_type == Type::int8;
        return short_length && (list.type == Type::int32 || list.type == Type::uint32);
    }

    void read_corners(const Property& property) {
        const std::size_t count = list_length(property);
        for (std::size_t i = 0; i < count; ++i) {
            const double vertex = value(property.type);
            if (!(vertex >= 0.0 && vertex < static_cast<double>(vertex_count_))) {
                refuse(
                    fmt::format("face {} uses vertex {:.0f}, but they go from 0 to {}; the file "
                                "is damaged: export it again",
                                index_, vertex, vertex_count_ - 1));
            }
            mesh_.corners.push_back(static_cast<std::uint32_t>(vertex));
        }
    }

    const Path& file_;
    std::uint64_t vertex_count_;
    Values values_;
    PolygonMesh mesh_;
    const Element* element_ = nullptr;  ///< being read, with
    std::uint64_t index_ = 0;           ///< its entry
};

template <class Values>
PolygonMesh read_body(const Path& file, const Header& header, Values values) {
    BodyReader<Values> reader(file, header, values);
    for (const Element& element : header.elements) reader.read(element);
    return reader.take_mesh();
}

FileContents read_ply(const Path& file, const ReadOptions& options) {
    std::string bytes = read_text(file);
    const Header header = read_header(file, bytes);
    if (!header.has_faces()) return read_points(file, header, bytes, options);
    PolygonMesh mesh;
    if (header.encoding == Encoding::ascii) {
        mesh = read_body(file, header, AsciiValues(bytes, header.body));
        mesh.single_precision = false;
    } else {
        const bool little = header.encoding == Encoding::little_endian;
        const std::endian order = little ? std::endian::little : std::endian::big;
        mesh = read_body(file, header, BinaryValues(header.body, order));
    }
    mesh.format = header.encoding == Encoding::ascii ? "ASCII PLY" : "binary PLY";
    release(bytes);
    return mesh_contents(file, std::move(mesh));
}

}  // namespace

Reader ply_reader() {
    static constexpr std::array<std::string_view, 1> kExtensions{"ply"};
    return {"PLY", kExtensions, read_ply};
}

}  // namespace ink
