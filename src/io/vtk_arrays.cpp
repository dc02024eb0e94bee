#include "io/vtk_arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>

#include "base/error.h"
#include "base/memory.h"
#include "io/byte_order.h"
#include "io/inflate.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

[[noreturn]] void refuse(const Path& file, const VtkArray& array, std::string_view problem) {
    throw InputError(
        file, fmt::format("array '{}' {}; was the file written to the end?", array.name, problem));
}

std::size_t size_of(std::string_view type) {
    if (type.ends_with("64")) return 8;
    if (type.ends_with("32")) return 4;
    if (type.ends_with("16")) return 2;
    return 1;
}

// ---- base64 ----

constexpr std::uint8_t kNoDigit = 255;

constexpr std::array<std::uint8_t, 256> kDigits = [] {
    std::array<std::uint8_t, 256> table{};
    table.fill(kNoDigit);
    constexpr std::string_view kAlphabet =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
        table[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::uint8_t>(i);
    }
    return table;
}();

/// Takes encoded bytes off the front of `text` until there are `wanted` of them, or the text or its
/// run of digits ends. A run ends after its padding.
std::string take_base64(std::string_view& text, std::size_t wanted) {
    std::string bytes;
    bytes.reserve(std::min(wanted, text.size() / 4 * 3 + 3));
    std::uint32_t group = 0;
    int digits = 0;
    std::size_t i = 0;
    for (; i < text.size() && bytes.size() < wanted; ++i) {
        const std::uint8_t digit = kDigits[static_cast<unsigned char>(text[i])];
        if (digit == kNoDigit) {
            if (text[i] == '=') break;
            continue;  // line ends and blanks
        }
        group = group << 6 | digit;
        if (++digits < 4) continue;
        bytes.push_back(static_cast<char>(group >> 16 & 0xFFU));
        bytes.push_back(static_cast<char>(group >> 8 & 0xFFU));
        bytes.push_back(static_cast<char>(group & 0xFFU));
        group = 0;
        digits = 0;
    }
    if (digits == 3) {
        bytes.push_back(static_cast<char>(group >> 10 & 0xFFU));
        bytes.push_back(static_cast<char>(group >> 2 & 0xFFU));
    } else if (digits == 2) {
        bytes.push_back(static_cast<char>(group >> 4 & 0xFFU));
    }
    while (i < text.size() && text[i] == '=') ++i;
    text.remove_prefix(i);
    return bytes;
}

// ---- blocks ----

/// The bytes of one array, taken from the file as they are needed.
class Source {
  public:
    Source(std::string_view data, bool base64) : data_(data), base64_(base64) {}

    /// The next `count` bytes, or fewer at the end of the data.
    std::string_view take(std::size_t count) {
        if (base64_) return buffer_ = take_base64(data_, count);
        const std::string_view taken = data_.substr(0, count);
        data_.remove_prefix(taken.size());
        return taken;
    }
    std::size_t most_bytes() const { return data_.size(); }

  private:
    std::string_view data_;
    bool base64_;
    std::string buffer_;
};

class ArrayReader {
  public:
    ArrayReader(const VtkArray& array, const VtkEncoding& encoding, const Path& file)
        : array_(array),
          encoding_(encoding),
          file_(file),
          swap_(is_foreign(encoding.big_endian ? std::endian::big : std::endian::little)),
          source_(data(), array.format == "binary" || encoding.appended_base64) {}

    /// The decoded bytes; `buffer` holds them where they are not the file's own.
    std::string_view bytes(std::size_t wanted, std::string& buffer) {
        if (encoding_.compressed) {
            buffer = inflate_blocks(wanted);
            return buffer;
        }
        const std::size_t size = header_number();
        if (array_.format == "binary" || encoding_.appended_base64) {
            // Header and data are one run of digits, which does not stop between them.
            buffer = whole_base64();
            const std::string_view all = std::string_view(buffer).substr(header_bytes());
            return all.substr(0, std::min(size, all.size()));
        }
        return source_.take(size);
    }
    bool swap() const { return swap_; }

