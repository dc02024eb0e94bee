#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "lines_world.h"

namespace ink::test {
namespace {

// Where a surface turns away from the viewer

/// The upper half of a prism about a horizontal axis through (0, c.y, c.z), as a mesh of a round
/// bar shows it: flat facets, 20 degrees wide, and normals interpolated between their edges. The
/// facet at its contour begins `contour_deg` above the horizon and ends it at x = c.x.
Surface bar(GeometryId id, Vec3d c, double radius, double contour_deg, double turn_deg) {
    const double cosine = std::cos(turn_deg * kDegrees);
    const double sine = std::sin(turn_deg * kDegrees);
    return {id, [=](double x, double y) -> std::optional<Hit> {
                const double across = (x - c.x) * cosine + (y - c.y) * sine;
                for (double from = contour_deg; from < 180.0; from += 20.0) {
                    const auto edge = [&](double deg) {
                        return Vec3d{
                            radius * (std::cos(deg * kDegrees) - std::cos(contour_deg * kDegrees)),
                            0,
                            radius * (std::sin(deg * kDegrees) - std::sin(contour_deg * kDegrees))};
                    };
                    const Vec3d low = edge(from);
                    const Vec3d high = edge(from + 20.0);
                    if (across > low.x || across <= high.x) continue;
                    const double s = (across - low.x) / (high.x - low.x);
                    const auto turned = [&](double deg) {
                        const double out = std::cos(deg * kDegrees);
                        return Vec3d{out * cosine, -out * sine, std::sin(deg * kDegrees)};
                    };
                    Hit hit{c.z + low.z + s * (high.z - low.z),
                            turned(from) * (1.0 - s) + turned(from + 20.0) * s};
                    hit.facet = turned(from + 10.0);
                    return hit;
                }
                return std::nullopt;
            }};
}

TEST(ContourOfAMesh, InFrontOfAPlateIsASilhouetteAtAnyGapThatCanBeSeen) {
    std::size_t wrong = 0;
    std::size_t all = 0;
    for (const double radius : {20.0, 60.0, 300.0}) {
        for (const double contour_deg : {-9.0, -5.0, -1.0, 3.0}) {
            for (const double turn_deg : {0.0, 27.0, 45.0, 131.0}) {
                for (const double gap : {0.05, 0.1, 0.3, 0.9}) {
                    const World world{{bar(1, {24.137, 23.711, 0}, radius, contour_deg, turn_deg),
                                       plane(2, {24.137, 23.711, -gap}, {0, 0, 1})},
                                      0.5 / radius};
                    const Found found = search(world, 1);
                    wrong += count(found, LineType::intersection);
                    all += found.segments.size();
                }
            }
        }
    }
    EXPECT_GT(all, 5000U);
    EXPECT_EQ(wrong, 0U) << "of " << all;
}

TEST(ContourOfAMesh, ThatRunsIntoAPlateIsAnIntersection) {
    for (const double radius : {20.0, 60.0, 300.0}) {
        for (const double turn_deg : {0.0, 27.0, 45.0, 131.0}) {
            for (const double sunk : {0.1, 0.3, 0.9}) {
                // The plate is hit by the last facet, in the middle of the tile.
                const double slope = std::tan(85.0 * kDegrees);
                const Vec3d at{24.137 + std::cos(turn_deg * kDegrees) * sunk,
                               23.711 + std::sin(turn_deg * kDegrees) * sunk, -sunk * slope};
                const World world{
                    {bar(1, at, radius, -5.0, turn_deg), plane(2, {24, 24, 0}, {0, 0, 1})},
                    0.5 / radius};
                const Found found = search(world, 1);
                EXPECT_EQ(types(found), std::set{LineType::intersection})
                    << radius << ", " << turn_deg << ", " << sunk;
            }
        }
    }
}

}  // namespace
}  // namespace ink::test
