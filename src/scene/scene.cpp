#include "scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/parallel.h"

namespace ink {

namespace {

constexpr std::size_t kGrain = 1 << 16;

/// Bounds of `count` primitives, where `add(bounds, i)` extends a box by primitive i.
template <class Add>
Bounds3f bounds_of(std::size_t count, const Add& add) {
    Bounds3f total;
    std::mutex mutex;
    parallel_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
        Bounds3f part;
        for (std::size_t i = begin; i < end; ++i) add(part, i);
        const std::scoped_lock lock(mutex);
        total.add(part);
    });
    return total;
}

Bounds3f shape_bounds(const Spheres& shape) {
    return bounds_of(shape.count(), [&](Bounds3f& box, std::size_t i) {
        const Sphere sphere = shape.at(i);
        box.add(sphere.centre, sphere.radius);
    });
}

Bounds3f shape_bounds(const Mesh& shape) {
    return bounds_of(shape.vertices.size(),
                     [&](Bounds3f& box, std::size_t i) { box.add(shape.vertices[i]); });
}

Bounds3f shape_bounds(const Glyphs& shape) {
    return bounds_of(shape.count(), [&](Bounds3f& box, std::size_t i) {
        box.add(glyph_bounds(shape.shape, shape.at(i)));
    });
}

Bounds3f shape_bounds(const Hexahedra& shape) {
    return bounds_of(shape.corners.size(), [&](Bounds3f& box, std::size_t i) {
        box.add(hexahedron_bounds(shape.corners[i]));
    });
}

/// A change of frame: stored' = stored * scale + shift.
struct Rebase {
    double scale;
    Vec3d shift;

    Rebase(const Frame& from, const Frame& to)
        : scale(from.unit / to.unit), shift((from.origin - to.origin) / to.unit) {}
    Vec3f operator()(Vec3f p) const { return to_float(to_double(p) * scale + shift); }
};

void rebase(std::vector<Copy>& copies, const Rebase& move) {
    for (Copy& copy : copies) {
        Vec3d& shift = copy.motion.shift;
        shift = shift * move.scale + move.shift - copy.motion.turn(move.shift);
    }
}

void rebase(Spheres& shape, const Rebase& move) {
    parallel_ranges(shape.spheres.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Sphere& sphere = shape.spheres[i];
            sphere.centre = move(sphere.centre);
            sphere.radius = static_cast<float>(sphere.radius * move.scale);
        }
    });
    rebase(shape.copies, move);
}

void rebase(Mesh& shape, const Rebase& move) {
    parallel_ranges(shape.vertices.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) shape.vertices[i] = move(shape.vertices[i]);
    });
}

void rebase(Glyphs& shape, const Rebase& move) {
    parallel_ranges(shape.placements.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Placement& place = shape.placements[i];
            place.origin = move(place.origin);
            for (Vec3f* axis : {&place.x_axis, &place.y_axis, &place.z_axis}) {
                *axis = to_float(to_double(*axis) * move.scale);
            }
        }
    });
    rebase(shape.copies, move);
}

void rebase(Hexahedra& shape, const Rebase& move) {
    parallel_ranges(shape.corners.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            for (Vec3f& corner : shape.corners[i]) corner = move(corner);
        }
    });
}

/// The frame about `bounds`: a power of two as unit, so that a change of scale rounds nothing.
Frame frame_about(const Bounds3d& bounds) {
    const double half_diagonal = length(bounds.extent()) * 0.5;
    const double unit = half_diagonal > 0.0 ? std::exp2(std::ceil(std::log2(half_diagonal))) : 1.0;
    return {bounds.centre(), unit};
}

}  // namespace

std::size_t primitive_count(const Shape& shape) { return numbering(shape).count(); }

CopyNumbering numbering(const Shape& shape) {
    if (const auto* spheres = std::get_if<Spheres>(&shape)) return spheres->numbering();
    if (const auto* glyphs = std::get_if<Glyphs>(&shape)) return glyphs->numbering();
    if (const auto* mesh = std::get_if<Mesh>(&shape)) return {{}, mesh->triangles.size()};
    return {{}, std::get<Hexahedra>(shape).corners.size()};
}

std::string name_of_part(std::span<const std::string> names, std::uint32_t a_copy,
                         std::uint32_t part) {
    if (a_copy == 0 || part < a_copy) return part < names.size() ? names[part] : "";
    std::string name = names[part % a_copy];
    // Of "A/ALA 12", the chain is the copy.
    name.insert(std::min(name.find('/'), name.size()), copy_suffix(part / a_copy));
    return name;
}

std::string Object::part_name(std::uint32_t part) const {
    return name_of_part(part_names, numbering(shape).parts_a_copy, part);
}

std::string copy_suffix(std::size_t number) {
    return number == 0 ? std::string() : fmt::format("-{}", number + 1);
}

std::uint32_t part_of(const Shape& shape, std::size_t primitive) {
    const CopyNumbering numbers = numbering(shape);
    return std::visit([&](const auto& s) { return s.parts[numbers.source(primitive)]; }, shape) +
           numbers.first_part(primitive);
}

bool has_parts(const Shape& shape) {
    return std::visit([](const auto& s) { return !s.parts.empty(); }, shape);
}

Bounds3d Object::world_bounds() const {
    const Bounds3f stored = std::visit([](const auto& s) { return shape_bounds(s); }, shape);
    Bounds3d world;
    if (stored.empty()) return world;
    world.add(frame.to_world(stored.lower));
    world.add(frame.to_world(stored.upper));
    return world;
}

Scene::Scene(std::vector<Object> objects) : objects_(std::move(objects)) {
    Bounds3d world;
    for (const Object& object : objects_) world.add(object.world_bounds());
    if (world.empty()) return;

    frame_ = frame_about(world);
    for (Object& object : objects_) {
        const Rebase move(object.frame, frame_);
        std::visit([&](auto& shape) { rebase(shape, move); }, object.shape);
        object.frame = frame_;
    }
    bounds_.add(frame_.from_world(world.lower));
    bounds_.add(frame_.from_world(world.upper));
}

std::size_t Scene::primitive_count() const {
    std::size_t count = 0;
    for (const Object& object : objects_) count += object.primitive_count();
    return count;
}

}  // namespace ink
