// Exact shapes against fine tessellations of their parametric forms: near, at grazing angles and
// from far away.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "accel/shape_intersection.h"
#include "accel/tracer.h"
#include "scenes.h"

namespace ink::test {
namespace {

using std::numbers::pi;

/// A part of a surface over [0, 1]^2.
using Patch = std::function<Vec3d(double u, double v)>;

struct ParametricShape {
    std::string name;
    UnitShape shape;
    std::vector<Patch> patches;
    double error = 0.0;  ///< distance of the tessellation from the shape, at most

    friend std::ostream& operator<<(std::ostream& out, const ParametricShape& shape) {
        return out << shape.name;
    }
};

constexpr std::uint32_t kColumns = 512;
constexpr std::uint32_t kRows = 256;

Vec3d flat(double u, double v) { return {2 * u - 1, 2 * v - 1, 0}; }

Patch disc_at(double z, double radius) {
    return [=](double u, double v) {
        return Vec3d{radius * v * std::cos(2 * pi * u), radius * v * std::sin(2 * pi * u), z};
    };
}

Patch graph_of(const std::function<double(double, double)>& height) {
    return [=](double u, double v) {
        return Vec3d{2 * u - 1, 2 * v - 1, height(2 * u - 1, 2 * v - 1)};
    };
}

double signed_power(double x, double power) {
    return std::copysign(std::pow(std::abs(x), power), x);
}

Patch rounded(double a, double b) {
    return [=](double u, double v) {
        const double angle = 2 * pi * u;
        const double height = pi * (v - 0.5);
        const double ring = signed_power(std::cos(height), a);
        return Vec3d{ring * signed_power(std::cos(angle), b),
                     ring * signed_power(std::sin(angle), b), signed_power(std::sin(height), a)};
    };
}

ParametricShape frustum_of(const std::string& name, double above, bool capped) {
    std::vector<Patch> patches{[=](double u, double v) {
        const double radius = 1 + v * (above - 1);
        return Vec3d{radius * std::cos(2 * pi * u), radius * std::sin(2 * pi * u), 2 * v - 1};
    }};
    if (capped) patches.push_back(disc_at(-1, 1));
    if (capped && above > 0) patches.push_back(disc_at(1, above));
    return {name, {GlyphKind::frustum, above, 1.0, capped}, patches, 1e-4};
}

std::vector<ParametricShape> parametric_shapes() {
    using enum GlyphKind;
    std::vector<ParametricShape> shapes;
    shapes.push_back({"Ellipsoid", {ellipsoid}, {rounded(1, 1)}, 2e-4});
    shapes.push_back(frustum_of("Cylinder", 1.0, true));
    shapes.push_back(frustum_of("Tube", 1.0, false));
    shapes.push_back(frustum_of("Cone", 0.0, true));
    shapes.push_back(frustum_of("Frustum", 0.4, true));
    shapes.push_back({"Disc", {disc}, {disc_at(0, 1)}, 1e-4});
    shapes.push_back({"Rectangle", {rectangle}, {flat}, 1e-6});
    for (const double a : {0.05, 0.4, 0.95}) {
        shapes.push_back({"Torus" + std::to_string(static_cast<int>(100 * a)),
                          {torus, a},
                          {[=](double u, double v) {
                              const double ring = 1 + a * std::cos(2 * pi * v);
                              return Vec3d{ring * std::cos(2 * pi * u), ring * std::sin(2 * pi * u),
                                           a * std::sin(2 * pi * v)};
                          }},
                          2e-4});
    }
    shapes.push_back({"RoundedCube", {superellipsoid, 0.3, 0.3}, {rounded(0.3, 0.3)}, 2e-3});
    shapes.push_back({"Pillow", {superellipsoid, 1.0, 0.5}, {rounded(1.0, 0.5)}, 1e-3});
    shapes.push_back({"Star", {superellipsoid, 1.6, 1.8}, {rounded(1.6, 1.8)}, 1e-3});
    for (const double sigma : {0.35, 0.1}) {
        shapes.push_back({"Gaussian" + std::to_string(static_cast<int>(100 * sigma)),
                          {gaussian, sigma},
                          {graph_of([=](double x, double y) {
                              return std::exp(-0.5 * (x * x + y * y) / (sigma * sigma));
                          })},
                          1e-3});
    }
    shapes.push_back({"Waves",
                      {waves, 2.0, 1.5},
                      {graph_of([](double x, double y) {
                          return std::cos(2 * pi * x) * std::cos(1.5 * pi * y);
                      })},
                      1e-3});
    return shapes;
}

Object tessellated(const ParametricShape& shape) {
    std::vector<Vec3f> vertices;
    std::vector<Mesh::Triangle> triangles;
    for (const Patch& patch : shape.patches) {
        const auto first = static_cast<std::uint32_t>(vertices.size());
        for (std::uint32_t j = 0; j <= kRows; ++j) {
            for (std::uint32_t i = 0; i <= kColumns; ++i) {
                vertices.push_back(to_float(
                    patch(static_cast<double>(i) / kColumns, static_cast<double>(j) / kRows)));
            }
        }
        for (std::uint32_t j = 0; j < kRows; ++j) {
            for (std::uint32_t i = 0; i < kColumns; ++i) {
                const std::uint32_t a = first + j * (kColumns + 1) + i;
                const std::uint32_t b = a + kColumns + 1;
                triangles.push_back({a, a + 1, b + 1});
                triangles.push_back({a, b + 1, b});
            }
        }
    }
    return mesh_object(std::move(vertices), std::move(triangles));
}

/// First hits with a scene, as distances in the world.
std::vector<std::optional<double>> trace(const Scene& scene, const std::vector<ShapeRay>& rays) {
    std::vector<RayPacket> packets((rays.size() + kLanes - 1) / kLanes);
    for (std::size_t k = 0; k < rays.size(); ++k) {
        RayPacket& packet = packets[k / kLanes];
        const auto lane = static_cast<int>(k % kLanes);
        const Vec3f origin = scene.frame().from_world(rays[k].origin);
        packet.active[lane] = -1;
        packet.origin_x[lane] = origin.x;
        packet.origin_y[lane] = origin.y;
        packet.origin_z[lane] = origin.z;
        packet.dir_x[lane] = static_cast<float>(rays[k].dir.x);
        packet.dir_y[lane] = static_cast<float>(rays[k].dir.y);
        packet.dir_z[lane] = static_cast<float>(rays[k].dir.z);
    }
    std::vector<HitPacket> hits(packets.size());
    make_embree_tracer(scene)->intersect(packets, hits, Coherence::incoherent);
    std::vector<std::optional<double>> distances;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        const HitPacket& packet = hits[k / kLanes];
        const auto lane = static_cast<int>(k % kLanes);
        distances.push_back(
            packet.object[lane] == 0
                ? std::optional(static_cast<double>(packet.t[lane]) * scene.frame().unit)
                : std::nullopt);
    }
    return distances;
}

class Tessellation : public testing::TestWithParam<ParametricShape> {
  protected:
    struct Place {
        Vec3d point, normal;
    };
    /// A point of the surface and its normal, by central differences.
    Place random_place(std::mt19937& random) const {
        const auto& patches = GetParam().patches;
        const Patch& patch = patches[random() % patches.size()];
        for (;;) {
            const double u = 0.02 + 0.96 * uniform(random);
            const double v = 0.02 + 0.96 * uniform(random);
            constexpr double e = 1e-5;
            const Vec3d n =
                cross(patch(u + e, v) - patch(u - e, v), patch(u, v + e) - patch(u, v - e));
            if (length(n) > 1e-14) return {patch(u, v), normalize(n)};
        }
    }
};

INSTANTIATE_TEST_SUITE_P(Of, Tessellation, testing::ValuesIn(parametric_shapes()),
                         [](const auto& shape) { return shape.param.name; });

/// Rays along tangents, a little above and below the surface: those below, where it is round, meet
/// it at angles down to a hundredth of a radian.
TEST_P(Tessellation, IsHitWhereTheExactShapeIsAlsoAtGrazingAnglesAndFromFarAway) {
    const PlacedShape shape(GetParam().shape, {});
    std::mt19937 random(31);
    std::vector<ShapeRay> rays;
    for (int i = 0; i < 6000; ++i) {
        const auto [point, normal] = random_place(random);
        const Vec3d any = to_double(uniform_point(random)) - Vec3d{0.5, 0.5, 0.5};
        const Vec3d aside = normalize(any - normal * dot(any, normal));
        // From a few times the facets' distance to a tenth.
        const double least = 3.0 * GetParam().error;
        const double off = least * std::pow(0.1 / least, uniform(random));
        const double slope = i % 4 == 0 ? static_cast<double>(uniform(random)) : 0.0;
        const Vec3d dir = normalize(aside - normal * slope);
        rays.push_back({point + normal * (i % 2 == 0 ? off : -off) - dir * 3.0, dir});
    }
    const auto expected = trace(Scene({tessellated(GetParam())}), rays);
    int seen = 0;
    int grazing = 0;
    int different = 0;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        const auto hit = shape.intersect(rays[k], 0.0, 1e9);
        const ShapeRay from_far{rays[k].origin - rays[k].dir * 1e4, rays[k].dir};
        const auto far = shape.intersect(from_far, 0.0, 1e9);
        ASSERT_EQ(hit.has_value(), far.has_value()) << k;
        if (hit) {
            EXPECT_NEAR(far->t - 1e4, hit->t, 1e-6) << k;
        }
        const double along =
            hit ? std::abs(dot(hit->normal, rays[k].dir)) / length(hit->normal) : 0.0;
        if (!hit && !expected[k]) continue;
        // A ray meets facets before or behind the surface by their distance over the angle's sine.
        const double slack = 2e-5 + 2.0 * GetParam().error / std::max(along, 1e-3);
        if (!hit || !expected[k] || std::abs(*expected[k] - hit->t) > slack) {
            ++different;
            continue;
        }
        ++seen;
        grazing += along < 0.1 ? 1 : 0;
    }
    // Beside a rim or another outline, facets may be met or missed.
    EXPECT_LT(different, 6);
    EXPECT_GT(seen, 500);
    RecordProperty("different", different);
    RecordProperty("grazing", grazing);
}

TEST_P(Tessellation, HasTheNormalsOfTheExactShape) {
    const PlacedShape shape(GetParam().shape, {});
    std::mt19937 random(32);
    int seen = 0;
    for (int i = 0; i < 1000; ++i) {
        const auto [point, normal] = random_place(random);
        for (const double side : {1.0, -1.0}) {
            // From close by, so that nothing else is in the way.
            const ShapeRay ray{point + normal * (side * 1e-4), normal * -side};
            const auto hit = shape.intersect(ray, 0.0, 2e-4);
            ASSERT_TRUE(hit.has_value()) << i;
            EXPECT_NEAR(hit->t, 1e-4, 1e-6);
            const Vec3d n = normalize(hit->normal);
            EXPECT_LT(length(n - normal * (dot(n, normal) > 0 ? 1.0 : -1.0)), 5e-3) << i;
            ++seen;
        }
    }
    EXPECT_EQ(seen, 2000);
}

}  // namespace
}  // namespace ink::test
