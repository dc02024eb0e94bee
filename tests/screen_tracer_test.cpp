#include "accel/screen_tracer.h"

#include <gtest/gtest.h>

#include <hwy/targets.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "accel/candidates.h"
#include "camera/camera.h"
#include "scenes.h"

namespace ink::test {
namespace {

/// A scene, a camera, and what the screen tracer and brute force see through it.
class Seen {
  public:
    using MakeOracle = std::unique_ptr<Tracer> (*)(const Scene&);

    Seen(std::vector<Object> objects, const ViewSettings& view, Size size,
         MakeOracle make_oracle = make_brute_force_tracer)
        : scene_(std::move(objects)),
          clusters_(scene_),
          camera_(scene_, view, size),
          size_(size),
          frame_(make_screen_tracer(clusters_, camera_.projection())),
          oracle_(make_oracle(scene_)) {
        EXPECT_TRUE(camera_.projection().sees_all());
    }

    const Camera& camera() const { return camera_; }
    const Scene& scene() const { return scene_; }

    /// Pixel centres, or points at random, sixteen a packet.
    std::vector<PointPacket> pixels() const {
        std::vector<PointPacket> points;
        for (int y = 0; y < size_.height; y += kBlockSide) {
            for (int x = 0; x < size_.width; x += kBlockSide) {
                PointPacket packet{};
                for (int i = 0; i < kLanes; ++i) {
                    packet.x[i] = static_cast<float>(x + i % kBlockSide) + 0.5F;
                    packet.y[i] = static_cast<float>(y + i / kBlockSide) + 0.5F;
                }
                points.push_back(packet);
            }
        }
        return points;
    }
    std::vector<PointPacket> random_points(unsigned seed, std::size_t packets) const {
        std::mt19937 random(seed);
        std::vector<PointPacket> points(packets);
        for (PointPacket& packet : points) {
            for (int i = 0; i < kLanes; ++i) {
                packet.x[i] = uniform(random) * static_cast<float>(size_.width);
                packet.y[i] = uniform(random) * static_cast<float>(size_.height);
            }
        }
        return points;
    }

    std::vector<HitPacket> trace(const std::vector<PointPacket>& points) const {
        return trace(points, whole());
    }
    std::vector<HitPacket> trace(const std::vector<PointPacket>& points,
                                 const ScreenBox& area) const {
        const auto tracer = frame_->tile_tracer();
        tracer->enter(area);
        std::vector<HitPacket> hits(points.size());
        tracer->intersect(points, rays(points), hits);
        return hits;
    }
    /// The first packets are the cells of a raster.
    std::vector<HitPacket> trace_raster(const std::vector<PointPacket>& points) const {
        std::vector<HitPacket> hits(points.size());
        find_raster(points)->resolve(0, points, rays(points), hits);
        return hits;
    }
    /// Likewise.
    std::vector<BorderPacket> measure_raster(const std::vector<PointPacket>& points) const {
        EXPECT_TRUE(frame_->measures_borders());
        std::vector<BorderPacket> borders(points.size());
        find_raster(points)->measure(0, borders);
        return borders;
    }
    std::vector<HitPacket> trace_brute_force(const std::vector<PointPacket>& points) const {
        return trace(*oracle_, points, Coherence::incoherent);
    }
    std::vector<HitPacket> trace(const Tracer& tracer, const std::vector<PointPacket>& points,
                                 Coherence coherence) const {
        std::vector<HitPacket> hits(points.size());
        tracer.intersect(rays(points), hits, coherence);
        return hits;
    }
    std::unique_ptr<TileTracer> tile_tracer() const {
        auto tracer = frame_->tile_tracer();
        tracer->enter(whole());
        return tracer;
    }
    ScreenBox whole() const {
        return {0, 0, static_cast<float>(size_.width), static_cast<float>(size_.height)};
    }

