#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "accel/polynomial.h"
#include "accel/shape_intersection.h"
#include "accel/tracer.h"
#include "scenes.h"
#include "set_ray.h"

namespace ink::test {
namespace {

using std::numbers::pi;

struct NamedShape {
    std::string name;
    UnitShape shape;
};

/// Every kind, with the parameters that are hardest on it.
std::vector<NamedShape> all_shapes() {
    using enum GlyphKind;
    return {{"Ellipsoid", {ellipsoid}},
            {"Box", {box}},
            {"Cylinder", {frustum, 1.0}},
            {"Tube", {frustum, 1.0, 1.0, false}},
            {"Cone", {frustum, 0.0}},
            {"OpenCone", {frustum, 0.3, 1.0, false}},
            {"Frustum", {frustum, 0.4}},
            {"Disc", {disc}},
            {"Rectangle", {rectangle}},
            {"Torus", {torus, 0.4}},
            {"ThinTorus", {torus, 0.05}},
            {"FatTorus", {torus, 0.95}},
            {"RoundedCube", {superellipsoid, 0.3, 0.3}},
            {"SharpCube", {superellipsoid, 0.04, 0.04}},
            {"Pillow", {superellipsoid, 1.0, 0.2}},
            {"Octahedron", {superellipsoid, 2.0, 2.0}},
            {"Gaussian", {gaussian, 0.35}},
            {"Needle", {gaussian, 0.05}},
            {"Waves", {waves, 2.0, 1.5}},
            {"Ripples", {waves, 7.0, 0.0}}};
}

Placement random_placement(std::mt19937& random) {
    const auto vector = [&] { return uniform_point(random) - Vec3f{0.5F, 0.5F, 0.5F}; };
    Placement place;
    do {
        place = {vector(), vector(), vector(), vector() * 0.3F};
    } while (std::abs(dot(place.x_axis, cross(place.y_axis, place.z_axis))) < 0.02F);
    return place;
}

Object glyph_object(const UnitShape& shape, std::vector<Placement> placements) {
    Object object;
    object.kind = ObjectKind::shape;
    object.shape = Glyphs{shape, std::move(placements), {}, {}};
    return object;
}

/// Rays from outside towards points in and about [-1, 1]^3, from near and far.
ShapeRay random_ray(std::mt19937& random) {
    const auto vector = [&] {
        return to_double(uniform_point(random)) * 2.0 - Vec3d{1.0, 1.0, 1.0};
    };
    const double distance = 2.0 + 50.0 * uniform(random);
    Vec3d from = vector();
    while (length(from) < 0.1) from = vector();
    from = normalize(from) * distance;
    return {from, normalize(vector() - from)};
}

bool is_closed(const UnitShape& shape) {
    using enum GlyphKind;
    switch (shape.kind) {
        case disc:
        case rectangle:
        case gaussian:
        case waves: return false;
        default: return shape.capped;
    }
}

std::vector<NamedShape> closed_shapes() {
    std::vector<NamedShape> shapes = all_shapes();
    std::erase_if(shapes, [](const NamedShape& named) { return !is_closed(named.shape); });
    return shapes;
}

class EveryClosedShape : public testing::TestWithParam<NamedShape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, EveryClosedShape, testing::ValuesIn(closed_shapes()),
                         [](const auto& shape) { return shape.param.name; });

class EveryShape : public testing::TestWithParam<NamedShape> {};

INSTANTIATE_TEST_SUITE_P(Shapes, EveryShape, testing::ValuesIn(all_shapes()),
                         [](const auto& shape) { return shape.param.name; });

TEST_P(EveryShape, IsHitWhereBruteForceHitsIt) {
    std::mt19937 random(5);
    std::vector<Placement> placements;
    for (int i = 0; i < 3; ++i) placements.push_back(random_placement(random));
    const Scene scene({glyph_object(GetParam().shape, placements)});
    std::vector<RayPacket> rays(30);
    for (RayPacket& packet : rays) {
        packet.active.fill(-1);
        for (int i = 0; i < kLanes; ++i) {
            const ShapeRay ray = random_ray(random);
            const Vec3f origin = to_float(normalize(ray.origin) * 3.0);
            const Vec3f aim = (uniform_point(random) - Vec3f{0.5F, 0.5F, 0.5F}) * 1.2F;
            const Vec3f dir = normalize(aim - origin);
            set_ray(packet, i, origin, dir);
        }
    }
    std::vector<HitPacket> expected(rays.size());
    make_brute_force_tracer(scene)->intersect(rays, expected, Coherence::incoherent);
    for (const PacketWidth width : {PacketWidth::four, PacketWidth::eight, PacketWidth::sixteen}) {
        std::vector<HitPacket> hits(rays.size());
        make_embree_tracer(scene, width)->intersect(rays, hits, Coherence::incoherent);
        int seen = 0;
        int different = 0;
        for (std::size_t k = 0; k < rays.size(); ++k) {
            for (int i = 0; i < kLanes; ++i) {
                const HitPacket& a = expected[k];
                const HitPacket& b = hits[k];
                if (a.object[i] != b.object[i] || std::abs(a.t[i] - b.t[i]) > 1e-5F ||
                    (a.object[i] == 0 && a.primitive[i] != b.primitive[i])) {
                    // The oracle steps over a sliver that is thinner than its steps.
                    ++different;
                    continue;
                }
                if (a.object[i] == kNoObject) continue;
                ++seen;
                const Vec3f n = normalize(Vec3f{a.normal_x[i], a.normal_y[i], a.normal_z[i]});
                const Vec3f m = normalize(Vec3f{b.normal_x[i], b.normal_y[i], b.normal_z[i]});
                EXPECT_LT(length(n - m), 2e-3F) << "packet " << k << " lane " << i;
            }
        }
        EXPECT_GT(seen, 15);
        EXPECT_LE(different, 4);
    }
}

TEST_P(EveryShape, LiesWithinItsBoundsAndTouchesThem) {
    // Height fields promise the box of their whole range.
    const GlyphKind kind = GetParam().shape.kind;
    const bool loose = kind == GlyphKind::gaussian || kind == GlyphKind::waves;
    std::mt19937 random(8);
    const Placement place = random_placement(random);
    const PlacedShape shape(GetParam().shape, place);
    const Bounds3f bounds = glyph_bounds(GetParam().shape, place);
    Bounds3d found;
    for (int i = 0; i < 40000; ++i) {
        const ShapeRay ray = random_ray(random);
        if (const auto hit = shape.intersect(ray, 0.0, 1e9))
            found.add(ray.origin + ray.dir * hit->t);
    }
    const std::array<double, 6> inside{
        found.lower.x - bounds.lower.x, found.lower.y - bounds.lower.y,
        found.lower.z - bounds.lower.z, bounds.upper.x - found.upper.x,
        bounds.upper.y - found.upper.y, bounds.upper.z - found.upper.z};
    for (const double gap : inside) {
        EXPECT_GE(gap, -1e-7);
        if (!loose) {
            EXPECT_LT(gap, 0.1);
        }
    }
}

TEST_P(EveryShape, IsSeenTheSameFromAThousandTimesAsFar) {
    std::mt19937 random(9);
    const PlacedShape shape(GetParam().shape, random_placement(random));
    int seen = 0;
    for (int i = 0; i < 2000; ++i) {
        const ShapeRay ray = random_ray(random);
        const auto near = shape.intersect(ray, 0.0, 1e9);
        const ShapeRay back{ray.origin - ray.dir * 1000.0, ray.dir};
        const auto far = shape.intersect(back, 0.0, 1e9);
        if (near.has_value() != far.has_value()) {
            // Within rounding of an outline: nudged by a nanometre, both agree.
            const ShapeRay nudged{ray.origin + Vec3d{1e-8, -1e-8, 1e-8}, ray.dir};
            const ShapeRay other{ray.origin - Vec3d{1e-8, -1e-8, 1e-8}, ray.dir};
            EXPECT_NE(shape.intersect(nudged, 0.0, 1e9).has_value(),
                      shape.intersect(other, 0.0, 1e9).has_value());
            continue;
        }
        if (!near) continue;
        ++seen;
        EXPECT_NEAR(far->t - 1000.0, near->t, 1e-6);
    }
    EXPECT_GT(seen, 20);
}

/// A closed shape must be entered before it is left: a ray that starts inside and one that comes
/// from outside cross it an odd and an even number of times.
TEST_P(EveryClosedShape, HasNoHoles) {
    const UnitShape& unit = GetParam().shape;
    std::mt19937 random(10);
    const PlacedShape shape(unit, random_placement(random));
    for (int i = 0; i < 5000; ++i) {
        const ShapeRay ray = random_ray(random);
        int crossings = 0;
        double from = 0.0;
        while (const auto hit = shape.intersect(ray, from, 1e9)) {
            const double along = dot(hit->normal, ray.dir) / length(hit->normal);
            if (std::abs(along) > 1e-4) {
                EXPECT_EQ(along < 0.0, crossings % 2 == 0) << "ray " << i;
            }
            ++crossings;
            from = hit->t + 1e-9;
            ASSERT_LE(crossings, 4);
        }
        EXPECT_EQ(crossings % 2, 0) << "ray " << i;
    }
}

/// Along a ray that grazes, normals are at a right angle to it: the outline is found to the last
/// digit, with no speckles beyond it.
TEST_P(EveryShape, IsHitUpToItsOutlineAndNotBeyond) {
    std::mt19937 random(12);
    const PlacedShape shape(GetParam().shape, random_placement(random));
    int outlines = 0;
    for (int i = 0; i < 400; ++i) {
        // Between a ray that hits and one that misses, halving finds one last hit; on the way out
        // from it there must be none.
        const ShapeRay inside = random_ray(random);
        if (!shape.intersect(inside, 0.0, 1e9)) continue;
        Vec3d side = cross(inside.dir, Vec3d{0.3, -0.8, 0.5});
        side = normalize(side);
        double hit = 0.0;
        double miss = 3.0;
        const auto sees = [&](double offset) {
            return shape.intersect({inside.origin + side * offset, inside.dir}, 0.0, 1e9)
                .has_value();
        };
        if (sees(miss)) continue;
        for (int step = 0; step < 60; ++step) {
            const double middle = 0.5 * (hit + miss);
            (sees(middle) ? hit : miss) = middle;
        }
        ++outlines;
        // Fifty rays to either side of the outline: all hit, and all miss.
        for (int k = 1; k <= 50; ++k) {
            const double step = 1e-11 * std::pow(1.3, k);
            EXPECT_TRUE(sees(hit - step)) << "ray " << i << " step " << step;
            EXPECT_FALSE(sees(miss + step)) << "ray " << i << " step " << step;
        }
    }
    EXPECT_GT(outlines, 5);
}

// ---- Against a fine tessellation.

/// The torus in `rings` x `sides` quadrilaterals.
Object tessellated_torus(double a, std::uint32_t rings, std::uint32_t sides) {
    std::vector<Vec3f> vertices;
    std::vector<Mesh::Triangle> triangles;
    for (std::uint32_t i = 0; i < rings; ++i) {
        const double u = 2 * pi * i / rings;
        for (std::uint32_t j = 0; j < sides; ++j) {
            const double v = 2 * pi * j / sides;
            const double rho = 1 + a * std::cos(v);
            vertices.push_back(
                to_float(Vec3d{rho * std::cos(u), rho * std::sin(u), a * std::sin(v)}));
            const std::uint32_t i1 = (i + 1) % rings;
            const std::uint32_t j1 = (j + 1) % sides;
            triangles.push_back({i * sides + j, i1 * sides + j, i1 * sides + j1});
            triangles.push_back({i * sides + j, i1 * sides + j1, i * sides + j1});
        }
    }
    return mesh_object(std::move(vertices), std::move(triangles));
}

TEST(Shapes, ATorusIsTheLimitOfItsTessellation) {
    const double a = 0.3;
    const Scene mesh({tessellated_torus(a, 512, 256)});
    const auto tracer = make_embree_tracer(mesh);
    const PlacedShape torus({GlyphKind::torus, a}, {});
    std::mt19937 random(21);
    std::vector<RayPacket> rays(200);
    std::vector<ShapeRay> exact;
    for (RayPacket& packet : rays) {
        packet.active.fill(-1);
        for (int i = 0; i < kLanes; ++i) {
            const ShapeRay ray = random_ray(random);
            exact.push_back(ray);
            const Vec3f origin = mesh.frame().from_world(ray.origin);
            set_ray(packet, i, origin, to_float(ray.dir));
        }
    }
    std::vector<HitPacket> hits(rays.size());
    tracer->intersect(rays, hits, Coherence::incoherent);
    int seen = 0;
    int different = 0;
    for (std::size_t k = 0; k < exact.size(); ++k) {
        const auto hit = torus.intersect(exact[k], 0.0, 1e9);
        const HitPacket& packet = hits[k / kLanes];
        const int lane = static_cast<int>(k % kLanes);
        if (hit.has_value() != (packet.object[lane] == 0)) {
            ++different;
            continue;
        }
        if (!hit) continue;
        ++seen;
        const double along = std::abs(dot(hit->normal, exact[k].dir)) / length(hit->normal);
        if (along < 0.1) continue;
        // A chord lies a (1 - cos(pi / n)) below its arc.
        EXPECT_NEAR(hit->t, packet.t[lane] * mesh.frame().unit, 2e-4 / along + 2e-5);
    }
    EXPECT_GT(seen, 300);
    EXPECT_LT(different, 10);
}

// ---- Closed forms of single shapes.

TEST(Shapes, ASphereOfAffineAxesIsTheSphere) {
    const Sphere ball{{0.1F, -0.2F, 0.3F}, 0.4F};
    const Placement place{{0.4F, 0, 0}, {0, 0.4F, 0}, {0, 0, 0.4F}, ball.centre};
    const Scene round({sphere_object({ball})});
    std::mt19937 random(3);
    const PlacedShape shape({GlyphKind::ellipsoid}, place);
    for (int i = 0; i < 1000; ++i) {
        const ShapeRay ray = random_ray(random);
        const Vec3d to_centre = to_double(ball.centre) - ray.origin;
        const double closest = dot(to_centre, ray.dir);
        const Vec3d off = to_centre - ray.dir * closest;
        const double rest = static_cast<double>(ball.radius) * ball.radius - dot(off, off);
        const auto hit = shape.intersect(ray, 0.0, 1e9);
        ASSERT_EQ(hit.has_value(), rest > 0.0);
        if (hit) {
            EXPECT_NEAR(hit->t, closest - std::sqrt(rest), 1e-9);
        }
    }
}

TEST(Shapes, ADeformedHexahedronIsItsBoxDeformed) {
    const Placement place{{0.5F, 0.1F, 0}, {0.2F, 0.4F, 0.1F}, {-0.1F, 0, 0.6F}, {0.1F, 0, 0}};
    const PlacedShape box({GlyphKind::box}, place);
    Hexahedra::Corners corners;
    constexpr std::array<Vec3d, 8> kVtkOrder{{{-1, -1, -1},
                                              {1, -1, -1},
                                              {1, 1, -1},
                                              {-1, 1, -1},
                                              {-1, -1, 1},
                                              {1, -1, 1},
                                              {1, 1, 1},
                                              {-1, 1, 1}}};
    for (std::size_t k = 0; k < 8; ++k) corners[k] = to_float(place.point(kVtkOrder[k]));
    std::mt19937 random(4);
    int seen = 0;
    for (int i = 0; i < 3000; ++i) {
        const ShapeRay ray = random_ray(random);
        const auto a = box.intersect(ray, 0.0, 1e9);
        const auto b = intersect(corners, ray, 0.0, 1e9);
        if (a.has_value() != b.has_value()) continue;  // corners are rounded to floats
        if (!a) continue;
        ++seen;
        EXPECT_NEAR(a->t, b->t, 1e-5);
        EXPECT_LT(length(normalize(a->normal) - normalize(b->normal)), 1e-5);
    }
    EXPECT_GT(seen, 200);
}

TEST(Shapes, AHexahedronHasNoCrackAlongItsEdges) {
    const Hexahedra::Corners corners{{{-1, -1, -1},
                                      {1, -1, -1},
                                      {1, 1, -1},
                                      {-1, 1, -1},
                                      {-0.7F, -0.6F, 1},
                                      {0.8F, -0.6F, 1},
                                      {0.8F, 0.5F, 1},
                                      {-0.7F, 0.5F, 1}}};
    std::mt19937 random(6);
    for (int i = 0; i < 20000; ++i) {
        const auto a = static_cast<std::size_t>(random() % 8);
        const auto b = static_cast<std::size_t>(random() % 8);
        const double s = uniform(random);
        const Vec3d target = to_double(corners[a]) * s + to_double(corners[b]) * (1.0 - s);
        const Vec3d origin =
            normalize(to_double(uniform_point(random)) - Vec3d{0.5, 0.5, 0.5}) * 6.0;
        // Towards a point that is a hair inside.
        const Vec3d dir = normalize(target * (1.0 - 1e-12) - origin);
        EXPECT_TRUE(intersect(corners, {origin, dir}, 0.0, 1e9).has_value());
    }
}

TEST(Shapes, HaveAVolumeUnlessTheirAxesLieInAPlaneButForRounding) {
    const auto spans = [](Vec3f x, Vec3f y, Vec3f z) {
        // Whatever the size, and in whatever order.
        for (const float size : {1e-12F, 1.0F, 1e12F}) {
            const bool first = has_volume({x * size, y * size, z * size, {}});
            EXPECT_EQ(first, has_volume({z * size, x * size, y * size, {}}));
            EXPECT_EQ(first, has_volume({y * size, x * size, z * size, {}}));
            if (size == 1e12F) return first;
        }
        return false;
    };
    EXPECT_TRUE(spans({1, 0, 0}, {0, 1, 0}, {0, 0, 1}));
    EXPECT_TRUE(spans({1, 0, 0}, {0, 1, 0}, {0, 0, 1e-5F}));      // a leaf
    EXPECT_TRUE(spans({1, 0, 0}, {0, 1e-7F, 0}, {0, 0, 1e-7F}));  // a needle
    EXPECT_TRUE(spans({1, 0, 0}, {1, 1e-4F, 0}, {1, 0, 1e-4F}));  // sheared
    EXPECT_FALSE(spans({1, 0, 0}, {0, 1, 0}, {0, 0, 1e-7F}));
    EXPECT_FALSE(spans({0.15F, 0.15F, 0.15F}, {0, -0.3F, 0.15F}, {-0.3F, -0.3F, -0.3F}));
    EXPECT_FALSE(spans({1, 0, 0}, {0, 1, 0}, {1, 1, 0}));
    EXPECT_FALSE(spans({1, 0, 0}, {2, 0, 0}, {3, 0, 0}));
    EXPECT_FALSE(spans({}, {}, {}));
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(has_volume({{1, 0, 0}, {0, kNan, 0}, {0, 0, 1}, {}}));
}

TEST(Shapes, GlyphsWithoutVolumeShowNothing) {
    const Scene scene({glyph_object({GlyphKind::ellipsoid},
                                    {{{1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {}},
                                     {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0.5F, 0, 0}},
                                     {{0.1F, 0, 0}, {0, 0.1F, 0}, {0, 0, 0.1F}, {0, 0, 0}}})});
    std::vector<RayPacket> rays(1);
    rays[0].active.fill(-1);
    rays[0].origin_z.fill(2.0F);
    rays[0].dir_z.fill(-1.0F);
    for (int i = 0; i < kLanes; ++i) {
        rays[0].origin_x[i] = static_cast<float>(i) * 0.05F;
        rays[0].origin_y[i] = rays[0].dir_x[i] = rays[0].dir_y[i] = 0.0F;
    }
    std::vector<HitPacket> hits(1);
    make_embree_tracer(scene)->intersect(rays, hits, Coherence::coherent);
    for (int i = 0; i < kLanes; ++i) {
        if (hits[0].object[i] != kNoObject) {
            EXPECT_EQ(hits[0].primitive[i], 2U);
        }
    }
    EXPECT_EQ(hits[0].primitive[0], 2U);
}

TEST(Shapes, SupportOfASuperellipsoidIsTheFarthestPointOfIt) {
    const UnitShape shape{GlyphKind::superellipsoid, 0.6, 1.3};
    const auto power = [](double x, double e) {
        return std::copysign(std::pow(std::abs(x), e), x);
    };
    for (const Vec3d d : {Vec3d{1, 0.3, 0.2}, Vec3d{-0.2, 0.9, -1.4}, Vec3d{0, 1, 1}}) {
        double farthest = 0.0;
        for (int i = 0; i <= 1000; ++i) {
            for (int j = 0; j <= 1000; ++j) {
                const double u = -pi / 2 + pi * i / 1000.0;
                const double v = -pi + 2 * pi * j / 1000.0;
                const Vec3d p{power(std::cos(u), 0.6) * power(std::cos(v), 1.3),
                              power(std::cos(u), 0.6) * power(std::sin(v), 1.3),
                              power(std::sin(u), 0.6)};
                farthest = std::max(farthest, dot(p, d));
            }
        }
        EXPECT_NEAR(support(shape, d), farthest, 1e-4);
    }
}

TEST(Polynomial, FindsTheRootsItWasMadeOf) {
    std::mt19937 random(2);
    for (int i = 0; i < 500; ++i) {
        std::array<double, 4> made;
        for (double& root : made) root = 4.0 * uniform(random) - 2.0;
        std::ranges::sort(made);
        const auto [a, b, c, d] = made;
        const Polynomial<4> f{a * b * c * d, -(a * b * c + a * b * d + a * c * d + b * c * d),
                              a * b + a * c + a * d + b * c + b * d + c * d, -(a + b + c + d), 1.0};
        const Roots<4> roots = real_roots<4>(f, -2.5, 2.5);
        ASSERT_EQ(roots.count, 4U);
        for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(roots.x[k], made[k], 1e-3);
    }
}

TEST(Polynomial, TakesALeadingZeroAsNoSpecialCase) {
    const Roots<4> roots = real_roots<4>({-1.0, 2.0, 0.0, 0.0, 0.0}, -3.0, 3.0);
    ASSERT_EQ(roots.count, 1U);
    EXPECT_NEAR(roots.x[0], 0.5, 1e-12);
    EXPECT_EQ(real_roots<2>({1.0, 0.0, 0.0}, -3.0, 3.0).count, 0U);
    EXPECT_EQ(real_roots<2>({0.0, 0.0, 0.0}, -3.0, 3.0).count, 0U);
}

}  // namespace
}  // namespace ink::test
