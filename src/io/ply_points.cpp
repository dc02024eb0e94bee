#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/text.h"
#include "io/particle_file.h"
#include "io/ply_file.h"

namespace ink::ply {

namespace {

using Path = std::filesystem::path;

/// Where the numbers of a point go.
struct PointLayout {
    struct Target {
        int axis = -1;   ///< 0, 1, 2: a coordinate
        int color = -1;  ///< 0, 1, 2: red, green, blue
        std::vector<FieldLayout::Place> fields;
        FieldSummary summary;
    };
    std::vector<Target> targets;  ///< a property
};

int index_in(std::string_view name, const std::array<std::string_view, 3>& names) {
    for (int k = 0; k < 3; ++k) {
        if (names[static_cast<std::size_t>(k)] == name) return k;
    }
    return -1;
}

PointLayout make_layout(const Element& points, const ReadOptions& options, Particles& particles) {
    std::vector<std::string> names;
    std::vector<std::string> others;
    for (const Property& property : points.properties) {
        names.push_back(property.length_type ? std::string() : property.name);
        const bool is_place = index_in(property.name, {"x", "y", "z"}) >= 0;
        if (options.facts && !property.length_type && !is_place) others.push_back(property.name);
    }
    FieldLayout fields = lay_out_fields(names, options.data, others);
    particles.fields = std::move(fields.fields);
    PointLayout layout;
    for (std::size_t k = 0; k < points.properties.size(); ++k) {
        const Property& property = points.properties[k];
        PointLayout::Target target;
        constexpr double kMax = std::numeric_limits<double>::max();
        target.summary = {property.name, 1, kMax, -kMax};
        target.axis = index_in(property.name, {"x", "y", "z"});
        target.color = index_in(property.name, {"red", "green", "blue"});
        target.fields = std::move(fields.of_column[k]);
        layout.targets.push_back(std::move(target));
    }
    return layout;
}

std::uint8_t color_byte(double value, Type type) {
    const bool real = type == Type::float32 || type == Type::float64;
    const double scaled = value * (real ? 255.0 : type == Type::uint16 ? 1.0 / 257.0 : 1.0);
    // Written so that NaN becomes 0.
    return static_cast<std::uint8_t>(scaled > 0.0 ? std::lround(std::min(scaled, 255.0)) : 0);
}

template <class Values>
class PointReader {
  public:
    PointReader(const Path& file, Values values) : file_(file), values_(values) {}

    void skip(const Element& element) {
        for (std::uint64_t i = 0; i < element.count; ++i) {
            for (const Property& property : element.properties) skip(property, element, i);
        }
    }

    void read(const Element& points, PointLayout& layout, bool summarize, Particles& particles) {
        particles.positions.reserve(points.count);
        for (Field& field : particles.fields) field.values.resize(field.components * points.count);
        const bool colored = std::ranges::count_if(layout.targets, [](const auto& target) {
                                 return target.color >= 0;
                             }) == 3;
        for (std::uint64_t i = 0; i < points.count; ++i) {
            std::array<double, 3> position{};
            std::array<std::uint8_t, 3> color{};
            for (std::size_t k = 0; k < points.properties.size(); ++k) {
                const Property& property = points.properties[k];
                if (property.length_type) {
                    skip(property, points, i);
                    continue;
                }
                const double number = value(property.type, points, i);
                PointLayout::Target& target = layout.targets[k];
                if (target.axis >= 0) position[static_cast<std::size_t>(target.axis)] = number;
                if (target.color >= 0) {
                    color[static_cast<std::size_t>(target.color)] =
                        color_byte(number, property.type);
                }
                for (const FieldLayout::Place place : target.fields) {
                    Field& field = particles.fields[place.field];
                    field.values[field.components * i + place.component] =
                        static_cast<float>(number);
                }
                if (summarize && std::isfinite(number)) {
                    target.summary.least = std::min(target.summary.least, number);
                    target.summary.most = std::max(target.summary.most, number);
                }
            }
            const Vec3d p{position[0], position[1], position[2]};
            if (i == 0 && std::isfinite(p.x + p.y + p.z)) particles.origin = p;
            particles.positions.push_back(to_float(p - particles.origin));
            if (colored) particles.colors.push_back({color[0], color[1], color[2]});
        }
    }

  private:
    double value(Type type, const Element& element, std::uint64_t index) {
        double number = 0.0;
        if (values_.read(type, number)) return number;
        throw InputError(file_,
                         fmt::format("the data end or are unreadable in {} {} of {}; was the "
                                     "file written to the end?",
                                     element.name, index + 1, element.count));
    }
    void skip(const Property& property, const Element& element, std::uint64_t index) {
        const double count =
            property.length_type ? value(*property.length_type, element, index) : 1;
        for (double k = 0; k < count; ++k) value(property.type, element, index);
    }

    const Path& file_;
    Values values_;
};

template <class Values>
void read_all(const Path& file, const Header& header, Values values, bool summarize,
              PointLayout& layout, Particles& particles) {
    PointReader<Values> reader(file, values);
    for (const Element& element : header.elements) {
        if (element.name == "vertex") {
            reader.read(element, layout, summarize, particles);
            return;
        }
        reader.skip(element);
    }
}

}  // namespace

FileContents read_points(const Path& file, const Header& header, std::string_view bytes,
                         const ReadOptions& options) {
    Particles particles;
    PointLayout layout = make_layout(*header.find("vertex"), options, particles);
    const bool summarize = options.summarize;
    if (header.encoding == Encoding::ascii) {
        read_all(file, header, AsciiValues(bytes, header.body), summarize, layout, particles);
    } else {
        const bool little = header.encoding == Encoding::little_endian;
        const BinaryValues values(header.body, little ? std::endian::little : std::endian::big);
        read_all(file, header, values, summarize, layout, particles);
    }
    FileContents contents;
    for (const PointLayout::Target& target : layout.targets) {
        if (target.axis < 0) contents.fields.push_back(target.summary);
    }
    return particle_contents(file, header.encoding == Encoding::ascii ? "ASCII PLY" : "binary PLY",
                             std::move(particles), std::move(contents), options);
}

}  // namespace ink::ply
