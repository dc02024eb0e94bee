#include "scene/particles.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include "base/bounds.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "scene/representation.h"

namespace ink {

namespace {

constexpr std::size_t kGrain = 16384;
constexpr float kNone = std::numeric_limits<float>::infinity();

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
    return is_one_of(name, {"radius", "radii", "r", "rad"});
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

/// Points sorted into the cells of a grid that has about as many cells as there are points.
class PointGrid {
  public:
    explicit PointGrid(const std::vector<Vec3f>& points) : points_(points) {
        Bounds3f box;
        for (const Vec3f& p : points) box.add(p);
        lower_ = box.lower;
        choose_cells(box.extent());
        begin_.assign(cells_[0] * cells_[1] * cells_[2] + 1, 0);
        for (const Vec3f& p : points) ++begin_[cell(p) + 1];
        for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
        order_.resize(points.size());
        std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
        for (std::size_t i = 0; i < points.size(); ++i) {
            order_[next[cell(points[i])]++] = static_cast<std::uint32_t>(i);
        }
    }

    /// Distance to the nearest point that is elsewhere, among the cell of `p` and those about it;
    /// infinity where there is none.
    float nearest(Vec3f p) const {
        // More neighbours than any packing has: points lie on one another.
        constexpr std::size_t kMostCandidates = 4096;
        std::size_t looked_at = 0;
        float best = kNone;
        const std::array<std::size_t, 3> home = place(p);
        const auto range = [&](int axis) {
            const std::size_t at = home[static_cast<std::size_t>(axis)];
            const std::size_t last = cells_[static_cast<std::size_t>(axis)] - 1;
            return std::pair{at == 0 ? 0 : at - 1, std::min(at + 1, last)};
        };
        for (std::size_t z = range(2).first; z <= range(2).second; ++z) {
            for (std::size_t y = range(1).first; y <= range(1).second; ++y) {
                for (std::size_t x = range(0).first; x <= range(0).second; ++x) {
                    const std::size_t c = (z * cells_[1] + y) * cells_[0] + x;
                    for (std::uint32_t k = begin_[c]; k < begin_[c + 1]; ++k) {
                        if (++looked_at > kMostCandidates) return best;
                        const float distance = length(points_[order_[k]] - p);
                        if (distance > 0.0F) best = std::min(best, distance);
                    }
                }
            }
        }
        return best;
    }

  private:
    void choose_cells(Vec3f extent) {
        const std::array<float, 3> sides{extent.x, extent.y, extent.z};
        const float longest = *std::ranges::max_element(sides);
        // A plane of particles has cells in two directions only.
        constexpr float kFlat = 1e-4F;
        double volume = 1.0;
        int dimensions = 0;
        for (const float side : sides) {
            if (!(side > kFlat * longest)) continue;
            volume *= side;
            ++dimensions;
        }
        const double count = static_cast<double>(points_.size());
        const double size = dimensions == 0 ? 1.0 : std::pow(volume / count, 1.0 / dimensions);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const bool flat = !(sides[axis] > kFlat * longest);
            const double cells = flat || !(size > 0.0) ? 1.0 : std::floor(sides[axis] / size);
            cells_[axis] = static_cast<std::size_t>(std::clamp(cells, 1.0, count));
            scale_[axis] = flat ? 0.0 : static_cast<double>(cells_[axis]) / double{sides[axis]};
        }
    }
    std::array<std::size_t, 3> place(Vec3f p) const {
        const Vec3f d = p - lower_;
        const std::array<float, 3> offset{d.x, d.y, d.z};
        std::array<std::size_t, 3> at{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double along = std::max(offset[axis] * scale_[axis], 0.0);
            at[axis] = std::min(static_cast<std::size_t>(along), cells_[axis] - 1);
        }
        return at;
    }
    std::size_t cell(Vec3f p) const {
        const std::array<std::size_t, 3> at = place(p);
        return (at[2] * cells_[1] + at[1]) * cells_[0] + at[0];
    }

    const std::vector<Vec3f>& points_;
    Vec3f lower_;
    std::array<std::size_t, 3> cells_{1, 1, 1};
    std::array<double, 3> scale_{};  ///< cells per length
    std::vector<std::uint32_t> begin_, order_;
};

}  // namespace

namespace {

bool is_placed(Vec3f p) {
    constexpr float kLargest = 1e15F;
    return std::abs(p.x) <= kLargest && std::abs(p.y) <= kLargest && std::abs(p.z) <= kLargest;
}

}  // namespace

double touching_radius(const std::vector<Vec3f>& positions) {
    if (!std::ranges::all_of(positions, is_placed)) {
        std::vector<Vec3f> placed;
        std::ranges::copy_if(positions, std::back_inserter(placed), is_placed);
        return touching_radius(placed);
    }
    if (positions.size() < 2) return 0.5;
    const PointGrid grid(positions);
    constexpr std::size_t kSample = 2000;
    const std::size_t step = std::max<std::size_t>(positions.size() / kSample, 1);
    std::vector<float> distances;
    for (std::size_t i = 0; i < positions.size(); i += step) {
        const float distance = grid.nearest(positions[i]);
        if (distance < kNone) distances.push_back(distance);
    }
    if (distances.empty()) {
        Bounds3f box;
        for (const Vec3f& p : positions) box.add(p);
        const float diagonal = length(box.extent());
        return diagonal > 0.0F ? diagonal / 100.0 : 0.5;
    }
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::ranges::nth_element(distances, middle);
    return *middle / 2.0;
}

