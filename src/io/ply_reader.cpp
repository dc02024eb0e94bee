// The Stanford PLY format, Greg Turk 1994. Read here rather than by Assimp, whose PLY importer
// writes out of bounds when a header repeats an element and waits for ever when it has no end.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/polygon_mesh.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

// ---- header ------------------------------------------------------------------------------------

enum class Encoding { ascii, little_endian, big_endian };

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::optional<Type> parse_type(std::string_view name) {
    static constexpr std::pair<std::string_view, Type> kNames[] = {
        {"char", Type::int8},      {"int8", Type::int8},       {"uchar", Type::uint8},
        {"uint8", Type::uint8},    {"short", Type::int16},     {"int16", Type::int16},
        {"ushort", Type::uint16},  {"uint16", Type::uint16},   {"int", Type::int32},
        {"int32", Type::int32},    {"uint", Type::uint32},     {"uint32", Type::uint32},
        {"float", Type::float32},  {"float32", Type::float32}, {"double", Type::float64},
        {"float64", Type::float64}};
    for (const auto& [known, type] : kNames) {
        if (name == known) return type;
    }
    return std::nullopt;
}

std::size_t size_of(Type type) {
    static constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
    return kSizes[static_cast<std::size_t>(type)];
}

struct Property {
    std::string name;
    Type type = Type::float32;
    std::optional<Type> length_type;  ///< set for a list
};

bool is_corner_list(const Property& property) {
    return property.length_type &&
           (property.name == "vertex_indices" || property.name == "vertex_index");
}

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;

    bool has(std::string_view property) const {
        return std::ranges::find(properties, property, &Property::name) != properties.end();
    }
};

struct Header {
    Encoding encoding = Encoding::ascii;
    std::vector<Element> elements;
    std::string_view body;

    const Element* find(std::string_view name) const {
        const auto found = std::ranges::find(elements, name, &Element::name);
        return found == elements.end() ? nullptr : &*found;
    }
};

/// Reads the header line by line; what it returns is well formed, and its counts fit the file.
class HeaderReader {
  public:
    HeaderReader(const Path& file, std::string_view bytes) : file_(file), lines_(bytes) {}

    Header read() {
        if (!lines_.next() || to_lower(trim(lines_.line())) != "ply") {
            throw InputError(file_,
                             "is not a PLY file (its first line is not 'ply'); "
                             "check the file's name");
        }
        while (step()) {
        }
        check_format();
        header_.body = lines_.rest();
        check_mesh();
        for (const Element& element : header_.elements) check_count(element);
        return std::move(header_);
    }

  private:
    [[noreturn]] void refuse(std::string_view problem) const {
        throw InputError(file_, lines_.number(), problem);
    }

    /// False at the end of the header.
    bool step() {
        if (!lines_.next()) {
            throw InputError(file_, "the header has no 'end_header'; was it written to the end?");
        }
        std::string_view rest = lines_.line();
        const std::string_view keyword = take_word(rest);
        if (keyword == "end_header") return false;
        if (keyword == "format") {
            read_format(rest);
        } else if (keyword == "element") {
            read_element(rest);
        } else if (keyword == "property") {
            read_property(rest);
        } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
            refuse(fmt::format("unknown header line {}; expected element, property or end_header",
                               excerpt(keyword)));
        }
        return true;
    }

    void read_format(std::string_view rest) {
        const std::string_view name = take_word(rest);
        if (name == "ascii") {
            header_.encoding = Encoding::ascii;
        } else if (name == "binary_little_endian") {
            header_.encoding = Encoding::little_endian;
        } else if (name == "binary_big_endian") {
            header_.encoding = Encoding::big_endian;
        } else {
            refuse(
                fmt::format("unknown format {}; expected ascii, binary_little_endian or "
                            "binary_big_endian",
                            excerpt(name)));
        }
        has_format_ = true;
    }

    void read_element(std::string_view rest) {
        const std::string_view name = take_word(rest);
        const std::optional<std::int64_t> count = parse_int(take_word(rest));
        if (name.empty() || !count || *count < 0) {
            refuse("bad element line; expected: element NAME COUNT");
        }
        if (header_.find(name) != nullptr) {
            refuse(fmt::format("element {} is there twice; keep one", excerpt(name)));
        }
        header_.elements.push_back({std::string(name), static_cast<std::uint64_t>(*count), {}});
    }

    void read_property(std::string_view rest) {
        if (header_.elements.empty()) refuse("property before any element; export the file again");
        Property property;
        std::string_view type = take_word(rest);
        if (type == "list") {
            property.length_type = known_type(take_word(rest));
            type = take_word(rest);
        }
        property.type = known_type(type);
        property.name = take_word(rest);
        if (property.name.empty()) refuse("property without a name; expected: property TYPE NAME");
        header_.elements.back().properties.push_back(std::move(property));
    }

    Type known_type(std::string_view name) const {
        const std::optional<Type> type = parse_type(name);
        if (!type) {
            refuse(
                fmt::format("unknown property type {}; expected one of char, uchar, short, "
                            "ushort, int, uint, float, double",
                            excerpt(name)));
        }
        return *type;
    }

    void check_format() const {
        if (!has_format_) {
            throw InputError(file_, "the header has no format line; expected: format ascii 1.0");
        }
    }

    void check_mesh() const {
        const Element* const vertices = header_.find("vertex");
        if (vertices == nullptr || vertices->count == 0) {
            throw InputError(file_, "holds no vertices; export the model again");
        }
        for (const std::string_view name : {"x", "y", "z"}) {
            if (!vertices->has(name)) {
                throw InputError(file_, fmt::format("the vertices have no property '{}'; export "
                                                    "the model with x, y and z",
                                                    name));
            }
        }
        check_faces();
    }

    void check_faces() const {
        const Element* const faces = header_.find("face");
        if (faces == nullptr && header_.find("tristrips") != nullptr) {
            throw InputError(file_, "holds triangle strips; export plain faces");
        }
        if (faces == nullptr || faces->count == 0) {
            throw InputError(file_, "holds points, no faces; export the surface with its faces");
        }
        if (std::ranges::none_of(faces->properties, is_corner_list)) {
            throw InputError(file_, "the faces have no list 'vertex_indices'; export them again");
        }
    }

    /// Before memory is set aside for what a header promises.
    void check_count(const Element& element) const {
        std::size_t least_bytes = 0;
        for (const Property& property : element.properties) {
            const Type first = property.length_type.value_or(property.type);
            // As text, a digit and a separator.
            least_bytes += header_.encoding == Encoding::ascii ? 2 : size_of(first);
        }
        const std::uint64_t most =
            (header_.body.size() + 1) / std::max<std::size_t>(least_bytes, 1);
        if (element.count > most || element.count > std::numeric_limits<std::uint32_t>::max() / 2) {
            throw InputError(file_, fmt::format("the header promises {} of '{}', more than fit in "
                                                "the {} bytes after it; was the file written to "
                                                "the end?",
                                                element.count, element.name, header_.body.size()));
        }
    }

    const Path& file_;
    LineCursor lines_;
    Header header_;
    bool has_format_ = false;
};

