#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <set>
#include <tuple>

#include "lines_scenes.h"

namespace ink::test {
namespace {

// Types

TEST(SphereSeam, IsAnIntersectionAndAContourASilhouette) {
    for (const TwoSpheres& spheres : overlapping_spheres()) {
        const int side = static_cast<int>(4 * spheres.r) + 6;
        for (const int q : {1, 2, 4}) {
            const Found found = search(spheres.world(1.0 / side), q, side);
            for (const Segment& segment : found.segments) {
                if (!between(segment, 1, 2)) {
                    EXPECT_EQ(segment.type, LineType::silhouette);
                    continue;
                }
                const double seam = std::abs(spheres.to_seam(segment.a));
                const double contour = spheres.to_contour(segment.a);
                if (seam < 0.2 && contour < 0.2) continue;  // where one turns into the other
                EXPECT_EQ(segment.type,
                          seam < contour ? LineType::intersection : LineType::silhouette)
                    << segment.a.x << ", " << segment.a.y << ": seam " << seam << " contour "
                    << contour << ", r " << spheres.r << ", s " << spheres.s << ", d.z "
                    << spheres.d.z << ", q " << q;
            }
        }
    }
}

TEST(SphereSeam, SeenFromTheSideIsAnIntersectionFromContourToContour) {
    for (const double r : {5.0, 10.0, 20.0}) {
        for (const double overlap : {0.02, 0.1, 0.5, 1.0}) {
            for (int angle_deg = 0; angle_deg < 90; angle_deg += 11) {
                const Vec3d c{2 * r + 4.137, 2 * r + 3.711, 0};
                const double apart = r * (2.0 - overlap) / 2.0;
                const Vec3d half{apart * std::cos(angle_deg * kDegrees),
                                 apart * std::sin(angle_deg * kDegrees), 0};
                const World world{{sphere(1, c - half, r), sphere(2, c + half, r)}, 0.25 / r};
                const int side = static_cast<int>(4 * r) + 8;
                const Found found = search(world, 1, side);
                std::size_t seam = 0;
                std::size_t wrong = 0;
                for (const Segment& segment : found.segments) {
                    if (!between(segment, 1, 2)) continue;
                    ++seam;
                    wrong += segment.type == LineType::intersection ? 0 : 1;
                }
                EXPECT_LE(wrong, 1U) << "r " << r << ", overlap " << overlap << ", " << angle_deg
                                     << " degrees";  // of a seam that is a pixel long
                if (overlap * r > 1.0) {
                    EXPECT_GT(seam, 0U);
                }
            }
        }
    }
}

TEST(GapOfOnePercentBetweenSpheres, IsASilhouette) {
    for (const double r : {20.0, 50.0, 120.0, 250.0, 500.0}) {
        for (const double ratio : {0.5, 1.0, 2.0, 4.0}) {
            for (const double lean_deg : {20.0, 40.0, 60.0, 70.0, 80.0, 85.0}) {
                for (const double turn_deg : {0.0, 33.0}) {
                    // The front sphere's contour, where it is nearest to the sphere behind, is in
                    // the middle of the tile.
                    const Vec3d aside{std::cos(turn_deg * kDegrees), std::sin(turn_deg * kDegrees),
                                      0};
                    const Vec3d c = Vec3d{24.137, 23.711, 0} - aside * r;
                    const double apart = r * (1.0 + ratio + 0.01);
                    Vec3d d = c + aside * (apart * std::sin(lean_deg * kDegrees));
                    d.z = -apart * std::cos(lean_deg * kDegrees);
                    const World world{{sphere(1, c, r), sphere(2, d, r * ratio)},
                                      0.25 / (r * std::max(ratio, 1.0))};
                    for (const int q : {1, 3}) {
                        const Found found = search(world, q);
                        for (const Segment& segment : found.segments) {
                            EXPECT_EQ(segment.type, LineType::silhouette)
                                << segment.a.x << ", " << segment.a.y << ", r " << r << ", ratio "
                                << ratio << ", lean " << lean_deg << ", turn " << turn_deg << ", q "
                                << q;
                        }
                    }
                }
            }
        }
    }
}

TEST(ContourInFrontOfAPlate, IsASilhouetteAtAnyGapThatCanBeSeen) {
    for (const double r : {20.0, 50.0, 120.0, 250.0, 500.0}) {
        for (const double gap : {0.02, 0.05, 0.1, 0.3}) {
            for (const int q : {1, 4}) {
                std::size_t wrong = 0;
                std::size_t all = 0;
                for (int angle_deg = 0; angle_deg < 360; angle_deg += 20) {
                    const Vec3d c{24.137 - r * std::cos(angle_deg * kDegrees),
                                  23.711 - r * std::sin(angle_deg * kDegrees), 0};
                    // The plate cuts the sphere a little behind its equator.
                    const Found found = search(
                        {{sphere(1, c, r), plane(2, {24, 24, -gap * r}, {0, 0, 1})}, 0.5 / r}, q);
                    wrong += count(found, LineType::intersection);
                    all += found.segments.size();
                }
                // A gap of less than a pixel behind a contour can still pass for contact.
                EXPECT_LE(wrong, gap * r < 2.5 ? all / 100 : 0U)
                    << "of " << all << " segments: radius " << r << " px, gap " << gap
                    << " of it, q " << q;
            }
        }
    }
}

TEST(SphereSunkIntoAPlate, MeetsItInAnIntersection) {
    for (const double r : {10.0, 20.0, 120.0, 500.0}) {
        // Nearer to the equator the plate touches the contour, and both types are right.
        for (const double above_equator : {0.05, 0.2, 0.5, 0.9}) {
            for (int angle_deg = 0; angle_deg < 360; angle_deg += 40) {
                const double ring = r * std::sqrt(1.0 - above_equator * above_equator);
                const Vec3d c{24.137 - ring * std::cos(angle_deg * kDegrees),
                              23.711 - ring * std::sin(angle_deg * kDegrees), 0};
                const Found found = search(
                    {{sphere(1, c, r), plane(2, {24, 24, above_equator * r}, {0, 0, 1})}, 0.5 / r},
                    1);
                EXPECT_EQ(types(found), std::set{LineType::intersection})
                    << r << ", " << above_equator;
            }
        }
    }
}

TEST(SmoothSurface, HasNoLineButItsOutline) {
    for (const double r : {1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 24.0, 100.0, 1000.0, 10000.0}) {
        for (const int q : {1, 2, 4}) {
            for (int angle_deg = 0; angle_deg < 360; angle_deg += 40) {
                // The contour is in the middle of the tile, or the whole sphere in the tile.
                const double back = r > 20.0 ? r : 0.0;
                const Vec3d c{24.137 - back * std::cos(angle_deg * kDegrees),
                              23.711 - back * std::sin(angle_deg * kDegrees), 0};
                const Found found = search({{sphere(1, c, r)}, 0.5 / std::max(r, 20.0)}, q);
                EXPECT_EQ(types(found), std::set{LineType::silhouette}) << r << ", " << q;
            }
        }
    }
}

TEST(Torus, HasSelfOcclusionsWhereItHidesItselfAndNeverACrease) {
    for (const double tube : {1.0, 2.0, 4.0, 8.0, 100.0, 1000.0, 10000.0}) {
        const double ring = 2.5 * tube;
        for (const double tilt_deg : {0.0, 20.0, 45.0, 60.0, 75.0, 90.0}) {
            for (const int q : {1, 2}) {
                // Small ones whole; of large ones, parts where the hole's rim is seen.
                for (const double shift : {0.0, 0.35, 0.6, 1.0, 1.4}) {
                    if (tube < 10.0 && shift > 0.0) continue;
                    const double away = tube < 10.0 ? 0.0 : shift * ring;
                    const Vec3d c{24.137 + away * 0.8,
                                  23.711 + away * 0.6 * (tilt_deg < 50 ? 1 : 0), 0};
                    const World world{{torus(1, c, ring, tube, tilt_deg)},
                                      0.4 / std::max(ring, 10.0)};
                    const Found found = search(world, q);
                    EXPECT_EQ(count(found, LineType::crease), 0U)
                        << "tube " << tube << ", tilt " << tilt_deg << ", q " << q << ", shift "
                        << shift;
                    EXPECT_EQ(count(found, LineType::intersection), 0U);
                    if (tilt_deg == 0.0) {
                        EXPECT_EQ(count(found, LineType::self_occlusion), 0U) << tube;
                    }
                    if (tilt_deg == 60.0 && tube >= 2.0 && tube < 10.0) {
                        EXPECT_GT(count(found, LineType::self_occlusion), 0U) << tube;
                    }
                }
            }
        }
    }
}

TEST(Torus, ShowsEveryPlaceWhereItHidesItself) {
    for (const double tube : {2.0, 4.0, 8.0}) {
        for (const double tilt_deg : {45.0, 60.0, 75.0, 85.0}) {
            const World world{{torus(1, {24.137, 23.711, 0}, 2.5 * tube, tube, tilt_deg)},
                              0.4 / (2.5 * tube + 5)};
            const Found found = search(world, 1);
            const SampleGrid& grid = found.grid;
            const auto z = [&](Vec2f p) { return -world(p).t / world.unit; };
            int missed = 0;
            int jumps = 0;
            for (int j = 0; j + 1 < grid.height; ++j) {
                for (int i = 0; i + 1 < grid.width; ++i) {
                    for (const bool down : {false, true}) {
                        const Vec2f a = grid.point(i, j);
                        const Vec2f b = down ? grid.point(i, j + 1) : grid.point(i + 1, j);
                        if (grid.id[grid.index(i, j)] == kBackground ||
                            world(b).id == kBackground || std::abs(z(a) - z(b)) < 0.5) {
                            continue;
                        }
                        // The surface alone rises by less than 0.3 px in a hundredth of a pixel.
                        double jump = 0.0;
                        bool gap = false;
                        for (int k = 0; k < 400; ++k) {
                            const Vec2f p = a + (b - a) * (static_cast<float>(k) / 400);
                            const Vec2f next = a + (b - a) * (static_cast<float>(k + 1) / 400);
                            gap |= world(next).id == kBackground;
                            jump = std::max(jump, std::abs(z(next) - z(p)));
                        }
                        if (gap || jump < 1.0) continue;
                        ++jumps;
                        const bool shown =
                            std::ranges::any_of(found.crossings, [&](const Crossing& crossing) {
                                const SuspectEdge& edge = found.suspects[crossing.edge];
                                return edge.i == i && edge.j == j && edge.down == down &&
                                       crossing.type == LineType::self_occlusion;
                            });
                        missed += shown ? 0 : 1;
                    }
                }
            }
            // At either end of the line, where the jump fades out, its sides are as steep as each
            // other.
            EXPECT_LE(missed, 2) << "of " << jumps << " jumps of more than a pixel: tube " << tube
                                 << ", tilt " << tilt_deg;
        }
    }
}

TEST(Step, IsASelfOcclusion) {
    for (int angle_deg = 0; angle_deg < 180; angle_deg += 15) {
        const Vec3d through{24.137, 23.711, 0};
        const Region front = beside(angle_deg, through);
        for (const double height : {1.0, 3.0, 20.0, 1000.0}) {
            for (const Vec3d normal : {Vec3d{0, 0, 1}, Vec3d{0.5, 0.3, 1}, Vec3d{-0.8, 1.5, 1}}) {
                const Surface ground = plane(1, {24, 24, 0}, normal);
                const Surface step{1, [=](double x, double y) {
                                       auto hit = ground.at(x, y);
                                       if (front(x, y)) hit->z += height;
                                       return hit;
                                   }};
                for (const int q : {1, 2, 4}) {
                    const Found found = search({{step}, 0.5 / std::max(height, 32.0)}, q);
                    EXPECT_EQ(types(found), std::set{LineType::self_occlusion})
                        << angle_deg << ", height " << height << ", q " << q << ", normal "
                        << normal.x;
                    // Its whole length, and nothing twice.
                    const Found outline = search({{flat(1, 0.0, front)}}, q);
                    EXPECT_NEAR(total_length(found), total_length(outline), 0.5)
                        << angle_deg << ", height " << height << ", q " << q << ", normal "
                        << normal.x;
                    EXPECT_TRUE(loose_ends(found).empty());
                }
            }
        }
    }
}

// Creases

TEST(Crease, HasAStrengthThatGrowsWithItsAngleAlone) {
    std::mt19937 random(1);
    for (const auto& [angle_deg, least, most] :
         {std::tuple{5.0, 0.0, 0.0}, std::tuple{20.0, 0.2, 0.9}, std::tuple{60.0, 1.0, 1.0},
          std::tuple{90.0, 1.0, 1.0}}) {
        std::optional<float> strength;
        for (int k = 0; k < 60; ++k) {
            const double unit = std::pow(10.0, -k % 4) / 64;
            const Wedge wedge = random_wedge(angle_deg, random, unit);
            for (int q = 1; q <= 4; ++q) {
                const Found found = search(wedge.world, q);
                if (most == 0.0) {
                    EXPECT_TRUE(found.segments.empty()) << angle_deg;
                    continue;
                }
                EXPECT_EQ(types(found), std::set{LineType::crease})
                    << angle_deg << " degrees, q " << q << ", normals " << wedge.first.x << ","
                    << wedge.first.y << "," << wedge.first.z << " and " << wedge.second.x << ","
                    << wedge.second.y << "," << wedge.second.z << ", unit " << unit;
                EXPECT_TRUE(loose_ends(found).empty()) << list(loose_ends(found));
                for (const Segment& segment : found.segments) {
                    EXPECT_GE(segment.strength, least);
                    EXPECT_LE(segment.strength, most);
                    if (!strength) strength = segment.strength;
                    EXPECT_NEAR(segment.strength, *strength, 1e-3F);
                }
            }
        }
    }
}

TEST(Crease, RunsAlongTheWedgesEdge) {
    std::mt19937 random(2);
    for (const double angle_deg : {20.0, 60.0, 90.0}) {
        for (int k = 0; k < 40; ++k) {
            const Wedge wedge = random_wedge(angle_deg, random, 1.0 / 64);
            for (int q = 1; q <= 4; ++q) {
                const Found found = search(wedge.world, q);
                // The line through the tile is at least as long as the part of the tile's middle
                // row or column that it must cross.
                EXPECT_GT(total_length(found), kSide - 6.0);
                for (const Segment& segment : found.segments) {
                    for (const Vec2f p : {segment.a, segment.b}) {
                        // Both faces are at the same height there: the heights' difference over its
                        // gradient.
                        const Vec3d g{
                            wedge.first.x / wedge.first.z - wedge.second.x / wedge.second.z,
                            wedge.first.y / wedge.first.z - wedge.second.y / wedge.second.z, 0};
                        const auto z = [&](Vec2f at) {
                            const Vec3f n = wedge.world(at).normal;
                            return std::abs(dot(to_double(n), wedge.first) - 1.0) < 1e-4;
                        };
                        // On either side, within 0.05 px, lies the other face.
                        const double size = std::hypot(g.x, g.y);
                        const Vec2f step{static_cast<float>(0.05 * g.x / size),
                                         static_cast<float>(-0.05 * g.y / size)};
                        EXPECT_NE(z(p + step), z(p - step)) << p.x << ", " << p.y;
                    }
                }
            }
        }
    }
}

}  // namespace
}  // namespace ink::test
