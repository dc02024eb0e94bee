#include "scene/particles.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <map>
#include <span>
#include <type_traits>
#include <utility>

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/text.h"
#include "scene/color_scale.h"
#include "scene/kind_colors.h"
#include "scene/particle_glyphs.h"
#include "scene/representation.h"

namespace ink {

namespace {

constexpr std::size_t kGrain = 16384;

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
    return std::ranges::find(names, to_lower(name)) != names.end();
}

/// One number a particle. Throws Error where the field is not there.
std::vector<float> field_values(const Particles& particles, std::string_view flag,
                                const std::string& name) {
    std::vector<float> values = scalar_values(particles.fields, name);
    if (values.size() == particles.count()) return values;
    throw Error(fmt::format("--{}: there is no field '{}'; 'inktrace info' lists what there is",
                            flag, name));
}

}  // namespace

bool is_radius_name(std::string_view name) {
    return is_one_of(name, {"radius", "radii", "r", "rad", "pscale", "p.radius"});
}
bool is_diameter_name(std::string_view name) { return is_one_of(name, {"diameter", "diam", "d"}); }

std::vector<std::string> requested_fields(const DataSettings& settings) {
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
        if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(name);
    };
    if (!parse_double(settings.radius)) add(settings.radius);
    if (settings.color_by != "none" && !parse_color(settings.color_by)) add(settings.color_by);
    add(settings.parts);
    add(settings.glyph_field);
    return names;
}

namespace {

/// Radii where they differ, or one for all.
struct Radii {
    std::span<const float> each;
    float all = 1.0F;        ///< where they do not differ
    float scale = 1.0F;      ///< of `each`
    std::vector<float> own;  ///< `each`, where it is not a field's

    float at(std::size_t i) const { return each.empty() ? all : each[i] * scale; }
};

/// May refer to the fields of `particles`.
Radii particle_radii(const Particles& particles, const DataSettings& settings, Object& object,
                     std::vector<std::string>& warnings) {
    if (const auto uniform = uniform_radius(settings.radius)) {
        return {.each = {}, .all = static_cast<float>(*uniform), .own = {}};
    }
    if (!settings.radius.empty()) {
        Radii radii{.each = {}, .own = field_values(particles, "radius", settings.radius)};
        radii.each = radii.own;
        if (is_diameter_name(settings.radius)) radii.scale = 0.5F;
        return radii;
    }
    for (const auto& [is_name, scale] :
         {std::pair{&is_radius_name, 1.0F}, {&is_diameter_name, 0.5F}}) {
        for (const Field& field : particles.fields) {
            if (!is_name(field.name) || field.components != 1) continue;
            return {.each = field.values, .scale = scale, .own = {}};
        }
    }
    const double radius = touching_radius(particles.positions);
    warnings.push_back(fmt::format(
        "The particles have no radius; {:.4g} was chosen, half the distance between neighbours "
        "(--radius sets one).",
        radius));
    object.chosen_radius = radius;
    return {.each = {}, .all = static_cast<float>(radius), .own = {}};
}

/// Particles of one value of a field are one part.
std::vector<std::uint32_t> parts_by_value(const std::vector<float>& values,
                                          std::span<const std::string> words,
                                          std::vector<std::string>& names) {
    std::map<float, std::uint32_t> part_of;
    for (const float value : values) part_of.try_emplace(value, 0);
    std::uint32_t next = 0;
    for (auto& [value, part] : part_of) {
        part = next++;
        names.push_back(words.empty() ? fmt::format("{}", value)
                                      : words[static_cast<std::size_t>(value)]);
    }
    std::vector<std::uint32_t> parts;
    parts.reserve(values.size());
    for (const float value : values) parts.push_back(part_of.at(value));
    return parts;
}

/// Nothing larger is drawn: it is damage, not data.
constexpr float kLargest = 1e15F;

bool is_drawable(const Sphere& sphere) { return sphere.radius > 0.0F && sphere.radius <= kLargest; }

bool is_drawable(const Placement& place) {
    for (const Vec3f axis : {place.x_axis, place.y_axis, place.z_axis}) {
        if (!(length(to_double(axis)) <= kLargest)) return false;
    }
    return has_volume(place);
}

bool has_place(Vec3f p) {
    return std::abs(p.x) <= kLargest && std::abs(p.y) <= kLargest && std::abs(p.z) <= kLargest;
}

Vec3f place_of(const Sphere& sphere) { return sphere.centre; }
Vec3f place_of(const Placement& placement) { return placement.origin; }

/// What most files hold; said quickly.
template <class Primitive>
bool all_drawable(const std::vector<Primitive>& primitives) {
    std::atomic<bool> all = true;
    parallel_ranges(primitives.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        bool good = true;
        for (std::size_t i = begin; i < end; ++i) {
            good &= has_place(place_of(primitives[i])) && is_drawable(primitives[i]);
        }
        if (!good) all = false;
    });
    return all;
}