namespace {

/// Radii where they differ, or one for all.
struct Radii {
    std::vector<float> each;
    float all = 1.0F;

    float at(std::size_t i) const { return each.empty() ? all : each[i]; }
};

Radii particle_radii(const Particles& particles, const DataSettings& settings,
                     std::vector<std::string>& warnings) {
    if (const auto uniform = uniform_radius(settings.radius)) {
        return {{}, static_cast<float>(*uniform)};
    }
    if (!settings.radius.empty()) {
        Radii radii{field_values(particles, "radius", settings.radius)};
        if (is_diameter_name(settings.radius)) {
            for (float& radius : radii.each) radius *= 0.5F;
        }
        return radii;
    }
    for (const auto& [is_name, scale] :
         {std::pair{&is_radius_name, 1.0F}, {&is_diameter_name, 0.5F}}) {
        for (const Field& field : particles.fields) {
            if (!is_name(field.name) || field.components != 1) continue;
            Radii radii{field.values};
            for (float& radius : radii.each) radius *= scale;
            return radii;
        }
    }
    const double radius = touching_radius(particles.positions);
    warnings.push_back(fmt::format(
        "The particles have no radius; {:.4g} was chosen, half the distance between neighbours "
        "(--radius sets one).",
        radius));
    return {{}, static_cast<float>(radius)};
}

/// Particles of whole numbers of a field are one part.
void set_parts(const std::vector<float>& values, Spheres& shape, Object& object) {
    std::map<float, std::uint32_t> part_of;
    for (const float value : values) part_of.try_emplace(value, 0);
    std::uint32_t next = 0;
    for (auto& [value, part] : part_of) {
        part = next++;
        object.part_names.push_back(fmt::format("{}", value));
    }
    shape.parts.reserve(values.size());
    for (const float value : values) shape.parts.push_back(part_of.at(value));
}

/// Which particles can be drawn: a place and a size, inside the box.
std::vector<std::uint8_t> drawable(const Particles& particles, const Radii& radii,
                                   const DataSettings& settings,
                                   std::vector<std::string>& warnings) {
    constexpr float kLargest = 1e15F;
    std::vector<std::uint8_t> keep(particles.count());
    std::uint64_t bad = 0;
    std::uint64_t outside = 0;
    for (std::size_t i = 0; i < keep.size(); ++i) {
        const Vec3f p = particles.positions[i];
        const bool placed =
            std::abs(p.x) <= kLargest && std::abs(p.y) <= kLargest && std::abs(p.z) <= kLargest;
        const bool sized = radii.at(i) > 0.0F && radii.at(i) <= kLargest;
        const bool inside =
            settings.clip.everything() || settings.clip.holds(particles.origin + to_double(p));
        keep[i] = placed && sized && inside ? 1 : 0;
        if (!placed || !sized) ++bad;
        if (placed && sized && !inside) ++outside;
    }
    if (bad > 0) {
        warnings.push_back(fmt::format(
            "{} of {} particles have no finite place or positive radius and were left out.", bad,
            keep.size()));
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
    if (settings.color_by.empty()) return std::move(particles.colors);
    if (settings.color_by == "none") return {};
    if (const auto color = parse_color(settings.color_by)) {
        object.material.color = *color;
        return {};
    }
    return field_colors(field_values(particles, "color-by", settings.color_by), settings);
}

}  // namespace

std::vector<Object> represent(Particles particles, const DataSettings& settings,
                              std::vector<std::string>& warnings, bool facts) {
    Object object;
    object.name = particles.name;
    object.kind = ObjectKind::particles;
    object.frame.origin = particles.origin;
    Spheres shape;
    shape.colors = particle_colors(particles, settings, object);
    if (!settings.parts.empty()) {
        set_parts(field_values(particles, "ids", settings.parts), shape, object);
    }
    const Radii radii = particle_radii(particles, settings, warnings);
    std::vector<Field> fields = std::exchange(particles.fields, {});
    if (!facts) fields = {};
    const std::vector<std::uint8_t> keep = drawable(particles, radii, settings, warnings);
    std::vector<std::uint32_t> rows;
    shape.spheres.resize(particles.count());
    parallel_ranges(particles.count(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            shape.spheres[i] = {particles.positions[i], radii.at(i)};
        }
    });
    if (std::ranges::find(keep, 0) != keep.end()) {
        keep_only(keep, shape.spheres);
        keep_only(keep, shape.colors);
        keep_only(keep, shape.parts);
        for (std::uint32_t i = 0; facts && i < keep.size(); ++i) {
            if (keep[i] != 0) rows.push_back(i);
        }
    }
    object.shape = std::move(shape);
    if (facts) object.facts = field_facts(std::move(fields), std::move(rows));
    std::vector<Object> objects;
    objects.push_back(std::move(object));
    return objects;
}

}  // namespace ink
