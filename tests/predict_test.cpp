#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "lines/edge_balls.h"
#include "lines/predict_lanes.h"
#include "lines_world.h"
#include "sampling/surface_key.h"

namespace ink::test {
namespace {

// Spheres that the samples tell of

TEST(PredictedOutline, LiesOnItsCircle) {
    const World world{{sphere(1, {24.3, 23.6, 0}, 17.4)}, 1.0 / 64, true};
    const Found found = search(world, 1);
    ASSERT_GT(found.crossings.size(), 50U);
    for (const Crossing& c : found.crossings) {
        EXPECT_NEAR(std::hypot(c.point.x - 24.3, c.point.y - 23.6), 17.4, 2e-3);
    }
}

TEST(PredictedSeam, LiesWhereTheSpheresMeet) {
    // Radii 20 and 15, centres 20 apart on screen and 5 in depth.
    const Vec3d a{15, 24, 0};
    const Vec3d b{35, 24, 5};
    const World world{{sphere(1, a, 20), sphere(2, b, 15)}, 1.0 / 64, true};
    const Found found = search(world, 1);
    std::size_t seams = 0;
    for (const Crossing& c : found.crossings) {
        if (c.type != LineType::intersection) continue;
        ++seams;
        const double xa = c.point.x - a.x;
        const double xb = c.point.x - b.x;
        const double y = c.point.y - 24.0;
        const double za = a.z + std::sqrt(400.0 - xa * xa - y * y);
        const double zb = b.z + std::sqrt(225.0 - xb * xb - y * y);
        const double slope = std::abs(xa / (za - a.z) - xb / (zb - b.z)) + 1e-3;
        EXPECT_LT(std::abs(za - zb) / slope, 0.01);
    }
    EXPECT_GT(seams, 15U);
}

TEST(PredictedContour, IsASilhouetteHoweverLittleItStandsOut) {
    for (const double gap : {3.0, 1.0, 0.3, 0.1, 0.03, 0.01}) {
        // The contour of the first sphere, at depth 0, is `gap` in front of the second's face.
        const World world{
            {sphere(1, {24, 24, 0}, 12), sphere(2, {24, 24, -400 - gap}, std::hypot(400.0, 12.0))},
            1.0 / 512,
            true};
        for (const Crossing& c : search(world, 1).crossings) {
            EXPECT_EQ(c.type, LineType::silhouette) << gap;
        }
    }
}

TEST(PredictedCrossings, TakeOneSampleEach) {
    const World world{{sphere(1, {20, 24, 0}, 15), sphere(2, {32, 22, 3}, 12)}, 1.0 / 64, true};
    const Found found = search(world, 1);
    EXPECT_GT(found.crossings.size(), 80U);
    EXPECT_LE(found.samples, found.crossings.size());
}

TEST(PredictedCrossings, OfSmallSpheresTakeNoSample) {
    const World world{{sphere(1, {20, 24, 0}, 5), sphere(2, {26, 22, 3}, 6)}, 1.0 / 64, true};
    const Found found = search(world, 1);
    EXPECT_GT(found.crossings.size(), 30U);
    EXPECT_EQ(found.samples, 0U);
}

TEST(PredictedCrossings, AreThoseThatBisectionFinds) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(0.0, kSide);
    World world;
    for (GeometryId id = 1; id <= 40; ++id) {
        const double x = place(random);
        const double y = place(random);
        world.surfaces.push_back(sphere(id, {x, y, place(random)}, 11.0));
    }
    const Found bisected = search(world, 1);
    world.knows_balls = true;
    const Found predicted = search(world, 1);
    std::size_t apart = 0;
    for (const Crossing& p : predicted.crossings) {
        const bool same = std::ranges::any_of(bisected.crossings, [&](const Crossing& c) {
            return c.edge == p.edge && c.first == p.first && c.second == p.second &&
                   distance(c.point, p.point) < 1.0 / 64;
        });
        apart += same ? 0 : 1;
    }
    EXPECT_GT(predicted.crossings.size(), 400U);
    // Slivers within one lattice edge may be seen by one and missed by the other.
    EXPECT_LE(apart, predicted.crossings.size() / 100);
    EXPECT_LT(2 * predicted.samples, bisected.samples);
}

/// What the ray through a screen point sees of some balls, from nearby and in perspective.
Sample see(const Viewpoint& viewpoint, const std::vector<Ball>& balls, Vec2f point) {
    const Vec3d origin = viewpoint.origin(point);
    const Vec3d direction = normalize(viewpoint.direction(point));
    Sample sample;
    double nearest = 1e30;
    for (std::size_t k = 0; k < balls.size(); ++k) {
        const Vec3d to_centre = to_double(balls[k].centre) - origin;
        const double along = dot(to_centre, direction);
        const double radius = balls[k].radius;
        const double inside = radius * radius - dot(to_centre, to_centre) + along * along;
        if (inside <= 0.0 || along - std::sqrt(inside) >= nearest) continue;
        nearest = along - std::sqrt(inside);
        sample.id = static_cast<GeometryId>(k + 1);
        sample.ball = balls[k];
        sample.t = static_cast<float>(nearest);
    }
    return sample;
}

TEST(PredictedLanes, SayWhatIsPredictedOfOneEdgeAtATime) {
    Viewpoint viewpoint;
    viewpoint.eye = {0, 0, -1};
    viewpoint.origin = {{-0.5, 0.5, 0}, {1.0 / 64, 0, 0}, {0, -1.0 / 64, 0}};
    viewpoint.direction = {{-0.5, 0.5, 1}, {1.0 / 64, 0, 0}, {0, -1.0 / 64, 0}};
    std::mt19937 random(3);
    std::uniform_real_distribution<float> place(-0.6F, 0.6F);
    std::uniform_real_distribution<float> size(0.02F, 0.3F);
    std::array<int, 6> seen{};
    for (int round = 0; round < 200; ++round) {
        std::vector<Ball> balls;
        for (int k = 0; k < 8; ++k) {
            const float x = place(random);
            const float y = place(random);
            balls.push_back({{x, y, 0.8F + 0.3F * place(random)}, size(random)});
        }
        EdgeLanes lanes{};
        std::vector<std::optional<Prediction>> alone;
        for (int tries = 0; alone.size() < kLanes && tries < 5000; ++tries) {
            const Vec2f a{32.0F + 40.0F * place(random), 32.0F + 40.0F * place(random)};
            const bool down = random() % 2 == 0;
            const Vec2f b{a.x + (down ? 0.0F : 1.0F), a.y + (down ? 1.0F : 0.0F)};
            const Sample at_a = see(viewpoint, balls, a);
            const Sample at_b = see(viewpoint, balls, b);
            if (at_a.ball == at_b.ball) continue;
            const auto lane = static_cast<int>(alone.size());
            alone.push_back(predict_crossing(viewpoint, a, at_a, b, at_b));
            lanes.ax[lane] = a.x;
            lanes.ay[lane] = a.y;
            lanes.bx[lane] = b.x;
            lanes.by[lane] = b.y;
            const auto put = [&](const Sample& sample, BallLanes& to) {
                to.x[lane] = sample.ball.centre.x;
                to.y[lane] = sample.ball.centre.y;
                to.z[lane] = sample.ball.centre.z;
                to.radius[lane] = sample.ball.radius;
                to.t[lane] = sample.t;
            };
            put(at_a, lanes.first);
            put(at_b, lanes.second);
        }
        PredictionLanes together;
        predict_crossings(viewpoint, lanes, together);
        for (int lane = 0; lane < static_cast<int>(alone.size()); ++lane) {
            const std::optional<Prediction>& one = alone[static_cast<std::size_t>(lane)];
            const std::int32_t kind = together.kind[lane];
            ++seen[static_cast<std::size_t>(kind + 2)];
            if (kind == PredictionLanes::kSearch) continue;
            EXPECT_EQ(kind, one ? static_cast<std::int32_t>(one->kind) : PredictionLanes::kNone);
            if (!one || kind < 0) continue;
            EXPECT_NEAR(together.at[lane], one->at, 1e-6);
            EXPECT_NEAR(together.t[lane], one->t, 1e-6);
            EXPECT_NEAR(together.squared_radius[lane], one->squared_radius,
                        1e-5F * one->squared_radius);
        }
    }
    // Contours on both sides, seams, and few that must be searched.
    EXPECT_GT(seen[2], 500);
    EXPECT_GT(seen[3], 500);
    EXPECT_GT(seen[4], 200);
    EXPECT_LT(seen[0], 50);
}

TEST(PredictedSeam, WithinOneGeometryIsACrease) {
    const World world{{sphere(1, {15, 24, 0}, 20), sphere(1, {35, 24, 5}, 15)}, 1.0 / 64, true};
    const Found found = search(world, 1);
    EXPECT_GT(count(found, LineType::crease), 15U);
    EXPECT_EQ(count(found, LineType::intersection), 0U);
}

TEST(BallTable, TellsOfEdgesWhatTheirEndsSaw) {
    std::mt19937 random(5);
    const std::vector<float> balls = [&] {
        std::vector<float> numbers(4 * 50);
        for (float& number : numbers) number = static_cast<float>(random() % 1000) / 7.0F;
        return numbers;
    }();
    const BallTable table{3, 11, balls.data()};
    SampleGrid grid;
    grid.x0 = -4;
    grid.y0 = 60;
    grid.spacing = 0.5F;
    grid.resize(33, 9);
    for (std::size_t k = 0; k < grid.id.size(); ++k) {
        const auto ball = static_cast<GeometryId>(random() % 50);
        grid.id[k] = random() % 4 == 0 ? kBackground : table.first + ball;
        grid.t[k] = static_cast<float>(k);
    }
    std::vector<SuspectEdge> edges;
    for (std::uint16_t j = 0; j < 8; ++j) {
        for (std::uint16_t i = 0; i < 32; ++i) {
            edges.push_back({i, j, random() % 2 == 0, Suspicion::id});
        }
    }
    for (const std::size_t count : {1U, 5U, 16U}) {
        for (std::size_t first = 0; first + count <= edges.size(); first += count) {
            EdgeLanes lanes;
            EdgeEnds from;
            EdgeEnds to;
            find_edge_balls(grid, std::span(edges).subspan(first, count), table, lanes, from, to);
            for (std::size_t n = 0; n < count; ++n) {
                const SuspectEdge& edge = edges[first + n];
                const auto lane = static_cast<int>(n);
                const auto expect = [&](int i, int j, float x, float y, const BallLanes& seen,
                                        const EdgeEnds& ends) {
                    const std::size_t k = grid.index(i, j);
                    const bool hit = grid.id[k] != kBackground;
                    const std::size_t ball = hit ? grid.id[k] - 11 : 0;
                    EXPECT_EQ(x, grid.point(i, j).x);
                    EXPECT_EQ(y, grid.point(i, j).y);
                    EXPECT_EQ(ends.id[lane], grid.id[k]);
                    EXPECT_EQ(ends.object[lane], hit ? 3U : SurfaceKey{}.object);
                    EXPECT_EQ(ends.primitive[lane], ball);
                    EXPECT_EQ(seen.x[lane], hit ? balls[4 * ball] : 0.0F);
                    EXPECT_EQ(seen.y[lane], hit ? balls[4 * ball + 1] : 0.0F);
                    EXPECT_EQ(seen.z[lane], hit ? balls[4 * ball + 2] : 0.0F);
                    EXPECT_EQ(seen.radius[lane], hit ? balls[4 * ball + 3] : 0.0F);
                    EXPECT_EQ(seen.t[lane], hit ? grid.t[k] : 0.0F);
                };
                expect(edge.i, edge.j, lanes.ax[lane], lanes.ay[lane], lanes.first, from);
                expect(edge.i + (edge.down ? 0 : 1), edge.j + (edge.down ? 1 : 0), lanes.bx[lane],
                       lanes.by[lane], lanes.second, to);
            }
        }
    }
}

}  // namespace
}  // namespace ink::test
