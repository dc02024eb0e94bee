#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "lines_world.h"

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

TEST(PredictedLimb, IsASilhouetteHoweverLittleItStandsOut) {
    for (const double gap : {3.0, 1.0, 0.3, 0.1, 0.03, 0.01}) {
        // The limb of the first sphere, at depth 0, is `gap` in front of the second's face.
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

TEST(PredictedSeam, WithinOneGeometryIsACrease) {
    const World world{{sphere(1, {15, 24, 0}, 20), sphere(1, {35, 24, 5}, 15)}, 1.0 / 64, true};
    const Found found = search(world, 1);
    EXPECT_GT(count(found, LineType::crease), 15U);
    EXPECT_EQ(count(found, LineType::intersection), 0U);
}

}  // namespace
}  // namespace ink::test
