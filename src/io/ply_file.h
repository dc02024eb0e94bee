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

    /// Takes a face of a byte and three 32-bit numbers, as almost all are, if one follows and its
    /// corners are below `limit`: in a third of the time.
    bool take_triangle(std::uint64_t limit, std::array<std::uint32_t, 3>& corners) {
        constexpr std::size_t kBytes = 1 + sizeof(corners);
        if (swap_ || rest_.size() < kBytes || rest_.front() != 3) return false;
        std::memcpy(corners.data(), rest_.data() + 1, sizeof(corners));
        for (const std::uint32_t corner : corners) {
            if (corner >= limit) return false;
        }
        rest_.remove_prefix(kBytes);
        return true;
    }

    std::optional<std::size_t> line() const { return std::nullopt; }

  private:
    template <class T>
    bool read_as(double& value) {
        if (rest_.size() < sizeof(T)) return false;
        value = static_cast<double>(load<T>(rest_.data(), swap_));
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

    static bool take_triangle(std::uint64_t /*limit*/, std::array<std::uint32_t, 3>& /*corners*/) {
        return false;
    }

    std::optional<std::size_t> line() const {
        return static_cast<std::size_t>(std::count(all_.data(), at_, '\n')) + 1;
    }

  private:
    std::string_view all_;
    const char* at_;
    const char* end_;
};

}  // namespace ink::ply
