// Exact shapes against fine tessellations of their parametric forms: near, at grazing angles and
// from far away; their normals and curvatures against differences of these forms.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "accel/shape_intersection.h"
#include "accel/tracer.h"
#include "curvatures.h"
#include "scenes.h"
#include "set_ray.h"

namespace ink::test {
namespace {

using std::numbers::pi;

/// A part of a surface over [0, 1]^2.
using Patch = std::function<Vec3d(double u, double v)>;

/// The exact shape: its first crossing with a ray in an interval.
using Intersect = std::function<std::optional<ShapeHit>(const ShapeRay&, double, double)>;

Intersect exactly(const UnitShape& shape) {
    return [placed = PlacedShape(shape, {})](const ShapeRay& ray, double t_near, double t_far) {
        return placed.intersect(ray, t_near, t_far);
    };
}

struct ParametricShape {
    std::string name;
    Intersect exact;
    std::vector<Patch> patches;
    double error = 0.0;      ///< distance of the tessellation from the shape, at most
    double rounding = 1e-6;  ///< of distances to the shape

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
    return {name, exactly({GlyphKind::frustum, above, 1.0, capped}), patches, 1e-4};
}

/// The four corners of a planar face, blended.
Patch face_of(const std::array<Vec3d, 4>& corners) {
    return [corners](double u, double v) {
        return (corners[0] * (1 - u) + corners[1] * u) * (1 - v) +
               (corners[3] * (1 - u) + corners[2] * u) * v;
    };
}

ParametricShape hexahedron_of(const std::string& name, const Hexahedra::Corners& corners) {
    std::vector<Patch> patches;
    for (const auto& face : Hexahedra::kFaces) {
        std::array<Vec3d, 4> points;
        for (std::size_t k = 0; k < 4; ++k) points[k] = to_double(corners[face[k]]);
        patches.push_back(face_of(points));
    }
    const auto exact = [corners](const ShapeRay& ray, double t_near, double t_far) {
        return intersect(corners, ray, t_near, t_far);
    };
    return {name, exact, patches, 1e-6};
}

constexpr Hexahedra::Corners kCube{{{-1, -1, -1},
                                    {1, -1, -1},
                                    {1, 1, -1},
                                    {-1, 1, -1},
                                    {-1, -1, 1},
                                    {1, -1, 1},
                                    {1, 1, 1},
                                    {-1, 1, 1}}};

/// A cube under an affine map, as glyphs are deformed.
Hexahedra::Corners sheared() {
    Hexahedra::Corners corners = kCube;
    for (Vec3f& p : corners) {
        p = Vec3f{0.9F, 0.1F, 0.0F} * p.x + Vec3f{0.3F, 0.7F, 0.1F} * p.y +
            Vec3f{-0.2F, 0.1F, 0.8F} * p.z;
    }
    return corners;
}

/// Faces stay planar where a cube tapers.
Hexahedra::Corners tapered() {
    Hexahedra::Corners corners = kCube;
    for (Vec3f& p : corners) {
        if (p.z > 0) p = {0.5F * p.x + 0.1F, 0.5F * p.y - 0.2F, p.z};
    }
    return corners;
}

/// Rays through the tracer of scenes, one by one; it works in floats, so a ray starts near by.
Intersect a_sphere_of_a_scene() {
    struct Traced {
        Scene scene{{sphere_object({{{0, 0, 0}, 1.0F}})}};
        std::unique_ptr<Tracer> tracer = make_embree_tracer(scene);
    };
    return [traced = std::make_shared<Traced>()](const ShapeRay& ray, double t_near,
                                                 double t_far) -> std::optional<ShapeHit> {
        const Frame& frame = traced->scene.frame();
        const double start = std::max(t_near, -dot(ray.origin, ray.dir) - 4.0);
        const Vec3f origin = frame.from_world(ray.origin + ray.dir * start);
        std::array<RayPacket, 1> rays;
        rays[0].origin_x.fill(origin.x);
        rays[0].origin_y.fill(origin.y);
        rays[0].origin_z.fill(origin.z);
        rays[0].dir_x.fill(static_cast<float>(ray.dir.x));
        rays[0].dir_y.fill(static_cast<float>(ray.dir.y));
        rays[0].dir_z.fill(static_cast<float>(ray.dir.z));
        std::array<HitPacket, 1> hits;
        traced->tracer->intersect(rays, hits, Coherence::incoherent);
        const double t = start + static_cast<double>(hits[0].t[0]) * frame.unit;
        if (hits[0].object[0] == kNoObject || t >= t_far) return std::nullopt;
        return ShapeHit{t,
                        to_double({hits[0].normal_x[0], hits[0].normal_y[0], hits[0].normal_z[0]})};
    };
}

std::vector<ParametricShape> parametric_shapes() {
    using enum GlyphKind;
    std::vector<ParametricShape> shapes;
    shapes.push_back({"Sphere", a_sphere_of_a_scene(), {rounded(1, 1)}, 2e-4, 1e-5});
    shapes.push_back({"Ellipsoid", exactly({ellipsoid}), {rounded(1, 1)}, 2e-4});
    shapes.push_back(hexahedron_of("Cube", kCube));
    shapes.push_back(hexahedron_of("ShearedHexahedron", sheared()));
    shapes.push_back(hexahedron_of("TaperedHexahedron", tapered()));
    shapes.push_back({"Box", exactly({box}), shapes[2].patches, 1e-6});
    shapes.push_back(frustum_of("Cylinder", 1.0, true));
    shapes.push_back(frustum_of("Tube", 1.0, false));
    shapes.push_back(frustum_of("Cone", 0.0, true));
    shapes.push_back(frustum_of("Frustum", 0.4, true));
    shapes.push_back({"Disc", exactly({disc}), {disc_at(0, 1)}, 1e-4});
    shapes.push_back({"Rectangle", exactly({rectangle}), {flat}, 1e-6});
    for (const double a : {0.05, 0.4, 0.95}) {
        shapes.push_back({"Torus" + std::to_string(static_cast<int>(100 * a)),
                          exactly({torus, a}),
                          {[=](double u, double v) {
                              const double ring = 1 + a * std::cos(2 * pi * v);
                              return Vec3d{ring * std::cos(2 * pi * u), ring * std::sin(2 * pi * u),
                                           a * std::sin(2 * pi * v)};
                          }},
                          2e-4});
    }
    shapes.push_back(
        {"RoundedCube", exactly({superellipsoid, 0.3, 0.3}), {rounded(0.3, 0.3)}, 2e-3});
    shapes.push_back({"Pillow", exactly({superellipsoid, 1.0, 0.5}), {rounded(1.0, 0.5)}, 1e-3});
    shapes.push_back({"Star", exactly({superellipsoid, 1.6, 1.8}), {rounded(1.6, 1.8)}, 1e-3});
    for (const double sigma : {0.35, 0.1}) {
        shapes.push_back({"Gaussian" + std::to_string(static_cast<int>(100 * sigma)),
                          exactly({gaussian, sigma}),
                          {graph_of([=](double x, double y) {
                              return std::exp(-0.5 * (x * x + y * y) / (sigma * sigma));
                          })},
                          1e-3});
    }
    shapes.push_back({"Waves",
                      exactly({waves, 2.0, 1.5}),
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
        set_ray(packet, lane, origin, to_float(rays[k].dir));
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
    struct Coordinates {
        const Patch* patch;
        double u, v;
    };
    Coordinates random_coordinates(std::mt19937& random) const {
        const auto& patches = GetParam().patches;
        const Patch& patch = patches[random() % patches.size()];
        const double u = 0.02 + 0.96 * uniform(random);
        const double v = 0.02 + 0.96 * uniform(random);
        return {&patch, u, v};
    }
    /// A point of the surface and its normal, by central differences.
    Place random_place(std::mt19937& random) const {
        for (;;) {
            const auto [patch, u, v] = random_coordinates(random);
            constexpr double e = 1e-5;
            const Vec3d n = cross((*patch)(u + e, v) - (*patch)(u - e, v),
                                  (*patch)(u, v + e) - (*patch)(u, v - e));
            if (length(n) > 1e-14) return {(*patch)(u, v), normalize(n)};
        }
    }
};

INSTANTIATE_TEST_SUITE_P(Of, Tessellation, testing::ValuesIn(parametric_shapes()),
                         [](const auto& shape) { return shape.param.name; });

/// Rays along tangents, a little above and below the surface: those below, where it is round, meet
/// it at angles down to a hundredth of a radian.
TEST_P(Tessellation, IsHitWhereTheExactShapeIsAlsoAtGrazingAnglesAndFromFarAway) {
    const Intersect& exact = GetParam().exact;
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
        const auto hit = exact(rays[k], 0.0, 1e9);
        const ShapeRay from_far{rays[k].origin - rays[k].dir * 1e4, rays[k].dir};
        const auto far = exact(from_far, 0.0, 1e9);
        ASSERT_EQ(hit.has_value(), far.has_value()) << k;
        if (hit) {
            EXPECT_NEAR(far->t - 1e4, hit->t, GetParam().rounding) << k;
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
    const Intersect& exact = GetParam().exact;
    std::mt19937 random(32);
    int seen = 0;
    for (int i = 0; i < 1000; ++i) {
        const auto [point, normal] = random_place(random);
        for (const double side : {1.0, -1.0}) {
            // From close by, so that nothing else is in the way.
            const ShapeRay ray{point + normal * (side * 1e-4), normal * -side};
            const auto hit = exact(ray, 0.0, 2e-4);
            ASSERT_TRUE(hit.has_value()) << i;
            EXPECT_NEAR(hit->t, 1e-4, 1e-6);
            const Vec3d n = normalize(hit->normal);
            EXPECT_LT(length(n - normal * (dot(n, normal) > 0 ? 1.0 : -1.0)), 5e-3) << i;
            ++seen;
        }
    }
    EXPECT_EQ(seen, 2000);
}

/// By differences of the points of a parametric form, with the normal on the side of `outward`.
Curvatures parametric_curvatures(const Patch& patch, double u, double v, double e, Vec3d outward) {
    const auto normal = [&](double s, double t) {
        const Vec3d n =
            normalize(cross(patch(s + e, t) - patch(s - e, t), patch(s, t + e) - patch(s, t - e)));
        return dot(n, outward) > 0.0 ? n : -n;
    };
    return curvatures(patch(u + e, v) - patch(u - e, v), patch(u, v + e) - patch(u, v - e),
                      normal(u + e, v) - normal(u - e, v), normal(u, v + e) - normal(u, v - e));
}

/// By differences of what four rays about a point see.
std::optional<Curvatures> traced_curvatures(const Intersect& exact, Vec3d point, Vec3d normal,
                                            double step) {
    const Vec3d any = std::abs(normal.x) < 0.8 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d a = normalize(cross(normal, any));
    const Vec3d b = cross(normal, a);
    std::array<Vec3d, 4> points;
    std::array<Vec3d, 4> normals;
    constexpr double kAbove = 2e-3;
    for (std::size_t k = 0; k < 4; ++k) {
        const Vec3d aside = (k < 2 ? a : b) * (k % 2 == 0 ? step : -step);
        const ShapeRay ray{point + aside + normal * kAbove, -normal};
        const auto hit = exact(ray, 0.0, 2.0 * kAbove);
        if (!hit) return std::nullopt;
        points[k] = ray.origin + ray.dir * hit->t;
        normals[k] = normalize(hit->normal);
        if (dot(normals[k], normal) < 0.0) normals[k] = -normals[k];
    }
    return curvatures(points[0] - points[1], points[2] - points[3], normals[0] - normals[1],
                      normals[2] - normals[3]);
}

TEST_P(Tessellation, HasTheCurvaturesOfTheExactShape) {
    std::mt19937 random(33);
    int compared = 0;
    for (int i = 0; i < 1000; ++i) {
        const auto [patch, u, v] = random_coordinates(random);
        constexpr double e = 1e-3;
        const Vec3d n =
            cross((*patch)(u + e, v) - (*patch)(u - e, v), (*patch)(u, v + e) - (*patch)(u, v - e));
        if (length(n) < 1e-10) continue;
        const Vec3d normal = normalize(n);
        const Curvatures known = parametric_curvatures(*patch, u, v, 0.5 * e, normal);
        const double scale = 1.0 + std::max(std::abs(known.least), std::abs(known.most));
        const auto alike = [&](const Curvatures& other, const Curvatures& one) {
            return std::max(std::abs(other.least - one.least), std::abs(other.most - one.most)) <
                   2e-3 * scale;
        };
        const Vec3d point = (*patch)(u, v);
        const auto traced = traced_curvatures(GetParam().exact, point, normal, 1e-3);
        const auto wider = traced_curvatures(GetParam().exact, point, normal, 2e-3);
        // Near sharp edges and poles, differences depend on their steps.
        if (!traced || !wider || !alike(*wider, *traced) ||
            !alike(parametric_curvatures(*patch, u, v, e, normal), known)) {
            continue;
        }
        ++compared;
        EXPECT_NEAR(traced->least, known.least, 0.01 * scale) << u << ", " << v;
        EXPECT_NEAR(traced->most, known.most, 0.01 * scale) << u << ", " << v;
    }
    EXPECT_GT(compared, 500);
    RecordProperty("compared", compared);
}

/// Against triangles in double precision, also for rays that only Embree traces.
TEST(Hexahedra, AreHitWhereBruteForceHitsTheirTriangles) {
    std::mt19937 random(34);
    for (const Hexahedra::Corners& corners : {kCube, sheared(), tapered()}) {
        Object solid;
        solid.kind = ObjectKind::shape;
        solid.shape = Hexahedra{{corners}, {}, {}};
        const Scene exact({solid});
        std::vector<Mesh::Triangle> triangles;
        for (const auto& [a, b, c, d] : Hexahedra::kFaces) {
            triangles.push_back({a, b, c});
            triangles.push_back({a, c, d});
        }
        const Scene mesh({mesh_object({corners.begin(), corners.end()}, std::move(triangles))});
        std::vector<RayPacket> rays(100);
        for (RayPacket& packet : rays) {
            for (int i = 0; i < kLanes; ++i) {
                const Vec3f origin =
                    normalize(uniform_point(random) - Vec3f{0.5F, 0.5F, 0.5F}) * 3.0F;
                const Vec3f aim = (uniform_point(random) - Vec3f{0.5F, 0.5F, 0.5F}) * 1.2F;
                const Vec3f dir = normalize(aim - origin);
                set_ray(packet, i, origin, dir);
            }
        }
        ASSERT_EQ(exact.frame().unit, mesh.frame().unit);
        std::vector<HitPacket> expected(rays.size());
        make_brute_force_tracer(mesh)->intersect(rays, expected, Coherence::incoherent);
        for (const PacketWidth width :
             {PacketWidth::four, PacketWidth::eight, PacketWidth::sixteen}) {
            std::vector<HitPacket> hits(rays.size());
            make_embree_tracer(exact, width)->intersect(rays, hits, Coherence::incoherent);
            int seen = 0;
            for (std::size_t k = 0; k < rays.size(); ++k) {
                for (int i = 0; i < kLanes; ++i) {
                    ASSERT_EQ(hits[k].object[i], expected[k].object[i]) << k << ", " << i;
                    if (hits[k].object[i] == kNoObject) continue;
                    ++seen;
                    EXPECT_NEAR(hits[k].t[i], expected[k].t[i], 1e-5F);
                    const Vec3f n = normalize(
                        Vec3f{hits[k].normal_x[i], hits[k].normal_y[i], hits[k].normal_z[i]});
                    const Vec3f m = normalize(Vec3f{
                        expected[k].normal_x[i], expected[k].normal_y[i], expected[k].normal_z[i]});
                    EXPECT_LT(length(n - m), 1e-4F);
                }
            }
            EXPECT_GT(seen, 300);
        }
    }
}

}  // namespace
}  // namespace ink::test
