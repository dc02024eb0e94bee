#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "accel/tracer.h"
#include "lines/coverage.h"
#include "render/nearest_edges.h"
#include "render/tiling_lines.h"

namespace ink::test {
namespace {

constexpr int kTries = 2000;
constexpr std::uint32_t kNone = 0xFFFFFFFFU;

/// Sixteen of few values, so that many are alike, and some are none.
Lanes<std::uint32_t> few_values(std::mt19937& random, std::uint32_t count) {
    Lanes<std::uint32_t> values;
    for (int i = 0; i < kLanes; ++i) {
        const auto value = static_cast<std::uint32_t>(random() % (count + 1));
        values[i] = value == count ? kNone : value;
    }
    return values;
}

TEST(FindStarts, MarksTheFirstOfEveryValueAndNoneBesideItsLike) {
    std::mt19937 random(1);
    for (int n = 0; n < kTries; ++n) {
        const Lanes<std::uint32_t> values = few_values(random, 1 + n % 16);
        const std::uint32_t starts = find_starts(values, kNone);
        ASSERT_EQ(starts >> kLanes, 0U);
        for (int i = 0; i < kLanes; ++i) {
            const bool marked = (starts >> i & 1U) != 0;
            if (values[i] == kNone) {
                EXPECT_FALSE(marked);
                continue;
            }
            const auto* const first = std::ranges::find(values, values[i]);
            if (first == values.begin() + i) {
                EXPECT_TRUE(marked) << "lane " << i;
            }
            const bool beside = (i % kBlockSide > 0 && values[i] == values[i - 1]) ||
                                (i >= kBlockSide && values[i] == values[i - kBlockSide]);
            if (beside) {
                EXPECT_FALSE(marked) << "lane " << i;
            }
        }
    }
}

TEST(CountChanges, ComparesEveryPointWithItsNeighboursOfTheSameObject) {
    std::mt19937 random(2);
    for (int n = 0; n < kTries; ++n) {
        const Lanes<std::uint32_t> objects = few_values(random, 1 + n % 3);
        const Lanes<std::uint32_t> primitives = few_values(random, 1 + n % 5);
        int changes = 0;
        const auto compare = [&](int i, int k) {
            if (objects[i] == kNoObject || objects[i] != objects[k]) return;
            if (primitives[i] != primitives[k]) ++changes;
        };
        for (int i = 0; i < kLanes; ++i) {
            if (i % kBlockSide + 1 < kBlockSide) compare(i, i + 1);
            if (i + kBlockSide < kLanes) compare(i, i + kBlockSide);
        }
        ASSERT_EQ(count_changes(objects, primitives), changes);
    }
}

/// In double precision, to a segment of the plane.
double distance_to(const ScreenEdge& edge, double x, double y) {
    const double rx = x - static_cast<double>(edge.a.x);
    const double ry = y - static_cast<double>(edge.a.y);
    const auto ux = static_cast<double>(edge.along.x);
    const auto uy = static_cast<double>(edge.along.y);
    const double s = std::clamp(rx * ux + ry * uy, 0.0, static_cast<double>(edge.length));
    return std::hypot(rx - s * ux, ry - s * uy);
}

TEST(FindNearest, IsTheLeastDistanceToTheEdgesOfThePixelsOwnFace) {
    constexpr float kX = 1000.5F;
    constexpr float kY = 600.5F;
    constexpr float kReach = 3.0F;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> place(-4.0F, 8.0F);
    std::uniform_real_distribution<float> angle(0.0F, 6.28F);
    for (int n = 0; n < kTries; ++n) {
        std::vector<ScreenEdge> edges;
        std::vector<SeenFace> faces;
        for (std::uint32_t f = 0; f < 4; ++f) {
            const auto first = static_cast<std::uint32_t>(edges.size());
            const auto count = static_cast<std::uint32_t>(random() % 4);  // none, too
            for (std::uint32_t k = 0; k < count; ++k) {
                const float turn = angle(random);
                edges.push_back({{kX + place(random), kY + place(random)},
                                 {std::cos(turn), std::sin(turn)},
                                 std::abs(place(random)),
                                 static_cast<float>(edges.size())});
            }
            faces.push_back({3 * f, 3 * f + 2, first, count});  // every third triangle has none
        }
        NearestEdges nearest;
        nearest.triangle = few_values(random, 12);
        Lanes<float> vx;
        Lanes<float> vy;
        find_nearest(edges, faces, kX, kY, kReach, nearest, vx, vy);
        for (int i = 0; i < kLanes; ++i) {
            const double x = static_cast<double>(kX) + i % kBlockSide;
            const double y = static_cast<double>(kY) + i / kBlockSide;
            double least = INFINITY;
            for (const SeenFace& face : faces) {
                if (nearest.triangle[i] < face.begin || nearest.triangle[i] >= face.end) continue;
                for (std::uint32_t k = face.first; k < face.first + face.count; ++k) {
                    least = std::min(least, distance_to(edges[k], x, y));
                }
            }
            ASSERT_NEAR(std::hypot(nearest.nx[i], nearest.ny[i]), 1.0F, 1e-3F);
            if (std::abs(least - static_cast<double>(kReach)) < 1e-3) continue;
            if (least > static_cast<double>(kReach)) {
                ASSERT_EQ(nearest.distance[i], kInfinity);
                continue;
            }
            ASSERT_NEAR(nearest.distance[i], least, 1e-3);
            ASSERT_NEAR(std::hypot(vx[i], vy[i]), least, 1e-3);
            const ScreenEdge& edge = edges.at(static_cast<std::size_t>(nearest.t[i]));
            ASSERT_NEAR(distance_to(edge, x, y), least, 1e-3);
        }
    }
}

TEST(TilingInk, IsTheAreaUnderABandAlongTheNearestLine) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> number(-1.0F, 1.0F);
    std::uniform_real_distribution<float> place(-3.0F, 3.0F);
    for (std::uint32_t n = 0; n < kTries; ++n) {
        TilingSpot spot{{{number(random), number(random)},
                         {number(random), number(random)},
                         {number(random), number(random)}},
                        1.0F,
                        n % 8};  // with any sides left out
        if (n % 16 == 0) spot.sides = TriangleSides::none();
        Lanes<float> x;
        Lanes<float> y;
        for (int i = 0; i < kLanes; ++i) {
            x[i] = place(random);
            y[i] = place(random);
        }
        const TilingLines lines = lines_about(spot, 4.0F);
        const float half = std::abs(number(random));
        NearestEdges nearest;
        find_nearest(lines, x, y, nearest);
        // Any of sixteen blocks, about any spot.
        const auto block = static_cast<int>(n) % kLanes;
        std::array<TilingSpot, 3> spots{spot, spot, spot};
        for (TilingSpot& other : spots) other.sides.inside = {number(random), number(random)};
        spots[n % 3] = spot;
        TilingBlocks blocks{.which = LaneBits{1} << block, .spots = {}, .off_x = {}, .off_y = &y};
        blocks.spots[block] = static_cast<std::int32_t>(n % 3);
        blocks.off_x.at(static_cast<std::size_t>(block)) = &x;
        RowBands bands{.half = {}, .opacity = 1.0F};
        bands.half[block] = half;
        std::array<Lanes<float>, kLanes> alphas{};
        ink(blocks, spots.data(), 4.0F, bands, alphas);
        const Lanes<float>& inks = alphas.at(static_cast<std::size_t>(block));
        for (int i = 0; i < kLanes; ++i) {
            const bool far = nearest.distance[i] > 1e6F;
            const float area =
                far ? 0.0F : band_coverage(nearest.distance[i], half, nearest.nx[i], nearest.ny[i]);
            EXPECT_NEAR(inks[i], area, 1e-5F);
        }
    }
}

}  // namespace
}  // namespace ink::test