  private:
    std::string_view data() const {
        if (array_.format == "binary") {
            const std::size_t begin = array_.text.find_first_not_of(" \t\r\n");
            return begin == std::string_view::npos ? std::string_view() : array_.text.substr(begin);
        }
        if (array_.offset > encoding_.appended.size()) {
            refuse(file_, array_, "begins after the end of the data");
        }
        return encoding_.appended.substr(array_.offset);
    }
    std::size_t header_bytes() const { return encoding_.wide_headers ? 8 : 4; }

    std::size_t number(std::string_view bytes) const {
        if (bytes.size() < header_bytes()) refuse(file_, array_, "has no header");
        return encoding_.wide_headers ? load<std::uint64_t>(bytes.data(), swap_)
                                      : load<std::uint32_t>(bytes.data(), swap_);
    }
    std::size_t header_number() { return number(source_.take(header_bytes())); }
    std::string whole_base64() const {
        std::string_view text = data();
        return take_base64(text, std::numeric_limits<std::size_t>::max());
    }

    /// A header of block count, size of a block, size of the last block (0: as the others), and the
    /// compressed sizes; then the blocks.
    std::string inflate_blocks(std::size_t wanted) {
        const std::string head(source_.take(3 * header_bytes()));
        if (head.size() < 3 * header_bytes()) refuse(file_, array_, "has no header");
        const std::string_view view(head);
        const std::size_t blocks = number(view);
        const std::size_t block_size = number(view.substr(header_bytes()));
        const std::size_t last_size = number(view.substr(2 * header_bytes()));
        if (blocks > source_.most_bytes() / header_bytes() + 1) {
            refuse(file_, array_, "announces more blocks than the file holds");
        }
        const std::string sizes = sizes_of_blocks(blocks);
        std::string out;
        for (std::size_t b = 0; b < blocks && out.size() < wanted; ++b) {
            const std::size_t packed =
                number(std::string_view(sizes).substr(std::min(b * header_bytes(), sizes.size())));
            const bool is_last = b + 1 == blocks && last_size != 0;
            inflate_block(source_.take(packed), packed, is_last ? last_size : block_size, out);
        }
        return out;
    }
    /// In base64 the sizes share their run of digits with the head.
    std::string sizes_of_blocks(std::size_t blocks) {
        const bool base64 = array_.format == "binary" || encoding_.appended_base64;
        if (!base64) return std::string(source_.take(blocks * header_bytes()));
        Source again(data(), true);
        std::string all(again.take((3 + blocks) * header_bytes()));
        // The blocks are one run of digits of their own.
        blocks_ = std::string(again.take(std::numeric_limits<std::size_t>::max()));
        source_ = Source(blocks_, false);
        return all.size() > 3 * header_bytes() ? all.substr(3 * header_bytes()) : std::string();
    }

    void inflate_block(std::string_view packed, std::size_t announced, std::size_t size,
                       std::string& out) const {
        if (packed.size() < announced) refuse(file_, array_, "ends too early");
        if (size / kMostInflation > packed.size()) refuse(file_, array_, "has a block of no sense");
        const std::size_t begin = out.size();
        out.resize(begin + size);
        if (!inflate_exactly(packed, std::span(out).subspan(begin))) {
            refuse(file_, array_, "has damaged compressed data");
        }
    }

    const VtkArray& array_;
    const VtkEncoding& encoding_;
    const Path& file_;
    bool swap_;
    Source source_;
    std::string blocks_;  ///< decoded from base64
};

template <class T, class Number>
void convert(std::string_view bytes, bool swap, Number* values) {
    const std::size_t count = bytes.size() / sizeof(T);
    if constexpr (std::is_same_v<T, Number>) {
        if (!swap) {
            std::memcpy(values, bytes.data(), bytes.size());
            return;
        }
    }
    for (std::size_t i = 0; i < count; ++i) {
        values[i] = static_cast<Number>(load<T>(bytes.data() + i * sizeof(T), swap));
    }
}

