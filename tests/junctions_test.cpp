#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "lines_scenes.h"

namespace ink::test {
namespace {

// Junctions

/// Three regions of different ID that meet at a point, at the same depth or one before the others.
World three_regions(Vec3d at, double turn_deg, double first_height) {
    const auto sector = [=](double from_deg, double to_deg) -> Region {
        return [=](double x, double y) {
            double angle = std::atan2(y - at.y, x - at.x) / kDegrees - turn_deg;
            while (angle < 0.0) angle += 360.0;
            return angle >= from_deg && angle < to_deg;
        };
    };
    return {{flat(1, first_height, sector(0, 120)), flat(2, 0.0, sector(120, 240)),
             flat(3, 0.0, sector(240, 360))}};
}

constexpr int kNear = 16;  ///< side of the tile about a junction, pixels

void expect_no_gap_at(const World& world, Vec3d at, const std::string& what) {
    for (int q = 1; q <= 4; ++q) {
        const Found found = search(world, q, kNear);
        const auto loose = loose_ends(found);
        EXPECT_TRUE(loose.empty()) << what << ", q " << q << ": " << list(loose);
        const std::vector<double> ink = draw(found.segments, 3.0, kNear);
        const auto x = static_cast<std::size_t>(at.x);
        const auto y = static_cast<std::size_t>(at.y);
        EXPECT_NEAR(ink[y * kNear + x], 1.0, 1e-5) << what << ", q " << q;
    }
}

std::vector<std::pair<Vec3d, double>> junction_places() {
    std::mt19937 random(3);
    std::vector<std::pair<Vec3d, double>> places;
    for (int k = 0; k < 60; ++k) {
        const auto uniform = [&] { return static_cast<double>(random() >> 8U) * 0x1p-24; };
        const double x = kNear / 2 + uniform();
        const double y = kNear / 2 + uniform();
        places.push_back({{x, y, 0}, 360 * uniform()});
    }
    return places;
}

TEST(Junction, OfThreeRegionsHasNoGap) {
    for (const auto& [at, turn_deg] : junction_places()) {
        expect_no_gap_at(three_regions(at, turn_deg, 0.0), at, "Y at " + std::to_string(at.x));
        expect_no_gap_at(three_regions(at, turn_deg, 9.0), at, "raised at " + std::to_string(at.x));
    }
}

TEST(Junction, OfFourRegionsHasNoGap) {
    for (const auto& [at, turn_deg] : junction_places()) {
        const Region a = beside(turn_deg, at);
        const Region b = beside(turn_deg + 90.0, at);
        World checkerboard;
        World quarters;
        for (int k = 0; k < 4; ++k) {
            const Region quarter = [=](double x, double y) {
                return a(x, y) == (k / 2 == 0) && b(x, y) == (k % 2 == 0);
            };
            checkerboard.surfaces.push_back(
                flat(static_cast<GeometryId>(k / 2 == k % 2 ? 1 : 2), 0.0, quarter));
            quarters.surfaces.push_back(flat(static_cast<GeometryId>(k + 1), 0.0, quarter));
        }
        const std::string place = std::to_string(at.x) + ", " + std::to_string(at.y) + " turned " +
                                  std::to_string(turn_deg);
        expect_no_gap_at(quarters, at, "four IDs at " + place);
        expect_no_gap_at(checkerboard, at, "two IDs at " + place);
    }
}

TEST(Junction, WhereALineGoesBehindASurfaceHasNoGap) {
    for (const auto& [at, turn_deg] : junction_places()) {
        for (const double meeting_deg : {25.0, 60.0, 90.0, 130.0}) {
            const World world{{flat(1, 9.0, beside(turn_deg, at)),
                               flat(2, 0.0, beside(turn_deg + meeting_deg, at)),
                               flat(3, -9.0, everywhere())}};
            expect_no_gap_at(world, at,
                             "T at " + std::to_string(at.x) + ", " + std::to_string(at.y) +
                                 " turned " + std::to_string(turn_deg) + " by " +
                                 std::to_string(meeting_deg));
            const World before_nothing{{world.surfaces[0], world.surfaces[1]}};
            expect_no_gap_at(before_nothing, at, "T before background");
        }
    }
}

TEST(Lines, OfManySpheresHaveNoLooseEnds) {
    std::size_t loose = 0;
    std::size_t segments = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
        for (int q = 1; q <= 4; ++q) {
            const Found found = search(random_spheres(seed, 40, 2.0, 9.0), q);
            const auto ends = loose_ends(found);
            EXPECT_TRUE(ends.empty()) << "seed " << seed << ", q " << q << ": " << list(ends);
            loose += ends.size();
            segments += found.segments.size();
        }
    }
    RecordProperty("loose", std::to_string(loose) + " of " + std::to_string(2 * segments));
}

TEST(Lines, OfManySpheresLieWhereTheIdChanges) {
    // Each segment has what it says on its two sides, where no third surface is near.
    for (unsigned seed = 0; seed < 10; ++seed) {
        const World world = random_spheres(seed, 40, 2.0, 9.0);
        for (int q = 1; q <= 4; ++q) {
            const Found found = search(world, q);
            std::size_t wrong = 0;
            std::size_t checked = 0;
            for (const Segment& s : found.segments) {
                EXPECT_NE(s.left, s.right);
                EXPECT_LE(length(s), 1.5 / q);
                if (!s.spans_cell || length(s) < 0.1) continue;
                const double dx = (s.b.x - s.a.x) / length(s);
                const double dy = (s.b.y - s.a.y) / length(s);
                const auto probe = [&](double along, double side) {
                    return world({static_cast<float>((s.a.x + s.b.x) / 2 + along * dx + side * dy),
                                  static_cast<float>((s.a.y + s.b.y) / 2 + along * dy - side * dx)})
                        .id;
                };
                bool alone = true;
                for (int k = 0; k < 24; ++k) {
                    const double angle = k * 15 * kDegrees;
                    for (const double r : {0.15, 0.3, 0.6}) {
                        const GeometryId id = probe(r * std::cos(angle), r * std::sin(angle));
                        alone &= id == s.left || id == s.right;
                    }
                }
                if (!alone) continue;
                ++checked;
                wrong += probe(0, 0.15) == s.left && probe(0, -0.15) == s.right ? 0 : 1;
            }
            // Small spheres bend by a tenth of a pixel within a cell of one pixel.
            EXPECT_LE(static_cast<double>(wrong),
                      (q == 1 ? 0.02 : 0.005) * static_cast<double>(checked))
                << "seed " << seed << ", q " << q << ", of " << checked;
        }
    }
}

}  // namespace
}  // namespace ink::test
