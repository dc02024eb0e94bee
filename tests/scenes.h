#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "scene/scene.h"

/// Scenes with known answers.
namespace ink::test {

inline Object sphere_object(std::vector<Sphere> spheres) {
    Object object;
    object.name = "spheres";
    object.kind = ObjectKind::particles;
    object.shape = Spheres{std::move(spheres), {}, {}};
    return object;
}

inline Object mesh_object(std::vector<Vec3f> vertices, std::vector<Mesh::Triangle> triangles) {
    Object object;
    object.name = "mesh";
    Mesh mesh;
    mesh.vertices = std::move(vertices);
    mesh.triangles = std::move(triangles);
    object.shape = std::move(mesh);
    return object;
}

/// A square in the plane z = 0 about the origin, one edge of which runs through the origin at
/// `angle_deg` from the x axis; the square lies on the left of that direction.
inline Object half_plane(double angle_deg, double size = 20.0) {
    const double a = angle_deg * std::numbers::pi / 180.0;
    const Vec3d along{std::cos(a), std::sin(a), 0.0};
    const Vec3d left{-along.y, along.x, 0.0};
    const auto corner = [&](double s, double t) { return to_float(along * s + left * t); };
    return mesh_object({corner(-size, 0), corner(size, 0), corner(size, size), corner(-size, size)},
                       {{0, 1, 2}, {0, 2, 3}});
}

/// A number in [0, 1) from the engine itself: distributions differ between standard libraries.
inline float uniform(std::mt19937& random) { return static_cast<float>(random() >> 8U) * 0x1p-24F; }

inline Vec3f uniform_point(std::mt19937& random) {
    const float x = uniform(random);
    const float y = uniform(random);
    return {x, y, uniform(random)};
}

/// Overlapping spheres of different sizes, and a soup of triangles among them.
inline std::vector<Object> random_objects(unsigned seed, int spheres, int triangles) {
    std::mt19937 random(seed);
    std::vector<Sphere> balls;
    for (int i = 0; i < spheres; ++i) {
        const Vec3f centre = uniform_point(random);
        balls.push_back({centre, 0.02F + 0.15F * uniform(random)});
    }
    std::vector<Vec3f> vertices;
    std::vector<Mesh::Triangle> indices;
    for (int i = 0; i < triangles; ++i) {
        const Vec3f middle = uniform_point(random);
        const auto first = static_cast<std::uint32_t>(vertices.size());
        for (int k = 0; k < 3; ++k) {
            vertices.push_back(middle + (uniform_point(random) - Vec3f{0.5F, 0.5F, 0.5F}) * 0.3F);
        }
        indices.push_back({first, first + 1, first + 2});
    }
    return {sphere_object(std::move(balls)), mesh_object(std::move(vertices), std::move(indices))};
}

/// Four places: as things are, turned and moved.
inline std::vector<Copy> four_copies() {
    return {{{.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .shift = {}}, 0},
            {{.rotation = {0, -1, 0, 1, 0, 0, 0, 0, 1}, .shift = {0.5, 0.25, -0.5}}, 1},
            {{.rotation = {0.8, 0, 0.6, 0, 1, 0, -0.6, 0, 0.8}, .shift = {0.25, -0.5, 0.75}}, 2},
            {{.rotation = {-1, 0, 0, 0, -1, 0, 0, 0, 1}, .shift = {1.5, 1, 0.25}}, 3}};
}

/// The same with the spheres there four times.
inline std::vector<Object> random_copies(unsigned seed, int spheres, int triangles) {
    std::vector<Object> objects = random_objects(seed, spheres, triangles);
    std::get<Spheres>(objects[0].shape).copies = four_copies();
    return objects;
}

/// Cylinders without caps between random points, four times.
inline Object copied_sticks(unsigned seed, int count) {
    std::mt19937 random(seed);
    Glyphs sticks;
    sticks.shape = {.kind = GlyphKind::frustum, .capped = false};
    for (int i = 0; i < count; ++i) {
        const Vec3d from = to_double(uniform_point(random));
        const Vec3d way = to_double(uniform_point(random)) * 0.5;
        sticks.placements.push_back(placement_between(from, from + way, 0.02 + 0.08 * i / count));
    }
    sticks.copies = four_copies();
    Object object;
    object.name = "sticks";
    object.kind = ObjectKind::shape;
    object.shape = std::move(sticks);
    return object;
}

/// Sticks without caps in a chain that winds about, from ball to ball; balls of the sticks' radius,
/// as `--represent sticks` draws them, or larger ones.
inline std::vector<Object> chain_of_sticks(unsigned seed, int count, float ball) {
    constexpr double kRadius = 0.02;
    std::mt19937 random(seed);
    std::vector<Sphere> balls;
    Glyphs sticks;
    sticks.shape = {.kind = GlyphKind::frustum, .capped = false};
    Vec3f at{0.5F, 0.5F, 0.5F};
    for (int i = 0; i < count; ++i) {
        balls.push_back({at, ball * static_cast<float>(kRadius)});
        Vec3f next = at + (uniform_point(random) - Vec3f{0.5F, 0.5F, 0.5F}) * 0.3F;
        next = {std::clamp(next.x, 0.0F, 1.0F), std::clamp(next.y, 0.0F, 1.0F),
                std::clamp(next.z, 0.0F, 1.0F)};
        const Vec3d middle = to_double(at + next) * 0.5;
        sticks.placements.push_back(placement_between(to_double(at), middle, kRadius));
        sticks.placements.push_back(placement_between(middle, to_double(next), kRadius));
        at = next;
    }
    Object object;
    object.name = "sticks";
    object.kind = ObjectKind::shape;
    object.shape = std::move(sticks);
    return {sphere_object(std::move(balls)), std::move(object)};
}

inline Vec3f random_vector(std::mt19937& random) {
    return (uniform_point(random) - Vec3f{0.5F, 0.5F, 0.5F}) * 2.0F;
}

/// Glyphs of random shape and shear, `size` long at most, each of its volume's cube root at least a
/// tenth of that.
inline Object random_glyphs(const UnitShape& shape, int count, double size, std::mt19937& random) {
    Glyphs glyphs{shape, {}, {}, {}};
    while (glyphs.placements.size() < static_cast<std::size_t>(count)) {
        const auto scale = static_cast<float>(size * std::pow(10.0, -uniform(random)));
        const Placement place{random_vector(random) * scale, random_vector(random) * scale,
                              random_vector(random) * scale, random_vector(random)};
        const float volume = dot(place.x_axis, cross(place.y_axis, place.z_axis));
        if (std::abs(volume) < 0.05F * scale * scale * scale) continue;
        glyphs.placements.push_back(place);
    }
    Object object;
    object.kind = ObjectKind::shape;
    object.shape = std::move(glyphs);
    return object;
}

inline Hexahedra::Corners box_corners(Vec3f lower, Vec3f upper) {
    const auto [x, y, z] = lower;
    const auto [u, v, w] = upper;
    return {
        {{x, y, z}, {u, y, z}, {u, v, z}, {x, v, z}, {x, y, w}, {u, y, w}, {u, v, w}, {x, v, w}}};
}

inline Object hexahedron_object(std::vector<Hexahedra::Corners> corners) {
    Object object;
    object.kind = ObjectKind::shape;
    object.shape = Hexahedra{std::move(corners), {}, {}};
    return object;
}

/// The objects moved and scaled in the world: p -> p * scale + shift.
inline std::vector<Object> placed(std::vector<Object> objects, double scale, Vec3d shift) {
    for (Object& object : objects) {
        object.frame.origin = object.frame.origin * scale + shift;
        object.frame.unit *= scale;
    }
    return objects;
}

}  // namespace ink::test