// ---- values ------------------------------------------------------------------------------------

class BinaryValues {
  public:
    BinaryValues(std::string_view body, std::endian order)
        : rest_(body), swap_(order != std::endian::native) {}

    /// False at the end of the data.
    bool read(Type type, double& value) {
        switch (type) {
            case Type::int8: return read_as<std::int8_t>(value);
            case Type::uint8: return read_as<std::uint8_t>(value);
            case Type::int16: return read_as<std::int16_t>(value);
            case Type::uint16: return read_as<std::uint16_t>(value);
            case Type::int32: return read_as<std::int32_t>(value);
            case Type::uint32: return read_as<std::uint32_t>(value);
            case Type::float32: return read_as<float>(value);
            case Type::float64: return read_as<double>(value);
        }
        return false;
    }

    std::optional<std::size_t> line() const { return std::nullopt; }

  private:
    template <class T>
    bool read_as(double& value) {
        if (rest_.size() < sizeof(T)) return false;
        std::array<char, sizeof(T)> bytes;
        std::memcpy(bytes.data(), rest_.data(), sizeof(T));
        if (swap_) std::ranges::reverse(bytes);
        value = static_cast<double>(std::bit_cast<T>(bytes));
        rest_.remove_prefix(sizeof(T));
        return true;
    }

    std::string_view rest_;
    bool swap_;
};

class AsciiValues {
  public:
    AsciiValues(std::string_view all, std::string_view body)
        : all_(all), at_(body.data()), end_(body.data() + body.size()) {}

    /// False at the end of the data or where there is no number.
    bool read(Type /*type*/, double& value) {
        while (at_ != end_ && (*at_ == ' ' || (*at_ >= '\t' && *at_ <= '\r'))) ++at_;
        if (at_ != end_ && *at_ == '+') ++at_;
        const auto result = std::from_chars(at_, end_, value);
        if (result.ec != std::errc{}) return false;
        at_ = result.ptr;
        return true;
    }

    std::optional<std::size_t> line() const {
        return static_cast<std::size_t>(std::count(all_.data(), at_, '\n')) + 1;
    }

  private:
    std::string_view all_;
    const char* at_;
    const char* end_;
};

// ---- body --------------------------------------------------------------------------------------

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
        mesh_.positions.reserve(element_->count);
        for (index_ = 0; index_ < element_->count; ++index_)
            add_vertex(layout, read_vertex(layout));
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
        if (layout.has_normals) {
            mesh_.normals.push_back(to_float({vertex[kNx], vertex[kNy], vertex[kNz]}));
        }
        if (layout.has_colors) {
            mesh_.colors.push_back({color_byte(vertex[kRed], layout.types[kRed]),
                                    color_byte(vertex[kGreen], layout.types[kGreen]),
                                    color_byte(vertex[kBlue], layout.types[kBlue])});
        }
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
        mesh_.polygon_ends.reserve(faces.count);
        mesh_.corners.reserve(faces.count * 3);
        for (index_ = 0; index_ < faces.count; ++index_) {
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

FileContents read_ply(const Path& file, const ReadOptions& /*options*/) {
    const std::string bytes = read_text(file);
    const Header header = HeaderReader(file, bytes).read();
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
    return mesh_contents(file, std::move(mesh));
}

}  // namespace

Reader ply_reader() {
    static constexpr std::array<std::string_view, 1> kExtensions{"ply"};
    return {"PLY", kExtensions, read_ply};
}

}  // namespace ink
