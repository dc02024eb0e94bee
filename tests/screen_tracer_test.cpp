#include "accel/screen_tracer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "camera/camera.h"
#include "scenes.h"
#include "seen.h"

namespace ink::test {
namespace {

TEST(ScreenTracer, HitsWhatBruteForceHitsInPerspective) {
    for (const double fov : {2.0, 30.0, 70.0}) {
        ViewSettings view;
        view.fov_deg = fov;
        const Seen seen(random_objects(7, 150, 200), view, kSmall);
        expect_same_hits(seen, seen.pixels());
        expect_same_hits(seen, seen.random_points(3, 200));
    }
}

TEST(ScreenTracer, HitsCopiesWhereBruteForceHitsThem) {
    const Seen seen(random_copies(7, 50, 100), {}, kSmall);
    expect_same_hits(seen, seen.pixels());
    expect_same_hits(seen, seen.random_points(3, 200));
}

TEST(ScreenTracer, HitsWhatBruteForceHitsInParallel) {
    ViewSettings view;
    view.orthographic = 0.0;
    const Seen seen(random_objects(8, 150, 200), view, {160, 96});
    expect_same_hits(seen, seen.pixels());
    expect_same_hits(seen, seen.random_points(4, 200));
}

/// Where a camera sees a point, pixels.
Vec2d on_screen(const Projection& p, Vec3f position) {
    const Vec3d v = to_double(position) - p.start;
    const double width = p.origin_step + dot(v, p.forward) * p.slope_step;
    return {dot(v, p.right) / width + p.centre.x, dot(v, p.down) / width + p.centre.y};
}

double distance_to_side(Vec2d point, Vec2d a, Vec2d b) {
    const Vec2d d{b.x - a.x, b.y - a.y};
    const Vec2d r{point.x - a.x, point.y - a.y};
    const double s = std::clamp((r.x * d.x + r.y * d.y) / (d.x * d.x + d.y * d.y), 0.0, 1.0);
    return std::hypot(r.x - s * d.x, r.y - s * d.y);
}

TEST(ScreenTracer, MeasuresHowFarPointsAreFromTheBordersOfTheirTriangles) {
    for (const bool parallel : {false, true}) {
        ViewSettings view;
        if (parallel) view.orthographic = 0.0;
        const Seen seen(random_objects(7, 50, 200), view, kSmall);
        const Projection projection = seen.camera().projection();
        const auto points = seen.pixels();
        const auto hits = seen.trace_raster(points);
        const auto borders = seen.measure_raster(points);
        int measured = 0;
        for (std::size_t k = 0; k < points.size(); ++k) {
            for (int i = 0; i < kLanes; ++i) {
                const std::uint32_t object = hits[k].object[i];
                const Mesh* mesh = object == kNoObject
                                       ? nullptr
                                       : std::get_if<Mesh>(&seen.scene().objects()[object].shape);
                if (mesh == nullptr) {
                    EXPECT_TRUE(std::isinf(borders[k].distance[i]));
                    continue;
                }
                ++measured;
                std::array<Vec2d, 3> corners;
                for (std::size_t n = 0; n < 3; ++n) {
                    corners[n] = on_screen(
                        projection, mesh->vertices[mesh->triangles[hits[k].primitive[i]][n]]);
                }
                const auto nearest_to = [&](Vec2d point) {
                    return std::min({distance_to_side(point, corners[0], corners[1]),
                                     distance_to_side(point, corners[1], corners[2]),
                                     distance_to_side(point, corners[2], corners[0])});
                };
                const Vec2d point{points[k].x[i], points[k].y[i]};
                const double distance = borders[k].distance[i];
                EXPECT_NEAR(distance, nearest_to(point), 1e-4);
                const Vec2d n{borders[k].nx[i], borders[k].ny[i]};
                EXPECT_NEAR(std::hypot(n.x, n.y), 1.0, 1e-6);
                const Vec2d foot{point.x - n.x * distance, point.y - n.y * distance};
                EXPECT_NEAR(nearest_to(foot), 0.0, 1e-4);
            }
        }
        EXPECT_GT(measured, 1000);
    }
}

TEST(ScreenTracer, SeesSpheresOfEverySize) {
    std::vector<Sphere> spheres{{{0, 0, -5}, 4.0F}};  // a wall
    std::mt19937 random(5);
    for (int i = 0; i < 300; ++i) {
        const float radius = std::pow(10.0F, -4.0F * uniform(random));
        spheres.push_back(
            {(uniform_point(random) - Vec3f{0.5F, 0.5F, 0.5F}) * 4.0F, radius * 0.4F});
    }
    const Seen seen({sphere_object(spheres)}, {}, kSmall);
    expect_same_hits(seen, seen.random_points(6, 2000));
}

TEST(ScreenTracer, SeesASphereFromJustBeforeIt) {
    ViewSettings view;
    view.eye = Vec3d{0, 0, 1.01};
    view.look_at = Vec3d{0, 0, 0};
    const Seen seen({sphere_object({{{0, 0, 0}, 1.0F}})}, view, kSmall);
    expect_same_hits(seen, seen.pixels());
}

/// A ball of triangles.
Object ball(int rings, int sides) {
    std::vector<Vec3f> vertices{{0, 0, 1}};
    for (int j = 1; j < rings; ++j) {
        for (int i = 0; i < sides; ++i) {
            const double theta = std::numbers::pi * j / rings;
            const double phi = 2.0 * std::numbers::pi * i / sides;
            vertices.push_back(to_float(Vec3d{std::sin(theta) * std::cos(phi),
                                              std::sin(theta) * std::sin(phi), std::cos(theta)}));
        }
    }
    vertices.push_back({0, 0, -1});
    const auto at = [&](int j, int i) {
        return static_cast<std::uint32_t>(1 + (j - 1) * sides + i % sides);
    };
    const auto last = static_cast<std::uint32_t>(vertices.size() - 1);
    std::vector<Mesh::Triangle> triangles;
    for (int i = 0; i < sides; ++i) {
        triangles.push_back({0, at(1, i), at(1, i + 1)});
        for (int j = 1; j + 1 < rings; ++j) {
            triangles.push_back({at(j, i), at(j + 1, i), at(j + 1, i + 1)});
            triangles.push_back({at(j, i), at(j + 1, i + 1), at(j, i + 1)});
        }
        triangles.push_back({at(rings - 1, i), last, at(rings - 1, i + 1)});
    }
    return mesh_object(std::move(vertices), std::move(triangles));
}

TEST(ScreenTracer, LetsNoRayThroughBetweenTriangles) {
    const Seen seen({ball(24, 48)}, {}, {512, 512});
    // Points along edges as the camera sees them, and on vertices: found by bisecting between two
    // neighbouring triangles, until a and b are neighbouring floats.
    std::vector<PointPacket> points = seen.random_points(9, 300);
    std::vector<PointPacket> on_edges;
    for (const PointPacket& packet : points) {
        PointPacket a = packet;
        PointPacket b = packet;
        for (int i = 0; i < kLanes; ++i) {
            a.x[i] = 200.0F + a.x[i] * 0.2F;
            a.y[i] = 200.0F + a.y[i] * 0.2F;
            b.x[i] = a.x[i] + 6.0F;
            b.y[i] = a.y[i] + 1.0F;
        }
        for (int step = 0; step < 20; ++step) {
            PointPacket middle = a;
            for (int i = 0; i < kLanes; ++i) {
                middle.x[i] = 0.5F * (a.x[i] + b.x[i]);
                middle.y[i] = 0.5F * (a.y[i] + b.y[i]);
            }
            const auto hits = seen.trace({a, middle});
            for (int i = 0; i < kLanes; ++i) {
                PointPacket& end = same_primitive(hits[0], hits[1], i) ? a : b;
                end.x[i] = middle.x[i];
                end.y[i] = middle.y[i];
            }
        }
        on_edges.push_back(a);
        on_edges.push_back(b);
    }
    const auto hits = seen.trace(on_edges);
    for (const HitPacket& packet : hits) {
        for (int i = 0; i < kLanes; ++i) {
            ASSERT_EQ(packet.object[i], 0U);
            ASSERT_LT(packet.t[i], 1.0F) << "sees the far side";
        }
    }
}

TEST(ScreenTracer, GivesAPointOneAnswerWhateverItsCompanyAndArea) {
    const Seen seen(random_objects(17, 400, 400), {}, kSmall);
    const auto points = seen.pixels();
    const auto all = seen.trace(points);
    for (std::size_t k = 0; k < points.size(); k += 7) {
        // The same points, each among fifteen of other blocks, in an area of their own.
        PointPacket mixed = points[(k * 31 + 5) % points.size()];
        const int lane = static_cast<int>(k % kLanes);
        mixed.x[lane] = points[k].x[lane];
        mixed.y[lane] = points[k].y[lane];
        expect_same_bits(seen.trace({mixed})[0], lane, all[k], lane);
        const ScreenBox area{points[k].x[0], points[k].y[0], points[k].x[kLanes - 1],
                             points[k].y[kLanes - 1]};
        const HitPacket alone = seen.trace({points[k]}, area)[0];
        for (int i = 0; i < kLanes; ++i) expect_same_bits(alone, i, all[k], i);
    }
}

TEST(ScreenTracer, GivesAPointOneAnswerWhereverItHasBeenBefore) {
    std::mt19937 random(21);
    std::vector<Sphere> dust;  // in more clusters than are kept from area to area
    for (int i = 0; i < 40000; ++i) dust.push_back({uniform_point(random), 0.008F});
    const Seen seen({sphere_object(std::move(dust))}, {}, {256, 256});
    const auto points = seen.pixels();
    const auto travelled = seen.tile_tracer();
    for (int n = 0; n < 600; ++n) {
        const std::size_t k = random() % points.size();
        const std::vector<PointPacket> one{points[k]};
        std::vector<HitPacket> hits(1);
        travelled->enter(
            {points[k].x[0], points[k].y[0], points[k].x[kLanes - 1], points[k].y[kLanes - 1]});
        travelled->intersect(one, seen.rays(one), hits);
        const HitPacket fresh = seen.trace(one)[0];
        for (int i = 0; i < kLanes; ++i) expect_same_bits(hits[0], i, fresh, i);
    }
}

TEST(ScreenTracer, GivesTheSameBitsOnEveryInstructionSet) {
    expect_same_bits_on_every_instruction_set(Seen(random_objects(21, 300, 300), {}, kSmall));
}

/// Points of a box, with its corners.
std::vector<PointPacket> points_in(const ScreenBox& box, std::mt19937& random) {
    std::vector<PointPacket> points(4);
    for (PointPacket& packet : points) {
        for (int i = 0; i < kLanes; ++i) {
            const bool corner = i < 4;
            const float x = corner ? static_cast<float>(i % 2) : uniform(random);
            const float y = corner ? static_cast<float>(i / 2) : uniform(random);
            packet.x[i] = box.left + x * (box.right - box.left);
            packet.y[i] = box.top + y * (box.bottom - box.top);
        }
    }
    return points;
}

TEST(ScreenTracer, SaysOfNoBallThatItCoversWhatAnyRayMisses) {
    std::mt19937 random(12);
    std::vector<Sphere> spheres;
    for (int i = 0; i < 60; ++i) {
        spheres.push_back({uniform_point(random), 0.05F + 0.2F * uniform(random)});
    }
    ViewSettings parallel;
    parallel.orthographic = 0.0;
    ViewSettings wide;
    wide.fov_deg = 70.0;
    for (const ViewSettings& view : {ViewSettings{}, parallel, wide}) {
        const Seen seen({sphere_object(spheres)}, view, kSmall);
        const auto tracer = seen.tile_tracer();
        int covered = 0;
        int could_be = 0;
        for (int n = 0; n < 2000; ++n) {
            const float left = 122.0F * uniform(random);
            const float top = 122.0F * uniform(random);
            const ScreenBox box{left, top, left + 5.0F, top + 5.0F};
            const std::vector<PointPacket> points = points_in(box, random);
            const std::vector<HitPacket> hits = seen.trace_brute_force(points);
            const std::uint32_t object = hits[0].object[0];
            const std::uint32_t primitive = hits[0].primitive[0];
            if (object == kNoObject) continue;
            bool all = true;
            for (const HitPacket& packet : hits) {
                for (int i = 0; i < kLanes; ++i) {
                    all &= packet.object[i] == object && packet.primitive[i] == primitive;
                }
            }
            could_be += all ? 1 : 0;
            if (!tracer->covers(object, primitive, box)) continue;
            ++covered;
            EXPECT_TRUE(all) << left << ", " << top;
        }
        EXPECT_GT(could_be, 300);
        EXPECT_GT(2 * covered, could_be);  // and not only of none
    }
}

TEST(ScreenTracer, LeavesInactiveRaysAlone) {
    const Seen seen(random_objects(7, 100, 100), {}, kSmall);
    const Scene scene(random_objects(7, 100, 100));
    const auto tracer = make_tracer(scene);
    const auto frame = tracer->frame(seen.camera().projection(), 1);
    const auto tile = frame->tile_tracer();
    tile->enter(seen.whole());
    std::vector<PointPacket> points = seen.pixels();
    for (std::size_t k = 0; k < points.size(); k += 11) {
        RayPacket rays{};
        seen.camera().make_rays(points[k].x, points[k].y, rays);
        const HitPacket all = seen.trace({points[k]})[0];
        for (int i = 0; i < kLanes; ++i) points[k].active[i] = i % 3 == 0 ? 0 : -1;
        HitPacket hits;
        tile->intersect(std::span(&points[k], 1), std::span(&rays, 1), std::span(&hits, 1));
        for (int i = 0; i < kLanes; ++i) {
            EXPECT_EQ(hits.object[i], i % 3 == 0 ? kNoObject : all.object[i]);
            EXPECT_EQ(hits.t[i], i % 3 == 0 ? kInfinity : all.t[i]);
        }
    }
}

TEST(ScreenTracer, GivesRastersAndPacketsBesideThemTheHitsOfTheirPoints) {
    std::mt19937 random(15);
    std::vector<Object> objects = random_objects(18, 300, 300);
    objects.push_back(random_glyphs({.kind = GlyphKind::box}, 60, 0.3, random));
    const Seen seen(std::move(objects), {}, kSmall);
    auto points = seen.pixels();
    const auto others = seen.random_points(4, 100);
    points.insert(points.end(), others.begin(), others.end());
    const auto expected = seen.trace(points);
    const auto hits = seen.trace_raster(points);
    for (std::size_t k = 0; k < points.size(); ++k) {
        for (int i = 0; i < kLanes; ++i) expect_same_bits(hits[k], i, expected[k], i);
    }
}

/// Most of them lie between the points, and are not looked at.
TEST(ScreenTracer, FindsTrianglesThatAreSmallerThanTheSpacingOfPoints) {
    const Seen seen({ball(64, 128)}, {}, {32, 32});
    const auto points = seen.pixels();
    const auto hits = seen.trace_raster(points);
    const auto expected = seen.trace_brute_force(points);
    int seen_ball = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
        for (int i = 0; i < kLanes; ++i) {
            ASSERT_EQ(hits[k].object[i], expected[k].object[i]);
            if (hits[k].object[i] == kNoObject) continue;
            ++seen_ball;
            ASSERT_NEAR(hits[k].t[i], expected[k].t[i], 1e-4);
        }
    }
    EXPECT_GT(seen_ball, 400);
}

/// They have no bounds, and must leave those of their cluster alone, which are asked after its
/// first use.
TEST(ScreenTracer, GivesTheHitsOfSticksBesideOnesWithoutALength) {
    for (std::size_t without = 1; without < kLanes; ++without) {
        std::vector<Object> objects = chain_of_sticks(3, 20, 1.0F);
        auto& placements = std::get<Glyphs>(objects[1].shape).placements;
        for (std::size_t k = 0; k < without; ++k) {
            const Vec3d end = to_double(placements[k].origin);
            placements[k] = placement_between(end, end, 0.02);
        }
        const Seen seen(std::move(objects), {}, kSmall);
        const auto cells = seen.pixels();
        std::vector<PointPacket> points = cells;
        points.insert(points.end(), cells.begin(), cells.end());
        const auto hits = seen.trace_raster(points);
        std::size_t count = 0;
        for (std::size_t k = 0; k < cells.size(); ++k) {
            for (int i = 0; i < kLanes; ++i) {
                expect_same_bits(hits[cells.size() + k], i, hits[k], i);
                count += hits[k].object[i] == 1 ? 1 : 0;
            }
        }
        EXPECT_GT(count, 0U);
    }
}

TEST(SceneTracer, LeavesPixelsThatAreFullOfPrimitivesToEmbree) {
    std::mt19937 random(16);
    std::vector<Sphere> dust;
    for (int i = 0; i < 60000; ++i) dust.push_back({uniform_point(random), 0.004F});
    const Scene scene({sphere_object(std::move(dust))});
    const Clusters clusters(scene);
    const auto suits = [&](int side) {
        const Camera camera(scene, {}, {side, side});
        return make_suited_screen_tracer(clusters, camera.projection()) != nullptr;
    };
    EXPECT_TRUE(suits(1024));
    EXPECT_FALSE(suits(16));
}

TEST(SceneTracer, MergesWhatOnlyEmbreeTracesByDepth) {
    std::vector<Object> objects = random_objects(12, 60, 60);
    std::mt19937 random(3);
    Glyphs tori{
        .shape = {.kind = GlyphKind::torus, .a = 0.4}, .placements = {}, .colors = {}, .parts = {}};
    for (int i = 0; i < 60; ++i) {
        tori.placements.push_back(
            {{0.1F, 0, 0}, {0, 0.05F, 0.05F}, {0, -0.05F, 0.05F}, uniform_point(random)});
    }
    Object object;
    object.kind = ObjectKind::shape;
    object.shape = std::move(tori);
    objects.insert(objects.begin() + 1, std::move(object));
    const Scene scene(std::move(objects));
    const Camera camera(scene, {}, kSmall);
    const auto embree = make_embree_tracer(scene);
    const auto tracer = make_tracer(scene);
    const auto frame = tracer->frame(camera.projection(), 1);
    const auto tile = frame->tile_tracer();
    tile->enter({0, 0, 128, 128});
    std::array<int, 3> seen{};
    int different = 0;
    for (int k = 0; k < 32 * 32; ++k) {
        PointPacket points{};
        RayPacket rays;
        for (int i = 0; i < kLanes; ++i) {
            points.x[i] = static_cast<float>(k % 32 * 4 + i % 4) + 0.5F;
            points.y[i] = static_cast<float>(k / 32 * 4 + i / 4) + 0.5F;
        }
        camera.make_rays(points.x, points.y, rays);
        HitPacket merged;
        HitPacket whole;
        tile->intersect(std::span(&points, 1), std::span(&rays, 1), std::span(&merged, 1));
        embree->intersect(std::span(&rays, 1), std::span(&whole, 1), Coherence::incoherent);
        for (int i = 0; i < kLanes; ++i) {
            different += same_primitive(merged, whole, i) ? 0 : 1;
            if (whole.object[i] != kNoObject) ++seen[whole.object[i]];
        }
    }
    EXPECT_LE(different, 3);
    for (const int count : seen) EXPECT_GT(count, 100);
}

}  // namespace
}  // namespace ink::test