/// Which particles can be drawn: a place and a size, inside the box. Empty: all of them.
template <class Primitive>
std::vector<std::uint8_t> drawable(const Particles& particles,
                                   const std::vector<Primitive>& primitives,
                                   const DataSettings& settings,
                                   std::vector<std::string>& warnings) {
    const bool clipped = !settings.clip.everything();
    if (!clipped && particles.count() > 0 && all_drawable(primitives)) return {};
    std::vector<std::uint8_t> keep(particles.count());
    std::atomic<std::uint64_t> bad = 0;
    std::atomic<std::uint64_t> outside = 0;
    parallel_ranges(keep.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3f p = particles.positions[i];
            const bool placed = has_place(p);
            const bool sized = is_drawable(primitives[i]);
            const bool inside = !clipped || settings.clip.holds(particles.origin + to_double(p));
            keep[i] = placed && sized && inside ? 1 : 0;
            if (!placed || !sized) ++bad;
            if (placed && sized && !inside) ++outside;
        }
    });
    if (bad > 0) {
        warnings.push_back(fmt::format(
            "{} of {} particles have no finite place or positive {} and were left out.", bad.load(),
            keep.size(), std::is_same_v<Primitive, Sphere> ? "radius" : "volume"));
    }
    if (bad + outside == keep.size()) {
        throw Error(outside > 0 ? "--clip: no particle is inside the box"
                                : "no particle has a finite place and a positive radius; check the "
                                  "export");
    }
    return keep;
}

template <class T>
void keep_only(const std::vector<std::uint8_t>& keep, std::vector<T>& values) {
    if (values.empty()) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < keep.size(); ++i) {
        if (keep[i] != 0) values[kept++] = values[i];
    }
    values.resize(kept);
}

std::vector<Rgb8> particle_colors(Particles& particles, const DataSettings& settings,
                                  Object& object) {
    const auto take = [&](Coloring coloring) {
        object.color_scale = std::move(coloring.scale);
        return std::move(coloring.colors);
    };
    if (settings.color_by.empty()) {
        if (!particles.colors.empty()) return std::move(particles.colors);
        auto kinds = color_kinds(particles.fields);
        return kinds ? take(std::move(*kinds)) : std::vector<Rgb8>();
    }
    if (settings.color_by == "none") return {};
    if (const auto color = parse_color(settings.color_by)) {
        object.material.color = *color;
        return {};
    }
    const std::vector<float> values = field_values(particles, "color-by", settings.color_by);
    const std::span<const std::string> words = words_of(particles.fields, settings.color_by);
    return take(words.empty() ? color_field(settings.color_by, values, settings)
                              : color_words(settings.color_by, values, words));
}

Spheres make_spheres(const Particles& particles, const Radii& radii) {
    Spheres shape;
    reserve_large(shape.spheres, particles.count());
    shape.spheres.resize(particles.count());
    parallel_ranges(particles.count(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            shape.spheres[i] = {particles.positions[i], radii.at(i)};
        }
    });
    return shape;
}

Glyphs make_glyphs(const Particles& particles, const GlyphAxes& axes, const Radii& radii,
                   const DataSettings& settings) {
    Glyphs shape;
    shape.shape.kind = settings.glyph == Glyph::box ? GlyphKind::box : GlyphKind::ellipsoid;
    shape.placements.resize(particles.count());
    parallel_ranges(particles.count(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            shape.placements[i] = axes.placement(i, radii.at(i));
            shape.placements[i].origin = particles.positions[i];
        }
    });
    return shape;
}

/// The primitives that can be drawn, in their colours and parts. Returns which particles they are,
/// or nothing where they are all.
template <class S, class Primitive>
std::vector<std::uint32_t> finish(const Particles& particles, S shape,
                                  std::vector<Primitive> S::*primitives,
                                  const DataSettings& settings, Object& object,
                                  std::vector<std::string>& warnings) {
    const std::vector<std::uint8_t> keep =
        drawable(particles, shape.*primitives, settings, warnings);
    std::vector<std::uint32_t> rows;
    if (!keep.empty() && std::memchr(keep.data(), 0, keep.size()) != nullptr) {
        keep_only(keep, shape.*primitives);
        keep_only(keep, shape.colors);
        keep_only(keep, shape.parts);
        for (std::uint32_t i = 0; i < keep.size(); ++i) {
            if (keep[i] != 0) rows.push_back(i);
        }
    }
    object.shape = std::move(shape);
    return rows;
}

}  // namespace

std::vector<Object> represent(Particles particles, const DataSettings& settings,
                              std::vector<std::string>& warnings, bool facts) {
    Object object;
    object.name = particles.name;
    object.kind = ObjectKind::particles;
    object.frame.origin = particles.origin;
    std::vector<Rgb8> colors = particle_colors(particles, settings, object);
    std::vector<std::uint32_t> parts;
    if (!settings.parts.empty()) {
        parts = parts_by_value(field_values(particles, "ids", settings.parts),
                               words_of(particles.fields, settings.parts), object.part_names);
    }
    std::vector<Field> fields;
    std::vector<std::uint32_t> rows;
    const auto complete = [&](auto& shape) {
        fields = std::exchange(particles.fields, {});
        if (!facts) fields = {};
        shape.colors = std::move(colors);
        shape.parts = std::move(parts);
    };
    if (settings.glyph == Glyph::sphere) {
        Spheres shape =
            make_spheres(particles, particle_radii(particles, settings, object, warnings));
        complete(shape);
        rows = finish(particles, std::move(shape), &Spheres::spheres, settings, object, warnings);
    } else {
        const GlyphAxes axes(particles.fields, settings, warnings);
        const Radii radii =
            axes.have_sizes() ? Radii() : particle_radii(particles, settings, object, warnings);
        Glyphs shape = make_glyphs(particles, axes, radii, settings);
        complete(shape);
        rows = finish(particles, std::move(shape), &Glyphs::placements, settings, object, warnings);
    }
    if (facts) object.facts = field_facts(std::move(fields), std::move(rows));
    std::vector<Object> objects;
    objects.push_back(std::move(object));
    return objects;
}

}  // namespace ink