    std::unique_ptr<TileTracer> find_raster(const std::vector<PointPacket>& points) const {
        auto tracer = frame_->tile_tracer();
        tracer->want_borders();
        tracer->enter(whole());
        const int across = size_.width / kBlockSide;
        const int down = size_.height / kBlockSide;
        std::vector<std::uint32_t> cells(static_cast<std::size_t>(across * down));
        std::iota(cells.begin(), cells.end(), 0U);
        tracer->find({0, 0, kBlockSide, across, down, cells, cells.size()}, points);
        return tracer;
    }
    std::vector<RayPacket> rays(const std::vector<PointPacket>& points) const {
        std::vector<RayPacket> rays(points.size());
        for (std::size_t k = 0; k < points.size(); ++k) {
            camera_.make_rays(points[k].x, points[k].y, rays[k]);
        }
        return rays;
    }

  private:
    Scene scene_;
    Clusters clusters_;
    Camera camera_;
    Size size_;
    std::unique_ptr<FrameTracer> frame_;
    std::unique_ptr<Tracer> oracle_;
};

bool same_primitive(const HitPacket& a, const HitPacket& b, int i) {
    return a.object[i] == b.object[i] &&
           (a.object[i] == kNoObject || a.primitive[i] == b.primitive[i]);
}

/// Whether brute force sees `wanted` through some point within `reach` pixels.
bool seen_nearby(const Seen& seen, Vec2f at, float reach, const HitPacket& wanted, int lane) {
    PointPacket around{};
    for (int i = 0; i < kLanes; ++i) {
        const double angle = i * std::numbers::pi / 8.0;
        around.x[i] = at.x + reach * static_cast<float>(std::cos(angle));
        around.y[i] = at.y + reach * static_cast<float>(std::sin(angle));
    }
    const HitPacket hits = seen.trace_brute_force({around})[0];
    for (int i = 0; i < kLanes; ++i) {
        if (hits.object[i] == wanted.object[lane] &&
            (hits.object[i] == kNoObject || hits.primitive[i] == wanted.primitive[lane])) {
            return true;
        }
    }
    return false;
}

struct Tolerance {
    float pixels = 2e-4F;  ///< to an outline, where either answer is right
    float t = 1e-5F;       ///< where the surface faces the viewer
};

/// Every ray hits what brute force hits, unless an outline runs close by.
void expect_same_hits(const Seen& seen, const std::vector<PointPacket>& points,
                      Tolerance tolerance = {}) {
    const auto screen = seen.trace(points);
    const auto brute = seen.trace_brute_force(points);
    int hits = 0;
    int different = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
        for (int i = 0; i < kLanes; ++i) {
            const Vec2f at{points[k].x[i], points[k].y[i]};
            if (!same_primitive(screen[k], brute[k], i)) {
                ++different;
                EXPECT_TRUE(seen_nearby(seen, at, tolerance.pixels, screen[k], i))
                    << at.x << ", " << at.y;
                continue;
            }
            if (brute[k].object[i] == kNoObject) {
                EXPECT_TRUE(std::isinf(screen[k].t[i]));
                continue;
            }
            ++hits;
            const Vec3f n =
                normalize(Vec3f{brute[k].normal_x[i], brute[k].normal_y[i], brute[k].normal_z[i]});
            const float facing = std::abs(dot(n, seen.camera().back()));
            EXPECT_NEAR(screen[k].t[i], brute[k].t[i], tolerance.t / std::max(facing, 1e-2F));
            if (facing < 0.1F) continue;
            const Vec3f m = normalize(
                Vec3f{screen[k].normal_x[i], screen[k].normal_y[i], screen[k].normal_z[i]});
            EXPECT_GT(std::abs(dot(m, n)), 1.0F - 1e-3F);
            EXPECT_NEAR(screen[k].u[i], brute[k].u[i], 2e-3F);
            EXPECT_NEAR(screen[k].v[i], brute[k].v[i], 2e-3F);
        }
    }
    EXPECT_GT(hits, 0);
    EXPECT_LE(different, 5 + hits / 1000);
}

constexpr Size kSmall{128, 128};

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

TEST(Clusters, OfCopiesShareAllButTheirBounds) {
    std::vector<Object> once = random_objects(7, 1000, 0);
    std::vector<Object> copied = random_copies(7, 1000, 0);
    once.pop_back();
    copied.pop_back();
    const Scene one(std::move(once));
    const Scene four(std::move(copied));
    const Clusters alone(one);
    const Clusters copies(four);
    EXPECT_EQ(copies.spheres.size(), alone.spheres.size());
    EXPECT_EQ(copies.order.size(), alone.order.size());
    EXPECT_EQ(copies.clusters.size(), 4 * alone.clusters.size());
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

void expect_same_bits(const HitPacket& a, int i, const HitPacket& b, int j) {
    EXPECT_EQ(a.t[i], b.t[j]);
    EXPECT_EQ(a.normal_x[i], b.normal_x[j]);
    EXPECT_EQ(a.normal_y[i], b.normal_y[j]);
    EXPECT_EQ(a.normal_z[i], b.normal_z[j]);
    EXPECT_EQ(a.u[i], b.u[j]);
    EXPECT_EQ(a.v[i], b.v[j]);
    EXPECT_EQ(a.primitive[i], b.primitive[j]);
    EXPECT_EQ(a.object[i], b.object[j]);
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
    const Seen seen(random_objects(21, 300, 300), {}, kSmall);
    const auto points = seen.pixels();
    const auto native = seen.trace(points);
    int sets = 0;
    for (const std::int64_t target : {HWY_SSSE3, HWY_SSE4, HWY_AVX2, HWY_AVX3}) {
        hwy::SetSupportedTargetsForTest(0);
        if ((hwy::SupportedTargets() & target) == 0) continue;
        hwy::SetSupportedTargetsForTest(target);
        const auto hits = seen.trace(points);
        ++sets;
        for (std::size_t k = 0; k < points.size(); ++k) {
            for (int i = 0; i < kLanes; ++i) expect_same_bits(hits[k], i, native[k], i);
        }
    }
    hwy::SetSupportedTargetsForTest(0);
    EXPECT_GE(sets, 1);
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

// ---- Glyphs and hexahedra ----

/// Shapes are met by closed forms in double precision (shape_intersection.h), which tests of their
/// own compare with brute force.
std::unique_ptr<Tracer> make_double_tracer(const Scene& scene) { return make_embree_tracer(scene); }

struct NamedShape {
    std::string name;
    UnitShape shape;
};

class EveryScreenShape : public testing::TestWithParam<NamedShape> {};

INSTANTIATE_TEST_SUITE_P(
    Shapes, EveryScreenShape, testing::ValuesIn([] {
        using enum GlyphKind;
        return std::vector<NamedShape>{
            {"Ellipsoid", {ellipsoid}},   {"Box", {box}},
            {"Cylinder", {frustum, 1.0}}, {"Tube", {frustum, 1.0, 1.0, false}},
            {"Cone", {frustum, 0.0}},     {"OpenCone", {frustum, 0.3, 1.0, false}},
            {"Frustum", {frustum, 0.4}},  {"Disc", {disc}},
            {"Rectangle", {rectangle}}};
    }()),
    [](const auto& shape) { return shape.param.name; });

Vec3f random_vector(std::mt19937& random) {
    return (uniform_point(random) - Vec3f{0.5F, 0.5F, 0.5F}) * 2.0F;
}

/// Glyphs of random shape and shear, `size` long at most, each of its volume's cube root at least a
/// tenth of that.
Object random_glyphs(const UnitShape& shape, int count, double size, std::mt19937& random) {
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

TEST_P(EveryScreenShape, IsHitWhereItsEquationSays) {
    std::mt19937 random(11);
    for (const double fov : {0.0, 2.0, 30.0, 70.0}) {
        ViewSettings view;
        if (fov == 0.0) view.orthographic = 0.0;
        if (fov != 0.0) view.fov_deg = fov;
        const Seen seen({random_glyphs(GetParam().shape, 100, 0.4, random)}, view, {192, 160},
                        make_double_tracer);
        expect_same_hits(seen, seen.random_points(3, 2000));
    }
}

TEST_P(EveryScreenShape, IsHitInAllItsCopies) {
    std::mt19937 random(13);
    Object original = random_glyphs(GetParam().shape, 40, 0.4, random);
    std::get<Glyphs>(original.shape).copies = four_copies();
    const Seen seen({std::move(original)}, {}, {192, 160}, make_double_tracer);
    expect_same_hits(seen, seen.random_points(3, 2000));
}

TEST_P(EveryScreenShape, IsHitWhereItsEquationSaysAtAnySize) {
    std::mt19937 random(12);
    std::vector<Object> objects;
    for (const double size : {1.0, 0.1, 1e-2, 1e-3}) {
        objects.push_back(random_glyphs(GetParam().shape, 60, size, random));
    }
    const Seen seen(std::move(objects), {}, {512, 512}, make_double_tracer);
    expect_same_hits(seen, seen.random_points(4, 4000));
}

TEST_P(EveryScreenShape, IsSeenFromJustBeforeItAndFromFar) {
    for (const double distance : {2.2, 1e4}) {
        ViewSettings view;
        view.eye = Vec3d{0.3 * distance, 0.2 * distance, distance};
        view.look_at = Vec3d{0, 0, 0};
        view.fov_deg = distance < 10.0 ? 70.0 : 0.015;
        Object object;
        object.kind = ObjectKind::shape;
        object.shape = Glyphs{GetParam().shape, {Placement{}}, {}, {}};
        const Seen seen({std::move(object)}, view, kSmall, make_double_tracer);
        expect_same_hits(seen, seen.random_points(5, 1000));
    }
}

Hexahedra::Corners box_corners(Vec3f lower, Vec3f upper) {
    const auto [x, y, z] = lower;
    const auto [u, v, w] = upper;
    return {
        {{x, y, z}, {u, y, z}, {u, v, z}, {x, v, z}, {x, y, w}, {u, y, w}, {u, v, w}, {x, v, w}}};
}

Object hexahedron_object(std::vector<Hexahedra::Corners> corners) {
    Object object;
    object.kind = ObjectKind::shape;
    object.shape = Hexahedra{std::move(corners), {}, {}};
    return object;
}

TEST(ScreenTracer, HitsHexahedraWhereTheirFacesAre) {
    std::mt19937 random(13);
    std::vector<Hexahedra::Corners> solids;
    for (int i = 0; i < 100; ++i) {
        const Vec3f at = random_vector(random);
        auto corners = box_corners(at, at + Vec3f{0.2F, 0.3F, 0.15F});
        const Vec3f shear = random_vector(random) * 0.4F;
        for (Vec3f& corner : corners) corner = corner + shear * (corner.z - at.z);
        solids.push_back(corners);
    }
    const Seen seen({hexahedron_object(std::move(solids))}, {}, kSmall, make_double_tracer);
    expect_same_hits(seen, seen.random_points(6, 2000));
}

TEST(ScreenTracer, GivesGlyphsTheSameBitsOnEveryInstructionSet) {
    std::mt19937 random(14);
    std::vector<Object> objects;
    for (const GlyphKind kind : {GlyphKind::ellipsoid, GlyphKind::box, GlyphKind::frustum,
                                 GlyphKind::disc, GlyphKind::rectangle}) {
        objects.push_back(random_glyphs({.kind = kind, .a = 0.5}, 60, 0.3, random));
    }
    const Seen seen(std::move(objects), {}, kSmall);
    const auto points = seen.pixels();
    const auto native = seen.trace(points);
    for (const std::int64_t target : {HWY_SSSE3, HWY_SSE4, HWY_AVX2, HWY_AVX3}) {
        hwy::SetSupportedTargetsForTest(0);
        if ((hwy::SupportedTargets() & target) == 0) continue;
        hwy::SetSupportedTargetsForTest(target);
        const auto hits = seen.trace(points);
        for (std::size_t k = 0; k < points.size(); ++k) {
            for (int i = 0; i < kLanes; ++i) expect_same_bits(hits[k], i, native[k], i);
        }
    }
    hwy::SetSupportedTargetsForTest(0);
}

// ---- Rasters ----

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

// ---- Coincident surfaces ----

void expect_first_wins(const std::vector<HitPacket>& packets, std::uint32_t primitives) {
    int hits = 0;
    for (const HitPacket& packet : packets) {
        for (int i = 0; i < kLanes; ++i) {
            if (packet.object[i] == kNoObject) continue;
            ++hits;
            EXPECT_EQ(packet.object[i], 0U);
            EXPECT_LT(packet.primitive[i], primitives);
        }
    }
    EXPECT_GT(hits, 1000);
}

/// Every hit belongs to the lowest object, and there to one of its first `primitives`; by Embree,
/// too.
void expect_first_wins(const Seen& seen, std::uint32_t primitives) {
    const auto points = seen.random_points(7, 2000);
    expect_first_wins(seen.trace(points), primitives);
    for (const PacketWidth width : {PacketWidth::four, PacketWidth::eight, PacketWidth::sixteen}) {
        const auto embree = make_embree_tracer(seen.scene(), width);
        expect_first_wins(seen.trace(*embree, points, Coherence::coherent), primitives);
    }
}

ViewSettings oblique_view() {
    ViewSettings view;
    view.eye = Vec3d{3.1, 2.3, 4.7};
    view.look_at = Vec3d{0.1, 0.05, -0.02};
    return view;
}

TEST(Coincidence, PrefersTheFirstOfTrianglesThatAreThereTwice) {
    const std::vector<Vec3f> corners{
        {-1, -0.9F, 0.1F}, {1, -1, 0.3F}, {0.9F, 1, -0.2F}, {-1, 1.1F, 0.17F}};
    const std::vector<Mesh::Triangle> once{{0, 1, 2}, {0, 2, 3}};
    for (const Mesh::Triangle& order : {Mesh::Triangle{0, 1, 2}, {1, 2, 0}, {2, 1, 0}, {1, 0, 2}}) {
        std::vector<Mesh::Triangle> twice = once;
        for (const Mesh::Triangle& triangle : once) {
            twice.push_back({triangle[order[0]], triangle[order[1]], triangle[order[2]]});
        }
        expect_first_wins(Seen({mesh_object(corners, twice)}, oblique_view(), {512, 512}), 2);
    }
}

TEST(Coincidence, PrefersTheFirstOfObjectsThatShareAFace) {
    const auto square = [](const std::vector<Mesh::Triangle>& triangles) {
        return mesh_object({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, triangles);
    };
    // Cut along the other diagonal.
    expect_first_wins(Seen({square({{0, 1, 2}, {0, 2, 3}}), square({{1, 2, 3}, {1, 3, 0}})},
                           oblique_view(), {512, 512}),
                      2);
    // Twenty of them: more than a depth can be set back by.
    std::vector<Object> stack;
    for (int i = 0; i < 20; ++i) {
        stack.push_back(i % 2 == 0 ? square({{0, 1, 2}, {0, 2, 3}})
                                   : square({{1, 2, 3}, {1, 3, 0}}));
    }
    expect_first_wins(Seen(std::move(stack), oblique_view(), {512, 512}), 2);
}

TEST(Coincidence, PrefersTheFirstOfBoxesThatFillTheSamePlace) {
    Object object;
    object.kind = ObjectKind::shape;
    Placement turned;
    turned.x_axis = {0, 1, 0};
    turned.y_axis = {-1, 0, 0};
    object.shape = Glyphs{{GlyphKind::box}, {Placement{}, turned, Placement{}}, {}, {}};
    expect_first_wins(Seen({object}, oblique_view(), {512, 512}), 1);
    const Object solid = hexahedron_object({box_corners({-1, -1, -1}, {1, 1, 1})});
    expect_first_wins(Seen({object, solid}, oblique_view(), {512, 512}), 1);
    expect_first_wins(Seen({solid, object}, oblique_view(), {512, 512}), 1);
}

TEST(Candidates, AreTheSameInBandsAndInTheTree) {
    const Scene scene(random_objects(11, 3000, 3000));
    const Clusters clusters(scene);
    const Camera camera(scene, oblique_view(), {512, 384});
    const Projection& projection = camera.projection();
    const BoundsPyramid pyramid(clusters, Basis(projection));
    const ClusterBands bands(pyramid, clusters.clusters.size(), projection.centre);
    Candidates sorted(pyramid, &bands);
    Candidates searched(pyramid, nullptr);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> place(-300.0F, 300.0F);
    std::exponential_distribution<float> size(1.0F / 30.0F);
    std::size_t met = 0;
    for (int n = 0; n < 500; ++n) {
        Window window{place(random), 0, place(random), 0, kInfinity};
        window.right = window.left + size(random);
        window.bottom = window.top + size(random);
        std::vector<std::uint32_t> found[2];
        for (Candidates* candidates : {&sorted, &searched}) {
            candidates->enter(window);
            while (candidates->find_more(kInfinity)) {
            }
            for (std::size_t i = 0; i < candidates->count(); ++i) {
                found[candidates == &sorted ? 0 : 1].push_back(candidates->cluster(i));
            }
            EXPECT_TRUE(candidates->reach(window) || candidates->count() == 0);
        }
        EXPECT_EQ(found[0], found[1]);
        met += found[0].size();
    }
    EXPECT_GT(met, 5000U);
}

TEST(Candidates, ReachNoBoxBetweenTwoObjects) {
    const Scene scene({sphere_object({{{-1, 0, 0}, 0.1F}}), sphere_object({{{1, 0, 0}, 0.1F}})});
    const Clusters clusters(scene);
    const Camera camera(scene, {}, {256, 256});
    const Projection& projection = camera.projection();
    const BoundsPyramid pyramid(clusters, Basis(projection));
    const ClusterBands bands(pyramid, clusters.clusters.size(), projection.centre);
    const Candidates candidates(pyramid, &bands);
    EXPECT_TRUE(candidates.reach({-128, 0, -2, 2, kInfinity}));
    EXPECT_TRUE(candidates.reach({0, 128, -2, 2, kInfinity}));
    EXPECT_FALSE(candidates.reach({-8, 8, -8, 8, kInfinity}));
}

TEST(ClusterBands, SayOfARowOfBoxesWhatTheySayOfEach) {
    std::mt19937 random(21);
    std::vector<Sphere> spheres;
    for (int k = 0; k < 60; ++k) {
        spheres.push_back({{uniform(random), uniform(random), uniform(random)}, 0.01F});
    }
    const Scene scene({sphere_object(spheres)});
    const Clusters clusters(scene);
    const Camera camera(scene, {}, {512, 384});
    const Projection& projection = camera.projection();
    const BoundsPyramid pyramid(clusters, Basis(projection));
    const ClusterBands bands(pyramid, clusters.clusters.size(), projection.centre);
    int reached = 0;
    for (const float step : {4.0F, 2.0F, 1.0F}) {
        for (const float wider : {0.0F, 0.5F, 6.0F}) {
            for (int count = 1; count <= 64; count += 7) {
                for (float top = -200.0F; top < 200.0F; top += 12.0F) {
                    const Window first{-264.0F + 8.0F * static_cast<float>(count) - wider,
                                       -264.0F + 8.0F * static_cast<float>(count) + step + wider,
                                       top - wider, top + step + wider, kInfinity};
                    const std::uint64_t bits = bands.reached(first, step, count);
                    for (int k = 0; k < 64; ++k) {
                        const float right = static_cast<float>(k) * step;
                        const Window box{first.left + right, first.right + right, first.top,
                                         first.bottom, kInfinity};
                        const bool in_row = (bits >> k & 1U) != 0;
                        EXPECT_EQ(in_row, k < count && bands.reach(box)) << count << " " << k;
                        reached += in_row ? 1 : 0;
                    }
                }
            }
        }
    }
    EXPECT_GT(reached, 1000);
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
