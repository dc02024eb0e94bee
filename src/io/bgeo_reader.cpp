// Houdini's classic binary geometry, version 5, which its releases up to 11 wrote and Partio
// writes: "BgeoV", counts, attributes, then a record a point, all of it big-endian. Points are
// particles.

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "io/byte_order.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/molecule_file.h"
#include "io/obj_materials.h"
#include "io/particle_file.h"
#include "scene/field.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

constexpr std::string_view kMagic = "BgeoV";
constexpr std::int32_t kVersion = 5;
constexpr std::size_t kWord = 4;  ///< bytes of a number

template <class T>
T big_endian(const char* bytes) {
    return load<T>(bytes, is_foreign(std::endian::big));
}

/// What the numbers of an attribute are.
enum Type : std::int32_t {
    kFloat = 0,
    kInteger = 1,
    kIndex = 4,  ///< of a text in the attribute's table
    kVector = 5
};

struct Attribute {
    std::string name;
    std::int32_t type = kFloat;
    std::size_t components = 1;
    std::size_t place = 0;  ///< in a point's record, bytes
};

class BgeoReader {
  public:
    BgeoReader(const Path& file, const ReadOptions& options)
        : file_(file), options_(options), bytes_(read_text(file)), rest_(bytes_) {}

    FileContents read() {
        check_frame(options_.frame, 1, file_);
        read_header();
        read_positions();
        for (const Attribute& attribute : attributes_) read_values(attribute);
        return particle_contents(file_, "Houdini bgeo", std::move(particles_), std::move(contents_),
                                 options_);
    }

  private:
    // ---- Header ----

    void read_header() {
        if (!rest_.starts_with(kMagic)) {
            throw InputError(file_,
                             "is not Houdini's classic geometry (it does not begin with 'BgeoV'); "
                             "save it as .bhclassic, PLY or a table");
        }
        rest_.remove_prefix(kMagic.size());
        if (const auto version = take<std::int32_t>(); version != kVersion) {
            throw InputError(file_, fmt::format("is version {} of the format; save it as {}",
                                                version, kVersion));
        }
        const std::size_t points = take_count("points");
        const std::size_t primitives = take_count("primitives");
        take_count("point groups");
        take_count("primitive groups");
        const std::size_t attributes = take_count("attributes");
        for (const char* what : {"vertex attributes", "primitive attributes", "attributes of all"})
            take_count(what);
        for (std::size_t k = 0; k < attributes; ++k) read_attribute();
        if (points > rest_.size() / record_) {
            throw InputError(file_, fmt::format("the header promises {} points, the file holds {}; "
                                                "was it written to the end?",
                                                points, rest_.size() / record_));
        }
        count_ = points;
        if (primitives > 0) {
            contents_.warnings.push_back(
                fmt::format("{} primitives were left out; points are drawn.", primitives));
        }
    }

    void read_attribute() {
        Attribute attribute;
        attribute.name = take_text();
        attribute.components = take<std::uint16_t>();
        attribute.type = take<std::int32_t>();
        attribute.place = record_;
        const std::string name = excerpt(attribute.name);
        if (attribute.components == 0) {
            throw InputError(file_, fmt::format("attribute {} has no components; the file is "
                                                "damaged: export it again",
                                                name));
        }
        switch (attribute.type) {
            case kFloat:
            case kInteger:
            case kVector: take_bytes(attribute.components * kWord); break;  // its defaults
            case kIndex:
                for (std::size_t k = take_count("texts"); k > 0; --k) take_text();
                break;
            default:
                throw InputError(file_, fmt::format("attribute {} is of type {}; expected 0, 1 or "
                                                    "5 (numbers) or 4 (texts): export it again",
                                                    name, attribute.type));
        }
        record_ += attribute.components * kWord;
        attributes_.push_back(std::move(attribute));
    }

    std::string_view take_bytes(std::size_t count) {
        if (rest_.size() < count) {
            throw InputError(file_, "the data end in the header; was it written to the end?");
        }
        const std::string_view bytes = rest_.substr(0, count);
        rest_.remove_prefix(count);
        return bytes;
    }

    template <class T>
    T take() {
        return big_endian<T>(take_bytes(sizeof(T)).data());
    }

    std::string_view take_text() { return take_bytes(take<std::uint16_t>()); }

    std::size_t take_count(std::string_view what) {
        const auto count = take<std::int32_t>();
        if (count >= 0) return static_cast<std::size_t>(count);
        throw InputError(file_, fmt::format("announces {} {}; the file is damaged: export it again",
                                            count, what));
    }

    // ---- Points ----

    /// The number at `place` of a point's record.
    template <class T = float>
    T number(std::size_t point, std::size_t place) const {
        return big_endian<T>(rest_.data() + point * record_ + place);
    }

    /// A place is x, y, z and a weight, which curves alone use.
    void read_positions() {
        particles_.positions.reserve(count_);
        for (std::size_t i = 0; i < count_; ++i) {
            const Vec3d p{number(i, 0), number(i, kWord), number(i, 2 * kWord)};
            if (i == 0 && std::isfinite(p.x + p.y + p.z)) particles_.origin = p;
            particles_.positions.push_back(to_float(p - particles_.origin));
        }
    }

    void read_values(const Attribute& attribute) {
        if (attribute.name == "Cd" && attribute.components == 3) read_colors(attribute);
        const bool wanted = options_.facts || is_drawn_field(attribute.name, options_.data);
        if (!wanted && !options_.summarize) {
            contents_.fields.push_back({attribute.name, attribute.components, 0, 0});
            return;
        }
        const bool real = attribute.type == kFloat || attribute.type == kVector;
        Field field{attribute.name, attribute.components, {}};
        field.values.reserve(count_ * attribute.components);
        for (std::size_t i = 0; i < count_; ++i) {
            for (std::size_t k = 0; k < attribute.components; ++k) {
                const std::size_t place = attribute.place + k * kWord;
                field.values.push_back(real ? number(i, place)
                                            : static_cast<float>(number<std::int32_t>(i, place)));
            }
        }
        contents_.fields.push_back(summarize(field));
        if (wanted) particles_.fields.push_back(std::move(field));
    }

    void read_colors(const Attribute& attribute) {
        particles_.colors.clear();
        for (std::size_t i = 0; i < count_; ++i) {
            const std::size_t place = attribute.place;
            particles_.colors.push_back(to_rgb8(
                {number(i, place), number(i, place + kWord), number(i, place + 2 * kWord)}));
        }
    }

    const Path& file_;
    const ReadOptions& options_;
    const std::string bytes_;
    std::string_view rest_;  ///< of `bytes_`: in the end, the points' records
    std::vector<Attribute> attributes_;
    std::size_t record_ = 4 * kWord;  ///< bytes of a point: its place, then its attributes
    std::size_t count_ = 0;           ///< of points
    Particles particles_;
    FileContents contents_;
};

FileContents read_bgeo(const Path& file, const ReadOptions& options) {
    return BgeoReader(file, options).read();
}

}  // namespace

Reader bgeo_reader() {
    static constexpr std::array<std::string_view, 2> kExtensions{"bgeo", "bhclassic"};
    return {"Houdini bgeo", kExtensions, read_bgeo};
}

}  // namespace ink
