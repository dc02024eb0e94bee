#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/byte_order.h"
#include "io/reader.h"

// The Stanford PLY format, Greg Turk 1994: its header, and its numbers one by one.
namespace ink::ply {

enum class Encoding { ascii, little_endian, big_endian };

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Bytes of a number.
constexpr std::size_t size_of(Type type) {
    constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
    return kSizes[static_cast<std::size_t>(type)];
}

struct Property {
    std::string name;
    Type type = Type::float32;
    std::optional<Type> length_type;  ///< set for a list
};

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

    bool has_faces() const {
        const Element* const faces = find("face");
        return faces != nullptr && faces->count > 0;
    }

    const Element* find(std::string_view name) const {
        const auto found = std::ranges::find(elements, name, &Element::name);
        return found == elements.end() ? nullptr : &*found;
    }
};

/// A list of a face's vertices.
bool is_corner_list(const Property& property);

/// What the header says, checked: there are vertices with x, y and z, and no count is larger than
/// the file can hold. Throws InputError. The body is a view into `bytes`.
Header read_header(const std::filesystem::path& file, std::string_view bytes);

/// The vertices as particles, for a file without faces: ply_points.cpp.
FileContents read_points(const std::filesystem::path& file, const Header& header,
                         std::string_view bytes, const ReadOptions& options);

class BinaryValues {
  public:
    BinaryValues(std::string_view body, std::endian order)
        : rest_(body), swap_(is_foreign(order)) {}

    /// The number that begins at `from`.
    double at(const char* from, Type type) const {
        const auto as = [&]<class T>(T) { return static_cast<double>(load<T>(from, swap_)); };
        switch (type) {
            case Type::int8: return as(std::int8_t{});
            case Type::uint8: return as(std::uint8_t{});
            case Type::int16: return as(std::int16_t{});
            case Type::uint16: return as(std::uint16_t{});
            case Type::int32: return as(std::int32_t{});
            case Type::uint32: return as(std::uint32_t{});
            case Type::float32: return as(float{});
            case Type::float64: return as(double{});
        }
        return 0.0;
    }

    /// False at the end of the data.
    bool read(Type type, double& value) {
        if (rest_.size() < size_of(type)) return false;
        value = at(rest_.data(), type);
        rest_.remove_prefix(size_of(type));
        return true;
    }

    /// Takes a face of a byte and three 32-bit numbers, as almost all are, if one follows and its
    /// corners are below `limit`: in a third of the time.
    bool take_triangle(std::uint64_t limit, std::array<std::uint32_t, 3>& corners) {
        constexpr std::size_t kBytes = 1 + sizeof(corners);
        if (rest_.size() < kBytes || rest_.front() != 3) return false;
        for (std::size_t k = 0; k < 3; ++k) {
            corners[k] = load<std::uint32_t>(rest_.data() + 1 + 4 * k, swap_);
            if (corners[k] >= limit) return false;
        }
        rest_.remove_prefix(kBytes);
        return true;
    }

    /// Takes `count` entries of `bytes` each, if there are so many: a view to read them from in any
    /// order; else empty.
    std::string_view take(std::uint64_t count, std::size_t bytes) {
        if (bytes == 0 || rest_.size() / bytes < count) return {};
        const std::string_view taken = rest_.substr(0, count * bytes);
        rest_.remove_prefix(taken.size());
        return taken;
    }
    /// The same kind of numbers, of other bytes.
    BinaryValues over(std::string_view bytes) const {
        BinaryValues values = *this;
        values.rest_ = bytes;
        return values;
    }
    /// Puts back what was taken last.
    void put_back(std::string_view taken) { rest_ = {taken.data(), taken.size() + rest_.size()}; }

    std::optional<std::size_t> line() const { return std::nullopt; }

  private:
    std::string_view rest_;
    bool swap_;
};

class AsciiValues {
  public:
    AsciiValues(std::string_view all, std::string_view body)
        : all_(all), at_(body.data()), end_(body.data() + body.size()) {}

    /// False at the end of the data or where there is no number.
    bool read(Type /*type*/, double& value) {
        skip_blanks();
        if (at_ != end_ && *at_ == '+') ++at_;
        const auto result = std::from_chars(at_, end_, value);
        if (result.ec != std::errc{}) return false;
        at_ = result.ptr;
        return true;
    }

    /// As BinaryValues does, of whole numbers.
    bool take_triangle(std::uint64_t limit, std::array<std::uint32_t, 3>& corners) {
        const char* const start = at_;
        std::uint32_t count = 0;
        bool taken = take_whole(count) && count == 3;
        for (std::uint32_t& corner : corners) {
            taken = taken && take_whole(corner) && corner < limit;
        }
        if (!taken) at_ = start;
        return taken;
    }

    std::optional<std::size_t> line() const {
        return static_cast<std::size_t>(std::count(all_.data(), at_, '\n')) + 1;
    }

  private:
    static bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
    void skip_blanks() {
        while (at_ != end_ && is_blank(*at_)) ++at_;
    }
    bool take_whole(std::uint32_t& value) {
        skip_blanks();
        const auto result = std::from_chars(at_, end_, value);
        if (result.ec != std::errc{} || (result.ptr != end_ && !is_blank(*result.ptr))) {
            return false;
        }
        at_ = result.ptr;
        return true;
    }

    std::string_view all_;
    const char* at_;
    const char* end_;
};

}  // namespace ink::ply
