#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/ply_file.h"

namespace ink::ply {

namespace {

using Path = std::filesystem::path;

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
        if (!header_.has_faces()) return;
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

}  // namespace

bool is_corner_list(const Property& property) {
    return property.length_type &&
           (property.name == "vertex_indices" || property.name == "vertex_index");
}

Header read_header(const Path& file, std::string_view bytes) {
    return HeaderReader(file, bytes).read();
}

}  // namespace ink::ply
