#include "scenes.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "scene/mesh.h"

namespace ink::bench {

NamedScene random_spheres(std::size_t count) {
    std::mt19937 random(1);
    // The engine's own numbers, not a distribution's, which differ between standard libraries.
    const auto coordinate = [&] { return static_cast<float>(random()) * 0x1p-32F; };
    constexpr double kFilled = 0.2;
    const auto radius = static_cast<float>(
        std::cbrt(kFilled / static_cast<double>(count) * 3.0 / (4.0 * std::numbers::pi)));
    Spheres shape;
    for (std::size_t i = 0; i < count; ++i) {
        const float x = coordinate();
        const float y = coordinate();
        shape.spheres.push_back({{x, y, coordinate()}, radius});
        const auto shade = static_cast<std::uint8_t>(random() % 128 + 128);
        shape.colors.push_back({shade, 200, 160});
    }
    Object object;
    object.name = "spheres";
    object.kind = ObjectKind::particles;
    object.shape = std::move(shape);
    return {fmt::format("{} random spheres", count), {std::move(object)}};
}

namespace {

/// Numbers in [-1/2, 1/2) from the engine itself.
class Random {
  public:
    float number() { return static_cast<float>(engine_()) * 0x1p-32F - 0.5F; }
    Vec3f point() {
        const float x = number();
        const float y = number();
        return {x, y, number()};
    }

  private:
    std::mt19937 engine_{2};
};

Object random_glyphs(const UnitShape& shape, std::size_t count, Random& random) {
    const auto size = static_cast<float>(0.4 / std::cbrt(static_cast<double>(count)));
    Glyphs glyphs{shape, {}, {}, {}};
    for (std::size_t i = 0; i < count; ++i) {
        Placement place;
        for (Vec3f* axis : {&place.x_axis, &place.y_axis, &place.z_axis}) {
            *axis = (*axis + random.point() * 0.6F) * size;
        }
        place.origin = random.point();
        glyphs.placements.push_back(place);
    }
    Object object;
    object.name = "glyphs";
    object.kind = ObjectKind::particles;
    object.shape = std::move(glyphs);
    return object;
}

Object random_hexahedra(std::size_t count, Random& random) {
    const auto size = static_cast<float>(0.8 / std::cbrt(static_cast<double>(count)));
    Hexahedra solids;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3f at = random.point();
        Hexahedra::Corners corners;
        for (std::size_t k = 0; k < corners.size(); ++k) {
            const bool right = k % 4 == 1 || k % 4 == 2;
            const Vec3f corner{right ? 1.0F : 0.0F, k % 4 >= 2 ? 1.0F : 0.0F, k >= 4 ? 1.0F : 0.0F};
            corners[k] = at + (corner + random.point() * 0.3F) * size;
        }
        solids.corners.push_back(corners);
    }
    Object object;
    object.name = "hexahedra";
    object.shape = std::move(solids);
    return object;
}

Mesh icosahedron() {
    const float g = std::numbers::phi_v<float>;
    Mesh mesh;
    mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                     {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                      {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                      {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                      {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    return mesh;
}

void subdivide(Mesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
        const auto [entry, fresh] = middles.try_emplace(
            std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
        if (fresh) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]) * 0.5F);
        return entry->second;
    };
    std::vector<Mesh::Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
        const std::uint32_t ab = middle(a, b);
        const std::uint32_t bc = middle(b, c);
        const std::uint32_t ca = middle(c, a);
        finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
}

}  // namespace

NamedScene random_boxes(std::size_t count) {
    Random random;
    return {fmt::format("{} random boxes", count),
            {random_glyphs({GlyphKind::box}, count, random)}};
}

NamedScene mixed_shapes() {
    constexpr std::size_t kEach = 2000;
    Random random;
    std::vector<Object> objects = random_spheres(kEach).objects;
    for (Sphere& sphere : std::get<Spheres>(objects[0].shape).spheres) {
        sphere.centre = sphere.centre - Vec3f{0.5F, 0.5F, 0.5F};
    }
    using enum GlyphKind;
    for (const UnitShape& shape : {UnitShape{box}, UnitShape{ellipsoid}, UnitShape{frustum},
                                   UnitShape{.kind = frustum, .a = 0.0}, UnitShape{disc}}) {
        objects.push_back(random_glyphs(shape, kEach, random));
    }
    objects.push_back(random_hexahedra(kEach, random));
    Object mesh = bumpy_sphere(4).objects[0];
    for (Vec3f& vertex : std::get<Mesh>(mesh.shape).vertices) vertex = vertex * 0.3F;
    objects.push_back(std::move(mesh));
    return {"mixed shapes", std::move(objects)};
}

NamedScene bumpy_sphere(int levels) {
    Mesh mesh = icosahedron();
    for (int level = 0; level < levels; ++level) subdivide(mesh);
    for (Vec3f& vertex : mesh.vertices) {
        const Vec3f n = normalize(vertex);
        const float bump = std::sin(9.0F * n.x) * std::sin(8.0F * n.y) * std::sin(7.0F * n.z);
        vertex = n * (1.0F + 0.15F * bump);
    }
    smooth_normals(mesh);
    Object object;
    object.name = "bumpy sphere";
    const std::size_t triangles = mesh.triangles.size();
    object.shape = std::move(mesh);
    return {fmt::format("mesh of {} triangles", triangles), {std::move(object)}};
}

}  // namespace ink::bench
