#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "lines_scenes.h"

namespace ink::test {
namespace {

// Width

class StraightLine : public testing::TestWithParam<int> {};

struct Band {
    double width = 0.0;   ///< ink per unit of length
    double offset = 0.0;  ///< of the ink's middle from the edge
};

/// Ink of a line at `angle_deg` in [0, 90], in the inner part of a tile.
Band measure(const std::vector<double>& ink, int side, double angle_deg, Vec3d through) {
    const bool flat_line = angle_deg <= 45.0;
    const double nx = std::sin(angle_deg * kDegrees);
    const double ny = -std::cos(angle_deg * kDegrees);
    constexpr int kInner = 16;
    Band band;
    double moment = 0.0;
    for (int along = side / 2 - kInner / 2; along < side / 2 + kInner / 2; ++along) {
        for (int across = 0; across < side; ++across) {
            const int x = flat_line ? along : across;
            const int y = flat_line ? across : along;
            const double alpha = ink[static_cast<std::size_t>(y * side + x)];
            band.width += alpha;
            moment += alpha * ((x + 0.5 - through.x) * nx + (y + 0.5 - through.y) * ny);
        }
    }
    band.offset = moment / band.width;
    band.width *= std::max(std::abs(nx), std::abs(ny)) / kInner;
    return band;
}

TEST_P(StraightLine, HasTheWidthThatWasAskedForAtAnyAngleAndIsCentred) {
    constexpr int kTile = 64;
    const int q = GetParam();
    double worst_width = 0.0;
    double worst_offset = 0.0;
    for (int angle_deg = 0; angle_deg <= 90; angle_deg += 3) {
        std::vector<double> offsets(6);
        for (int phase = 0; phase < 4; ++phase) {
            const Vec3d through{32.137 + phase * 0.25, 32.211 + phase * 0.75, 0};
            const World world{{flat(1, 0.0, beside(angle_deg, through))}};
            const Found found = search(world, q, kTile);
            std::size_t n = 0;
            for (const double width : {0.5, 1.0, 2.0, 3.3, 8.0, 20.0}) {
                const Band band =
                    measure(draw(found.segments, width, kTile), kTile, angle_deg, through);
                EXPECT_NEAR(band.width, width, 0.02 * width)
                    << angle_deg << " degrees, width " << width;
                worst_width = std::max(worst_width, std::abs(band.width / width - 1.0));
                offsets[n++] += band.offset / 4;
            }
        }
        // A narrow line within one row of pixels cannot show where in it it lies: the mean can.
        for (const double offset : offsets) {
            EXPECT_NEAR(offset, 0.0, 0.05) << angle_deg << " degrees";
            worst_offset = std::max(worst_offset, std::abs(offset));
        }
    }
    RecordProperty("worst_width", std::to_string(worst_width));
    RecordProperty("worst_offset", std::to_string(worst_offset));
}

INSTANTIATE_TEST_SUITE_P(OnALatticeOf, StraightLine, testing::Values(1, 2, 3, 4),
                         testing::PrintToStringParamName());

// Position

TEST(DiscOutline, LiesOnItsCircle) {
    for (const double r : {5.0, 7.3, 12.0, 20.0}) {
        for (int q = 1; q <= 4; ++q) {
            for (const Vec3d c :
                 {Vec3d{24.0, 24.0, 0}, Vec3d{24.5, 24.5, 0}, Vec3d{24.137, 23.711, 0}}) {
                const Found found = search({{flat(1, 0.0, disc(c, r))}}, q);
                ASSERT_FALSE(found.segments.empty());
                for (const Segment& s : found.segments) {
                    EXPECT_NEAR(std::hypot(s.a.x - c.x, s.a.y - c.y), r, 0.05);
                    EXPECT_NEAR(std::hypot(s.b.x - c.x, s.b.y - c.y), r, 0.05);
                    EXPECT_NEAR(std::hypot((s.a.x + s.b.x) / 2 - c.x, (s.a.y + s.b.y) / 2 - c.y), r,
                                0.1);
                }
            }
        }
    }
    const Vec3d c{50.2, 49.9, 0};
    const Found large = search({{flat(1, 0.0, disc(c, 40.0))}}, 1, 100);
    for (const Segment& s : large.segments) {
        EXPECT_NEAR(std::hypot(s.a.x - c.x, s.a.y - c.y), 40.0, 0.05);
        EXPECT_NEAR(std::hypot(s.b.x - c.x, s.b.y - c.y), 40.0, 0.05);
    }
}

TEST(DiscOutline, IsOneClosedChainAsLongAsTheCircle) {
    for (const double r : {3.0, 5.0, 7.3, 12.0, 20.0}) {
        for (int q = 1; q <= 4; ++q) {
            for (const Vec3d c :
                 {Vec3d{24.0, 24.0, 0}, Vec3d{24.5, 24.5, 0}, Vec3d{24.137, 23.711, 0}}) {
                const Found found = search({{flat(1, 0.0, disc(c, r))}}, q);
                EXPECT_EQ(unpaired_ends(found), 0) << r << ", " << q << ", " << c.x;
                EXPECT_NEAR(total_length(found), 2 * std::numbers::pi * r,
                            0.01 * 2 * std::numbers::pi * r)
                    << r << ", " << q << ", " << c.x;
                EXPECT_EQ(types(found), std::set{LineType::silhouette});
            }
        }
    }
}

TEST(Outline, HasTheGeometriesOnTheSidesThatItSays) {
    const Vec3d c{24.137, 23.711, 0};
    const World world{{flat(1, 0.0, disc(c, 12.3)), flat(2, -5.0, everywhere())}};
    for (int q = 1; q <= 4; ++q) {
        const Found found = search(world, q);
        for (const Segment& s : found.segments) {
            const double dx = (s.b.x - s.a.x) / length(s);
            const double dy = (s.b.y - s.a.y) / length(s);
            const auto probe = [&](double side) {
                // Left of (dx, dy) is (dy, -dx), as y points down.
                return world({static_cast<float>((s.a.x + s.b.x) / 2 + side * 0.2 * dy),
                              static_cast<float>((s.a.y + s.b.y) / 2 - side * 0.2 * dx)})
                    .id;
            };
            EXPECT_EQ(probe(1.0), s.left);
            EXPECT_EQ(probe(-1.0), s.right);
            EXPECT_EQ(found.grid.id[s.left_sample], s.left);
            EXPECT_EQ(found.grid.id[s.right_sample], s.right);
        }
    }
}

TEST(SphereSeam, LiesWhereTheSpheresMeet) {
    double worst_end = 0.0;
    double worst_junction = 0.0;
    for (const TwoSpheres& spheres : overlapping_spheres()) {
        const int side = static_cast<int>(4 * spheres.r) + 6;
        for (const int q : {1, 2, 4}) {
            const Found found = search(spheres.world(1.0 / side), q, side);
            for (const Segment& segment : found.segments) {
                if (!between(segment, 1, 2)) continue;
                const auto off = [&](Vec2f p) {
                    return std::min(std::abs(spheres.to_seam(p)), spheres.to_contour(p));
                };
                EXPECT_LT(off(segment.a), 0.05);
                (segment.spans_cell ? worst_end : worst_junction) =
                    std::max(segment.spans_cell ? worst_end : worst_junction, off(segment.b));
                EXPECT_LT(off(segment.b), 0.05)
                    << (segment.spans_cell ? "crossing" : "junction") << " at " << segment.b.x
                    << ", " << segment.b.y << ", r " << spheres.r << ", s " << spheres.s << ", q "
                    << q;
                // The seam's ellipse bends the most at its tips.
                EXPECT_LT(off((segment.a + segment.b) * 0.5F), q == 1 ? 0.15 : 0.1);
            }
        }
    }
    RecordProperty("worst_end", std::to_string(worst_end));
    RecordProperty("worst_junction", std::to_string(worst_junction));
}

// Small things

TEST(Wire, WiderThanTheLatticesSpacingIsTwoUnbrokenLines) {
    for (int q = 1; q <= 4; ++q) {
        for (const double ratio : {1.02, 1.1, 1.5, 2.0, 3.0}) {
            const double width = ratio / q;
            for (int angle_deg = 0; angle_deg < 180; angle_deg += 7) {
                for (const double shift : {0.0, 0.3, 0.7}) {
                    const double nx = std::sin(angle_deg * kDegrees);
                    const double ny = -std::cos(angle_deg * kDegrees);
                    const Vec3d c{24.0 + shift, 24.137 + shift, 0};
                    const World world{{flat(1, 0.0, [=](double x, double y) {
                        return std::abs((x - c.x) * nx + (y - c.y) * ny) < width / 2;
                    })}};
                    const Found found = search(world, q);
                    const auto loose = loose_ends(found);
                    EXPECT_TRUE(loose.empty()) << width << " px at " << angle_deg << " degrees, q "
                                               << q << ": " << list(loose);
                    double upper = 0.0;
                    double under = 0.0;
                    for (const Segment& s : found.segments) {
                        const double side =
                            ((s.a.x + s.b.x) / 2 - c.x) * nx + ((s.a.y + s.b.y) / 2 - c.y) * ny;
                        EXPECT_NEAR(std::abs(side), width / 2, 0.03);
                        (side > 0.0 ? upper : under) += length(s);
                    }
                    const double chord =
                        (kSide - 1.0 / q) / std::max(std::abs(std::cos(angle_deg * kDegrees)),
                                                     std::abs(std::sin(angle_deg * kDegrees)));
                    EXPECT_NEAR(upper, chord, 3.5)
                        << width << " px at " << angle_deg << ", q " << q;
                    EXPECT_NEAR(under, chord, 3.5)
                        << width << " px at " << angle_deg << ", q " << q;
                }
            }
        }
    }
}

TEST(Wire, ThinnerThanTheLatticesSpacingLeavesNoLooseEndsWhereItIsMissed) {
    for (const double width : {0.3, 0.5, 0.8}) {
        for (int angle_deg = 1; angle_deg < 90; angle_deg += 8) {
            const double nx = std::sin(angle_deg * kDegrees);
            const double ny = -std::cos(angle_deg * kDegrees);
            const World world{{flat(1, 0.0, [=](double x, double y) {
                return std::abs((x - 24.2) * nx + (y - 24.3) * ny) < width / 2;
            })}};
            const Found found = search(world, 1);
            EXPECT_TRUE(loose_ends(found).empty())
                << width << " px at " << angle_deg << ": " << list(loose_ends(found));
            for (const Segment& s : found.segments) EXPECT_EQ(s.type, LineType::silhouette);
        }
    }
}

TEST(Dust, IsClosedOutlinesWhereTheLatticeMeetsIt) {
    std::mt19937 random(4);
    const auto uniform = [&] { return static_cast<double>(random() >> 8U) * 0x1p-24; };
    for (int k = 0; k < 200; ++k) {
        const Vec3d c{24 + uniform(), 24 + uniform(), 0};
        for (int q = 1; q <= 4; ++q) {
            const Found found = search({{flat(1, 0.0, disc(c, 0.4))}}, q);
            const bool met =
                std::ranges::any_of(found.grid.id, [](GeometryId id) { return id == 1; });
            EXPECT_EQ(found.segments.empty(), !met);
            EXPECT_EQ(unpaired_ends(found), 0);
            for (const Segment& s : found.segments) {
                EXPECT_EQ(s.type, LineType::silhouette);
                EXPECT_NEAR(std::hypot(s.a.x - c.x, s.a.y - c.y), 0.4, 0.05);
            }
        }
    }
}

TEST(Dust, OnASurfaceIsClosedOutlinesToo) {
    std::mt19937 random(5);
    const auto uniform = [&] { return static_cast<double>(random() >> 8U) * 0x1p-24; };
    World world{{flat(1, -5.0, everywhere())}};
    for (GeometryId id = 2; id < 400; ++id) {
        const Vec3d c{kSide * uniform(), kSide * uniform(), 0};
        world.surfaces.push_back(flat(id, 10 * uniform(), disc(c, 0.4)));
    }
    for (int q = 1; q <= 4; ++q) {
        const Found found = search(world, q);
        const auto loose = loose_ends(found);
        EXPECT_TRUE(loose.empty()) << "q " << q << ": " << loose.size() << " of "
                                   << 2 * found.segments.size() << " ends: " << list(loose);
    }
}

// Tiles

using Key = std::tuple<float, float, float, float, LineType, float, float, GeometryId, GeometryId>;

std::vector<Key> keys(const Found& found) {
    std::vector<Key> keys;
    for (const Segment& s : found.segments) {
        keys.emplace_back(s.a.x, s.a.y, s.b.x, s.b.y, s.type, s.strength, s.t, s.left, s.right);
    }
    return keys;
}

TEST(Lines, AreTheSameHoweverTheLatticeIsCut) {
    for (unsigned seed = 0; seed < 6; ++seed) {
        World world = random_spheres(seed, 60, 0.3, 9.0);
        world.surfaces.push_back(torus(99, {20, 20, 10}, 14, 4, 60));
        std::mt19937 random(seed);
        world.surfaces.push_back(random_wedge(50, random, 1.0).world.surfaces[0]);
        for (int q = 1; q <= 4; ++q) {
            std::vector<Key> whole = keys(search(world, q, 0, 0, 48 * q, 48 * q));
            const int half = 20 * q + 1;
            std::vector<Key> parts;
            for (const auto& [i0, j0, columns, rows] :
                 {std::tuple{0, 0, half + 1, half + 1},
                  std::tuple{half, 0, 48 * q - half, half + 1},
                  std::tuple{0, half, half + 1, 48 * q - half},
                  std::tuple{half, half, 48 * q - half, 48 * q - half}}) {
                const auto part = keys(search(world, q, i0, j0, columns, rows));
                parts.insert(parts.end(), part.begin(), part.end());
            }
            std::ranges::sort(whole);
            std::ranges::sort(parts);
            EXPECT_EQ(whole.size(), parts.size()) << "seed " << seed << ", q " << q;
            EXPECT_TRUE(whole == parts) << "seed " << seed << ", q " << q;
        }
    }
}

/// Another surface behind a pinhole in the nearer one, just where a lattice point looks.
TEST(Speck, ThatOneRayAloneSeesHasNoLine) {
    const Vec3d hole{20.5, 24.5, 0};
    const auto holed = [&](Surface surface) {
        return Surface{surface.id, [=](double x, double y) -> std::optional<Hit> {
                           if (std::hypot(x - hole.x, y - hole.y) < 0.004) return std::nullopt;
                           return surface.at(x, y);
                       }};
    };
    const Surface front = holed(plane(1, {24, 24, 0}, {0.1, 0.2, 1}));
    for (const GeometryId id : {1U, 2U}) {
        const Surface behind = plane(id, {24, 24, -5}, {0.1, 0.2, 1});
        EXPECT_TRUE(search({{front, behind}}, 1).segments.empty());
    }
    EXPECT_TRUE(search({{front}}, 1).segments.empty());
}

/// A crack in the nearer surface, narrower than lattice points are apart but met by some of them.
TEST(Slit, NarrowerThanAQuarterOfTheLatticesSpacingHasNoLine) {
    const auto slit_between = [](double angle_deg, double width) {
        const double nx = std::sin(angle_deg * kDegrees);
        const double ny = -std::cos(angle_deg * kDegrees);
        return [=](double x, double y) {
            return std::abs((x - 24.5) * nx + (y - 24.5) * ny) < 0.5 * width;
        };
    };
    for (const double angle : {0.0, 17.0, 45.0, 71.0}) {
        const auto cracked = [&](double width) {
            const Region crack = slit_between(angle, width);
            const Surface whole = plane(1, {24, 24, 0}, {0.1, 0.2, 1});
            return Surface{1, [=](double x, double y) -> std::optional<Hit> {
                               if (crack(x, y)) return std::nullopt;
                               return whole.at(x, y);
                           }};
        };
        for (const GeometryId id : {1U, 2U}) {
            const Surface behind = plane(id, {24, 24, -9}, {0, 0.3, 1});
            EXPECT_TRUE(search({{cracked(0.1), behind}}, 1).segments.empty()) << angle;
            EXPECT_GT(total_length(search({{cracked(1.5), behind}}, 1)), 80.0) << angle;
        }
        EXPECT_TRUE(search({{cracked(0.1)}}, 1).segments.empty()) << angle;
        // A facet of another direction at the same depth.
        const Surface whole = plane(1, {24, 24, 0}, {0.1, 0.2, 1});
        const Surface turned{1, [=](double x, double y) -> std::optional<Hit> {
                                 return Hit{whole.at(x, y)->z - 0.003, {0.1, 0.9, 1}};
                             }};
        EXPECT_TRUE(search({{cracked(0.1), turned}}, 1).segments.empty()) << angle;
    }
}

/// A narrow ledge between two walls that are seen at a flat angle and all but parallel: the one
/// behind the other leaves its plane by little, and is far from it.
TEST(Slit, IsNoneBetweenWallsBehindEachOtherAtAFlatAngle) {
    const auto wall = [](double through, double z, double facing_deg, double turned_deg) {
        const double a = facing_deg * kDegrees;
        const double b = turned_deg * kDegrees;
        return plane(1, {through, 24, z},
                     {std::cos(a) * std::cos(b), std::cos(a) * std::sin(b), std::sin(a)});
    };
    const Surface front = wall(23.8, 0, 1.2, 0);
    const Surface ledge = plane(1, {24, 24, -8}, {0, 0, 1});
    const Surface back = wall(24.02, -8, 0.9, 2.5);
    const Surface floor = plane(1, {24, 24, -13}, {0, 0, 1});
    const Surface step{
        1, [=](double x, double y) -> std::optional<Hit> {
            if (x < 22.7) return std::nullopt;
            return (x < 23.8 ? front : x < 24.02 ? ledge : x < 24.1 ? back : floor).at(x, y);
        }};
    Found found = search({{step}}, 1);
    std::erase_if(found.segments, [](const Segment& s) { return s.a.x < 23.0F; });
    EXPECT_GT(total_length(found), 40.0);
}

/// What meets in the depth of such a crack, next to a lattice point that looks into it, is not
/// drawn either: it would be a dot.
TEST(Slit, HasNoDotWhereTwoWallsMeetInIt) {
    const Surface whole = plane(1, {24, 24, 0}, {0.1, 0.2, 1});
    for (const double angle : {0.0, 17.0, 45.0, 71.0}) {
        for (const double off : {0.0, 0.004, 0.01, 0.02}) {
            const double nx = std::sin(angle * kDegrees);
            const double ny = -std::cos(angle * kDegrees);
            // A steep groove, the bottom of which is sharp.
            constexpr double kHalf = 0.05;
            const Surface grooved{1, [=](double x, double y) -> std::optional<Hit> {
                                      const double across = (x - 24.5) * nx + (y - 24.5) * ny;
                                      Hit hit = *whole.at(x, y);
                                      if (std::abs(across) > kHalf) return hit;
                                      const bool down = across < off;
                                      const double slope =
                                          1.0 / (down ? -off - kHalf : kHalf - off);
                                      hit.z += slope * across - (down ? -kHalf : kHalf) * slope;
                                      hit.normal = {-slope * nx, slope * ny, 1.0};
                                      return hit;
                                  }};
            const Found found = search({{grooved}}, 1);
            EXPECT_TRUE(found.segments.empty()) << angle << ", " << off << list(loose_ends(found));
        }
    }
}

}  // namespace
}  // namespace ink::test