template <class Number>
void convert(std::string_view type, std::string_view bytes, bool swap, Number* values) {
    if (type == "Float32") return convert<float>(bytes, swap, values);
    if (type == "Float64") return convert<double>(bytes, swap, values);
    if (type == "Int64") return convert<std::int64_t>(bytes, swap, values);
    if (type == "UInt64") return convert<std::uint64_t>(bytes, swap, values);
    if (type == "Int32") return convert<std::int32_t>(bytes, swap, values);
    if (type == "UInt32") return convert<std::uint32_t>(bytes, swap, values);
    if (type == "Int16") return convert<std::int16_t>(bytes, swap, values);
    if (type == "UInt16") return convert<std::uint16_t>(bytes, swap, values);
    if (type == "Int8") return convert<std::int8_t>(bytes, swap, values);
    return convert<std::uint8_t>(bytes, swap, values);
}

template <class Number>
std::vector<Number> read_ascii(const VtkArray& array, std::size_t count, const Path& file) {
    // A number takes at least a digit and a blank.
    if (count > array.text.size() / 2 + 1)
        refuse(file, array, "has fewer numbers than it announces");
    std::vector<Number> values;
    values.reserve(count);
    const char* at = array.text.data();
    const char* const end = at + array.text.size();
    while (values.size() < count) {
        while (at != end && (*at == ' ' || (*at >= '\t' && *at <= '\r'))) ++at;
        if (at == end)
            refuse(file, array, fmt::format("has {} of {} numbers", values.size(), count));
        if (*at == '+') ++at;
        double value = 0.0;
        const auto result = std::from_chars(at, end, value);
        if (result.ec == std::errc::invalid_argument) {
            refuse(file, array, fmt::format("has no number in place {}", values.size() + 1));
        }
        at = result.ptr;
        values.push_back(static_cast<Number>(value));
    }
    return values;
}

}  // namespace

bool is_vtk_number(std::string_view type) {
    static constexpr std::array<std::string_view, 10> kTypes{
        "Float32", "Float64", "Int64",  "UInt64", "Int32",
        "UInt32",  "Int16",   "UInt16", "Int8",   "UInt8"};
    return std::ranges::find(kTypes, type) != kTypes.end();
}

namespace {

/// `room` gives the place for the numbers, when it is known that they are there.
template <class Number, class Room>
void read_numbers(const VtkArray& array, const VtkEncoding& encoding, std::size_t count,
                  const Path& file, const Room& room) {
    if (!is_vtk_number(array.type)) refuse(file, array, "is not of numbers");
    if (array.format == "ascii") {
        const std::vector<Number> values = read_ascii<Number>(array, count, file);
        std::ranges::copy(values, room());
        return;
    }
    const std::size_t wanted = count * size_of(array.type);
    std::string buffer;
    ArrayReader reader(array, encoding, file);
    const std::string_view bytes = reader.bytes(wanted, buffer);
    if (bytes.size() < wanted) {
        refuse(file, array, fmt::format("has {} of {} bytes", bytes.size(), wanted));
    }
    convert<Number>(array.type, bytes.substr(0, wanted), reader.swap(), room());
}

template <class Number>
std::vector<Number> read_vector(const VtkArray& array, const VtkEncoding& encoding,
                                std::size_t count, const Path& file) {
    std::vector<Number> values;
    read_numbers<Number>(array, encoding, count, file, [&] {
        reserve_large(values, count);
        values.resize(count);
        return values.data();
    });
    return values;
}

}  // namespace

std::vector<float> read_vtk_array(const VtkArray& array, const VtkEncoding& encoding,
                                  std::size_t count, const Path& file) {
    return read_vector<float>(array, encoding, count, file);
}

std::vector<double> read_vtk_doubles(const VtkArray& array, const VtkEncoding& encoding,
                                     std::size_t count, const Path& file) {
    return read_vector<double>(array, encoding, count, file);
}

void append_vtk_points(const VtkArray& array, const VtkEncoding& encoding, std::size_t points,
                       const Path& file, std::vector<Vec3f>& positions) {
    static_assert(sizeof(Vec3f) == 3 * sizeof(float));
    read_numbers<float>(array, encoding, 3 * points, file, [&] {
        const std::size_t before = positions.size();
        reserve_large(positions, before + points);
        positions.resize(before + points);
        return &positions[before].x;
    });
}

}  // namespace ink
