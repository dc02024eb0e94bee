#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include "instruction_sets.h"
#include "lines/coverage.h"
#include "lines_scenes.h"

namespace ink::test {
namespace {

// Coverage

TEST(SquareCoverage, IsTheAreaOfThePixelBesideTheLine) {
    constexpr int kRows = 1000;
    for (int angle_deg = 0; angle_deg < 360; angle_deg += 7) {
        const double nx = std::cos(angle_deg * kDegrees);
        const double ny = std::sin(angle_deg * kDegrees);
        for (int step = -20; step <= 20; ++step) {
            const double inside = step * 0.05;
            double area = 0.0;
            for (int row = 0; row < kRows; ++row) {
                const double y = (row + 0.5) / kRows - 0.5;
                // Inner side: nx x + ny y < inside.
                const double rest = inside - ny * y;
                const double share =
                    std::abs(nx) < 1e-9 ? (rest > 0.0 ? 1.0 : 0.0) : rest / std::abs(nx) + 0.5;
                area += std::clamp(share, 0.0, 1.0) / kRows;
            }
            EXPECT_NEAR(square_coverage(static_cast<float>(inside), static_cast<float>(nx),
                                        static_cast<float>(ny)),
                        area, 1.5e-3)
                << angle_deg << " degrees, " << inside;
        }
    }
}

TEST(BandCoverage, AddsUpToTheBandsWidthAcrossTheLine) {
    for (const double width : {0.01, 0.3, 0.5, 1.0, 2.0, 3.3, 8.0, 20.0}) {
        for (int angle_deg = 0; angle_deg < 360; ++angle_deg) {
            const double nx = std::cos(angle_deg * kDegrees);
            const double ny = std::sin(angle_deg * kDegrees);
            for (const double offset : {0.0, 0.137, 0.5, 0.77}) {
                // A column of pixels if the line is flat, else a row.
                const double step = std::max(std::abs(nx), std::abs(ny));
                double sum = 0.0;
                for (int i = -40; i <= 40; ++i) {
                    const double signed_distance = i * step + offset;
                    // As the line is drawn: the normal points from it to the pixel.
                    const float side = signed_distance < 0.0 ? -1.0F : 1.0F;
                    sum +=
                        band_coverage(static_cast<float>(std::abs(signed_distance)),
                                      static_cast<float>(width / 2), side * static_cast<float>(nx),
                                      side * static_cast<float>(ny));
                }
                EXPECT_NEAR(sum * step, width, 1e-4) << angle_deg << " degrees, " << offset;
            }
        }
    }
}

// Ink

TEST(Ink, OfTheNearerLineLiesOnTop) {
    InkSettings settings;
    settings.styles.assign(kLineTypes, {3.0F, {1, 0, 0}, 1.0F});
    settings.styles[static_cast<std::size_t>(LineType::crease)].color = {0, 0, 1};
    Segment near_line{{2, 8.5F}, {14, 8.5F}};
    near_line.t = 1.0F;
    Segment far_line{{8.5F, 2}, {8.5F, 14}};
    far_line.t = 2.0F;
    for (const bool crease_in_front : {false, true}) {
        (crease_in_front ? near_line : far_line).type = LineType::crease;
        (crease_in_front ? far_line : near_line).type = LineType::silhouette;
        for (const bool near_first : {false, true}) {
            InkTile tile(settings);
            tile.begin(0, 0, 16, 16);
            tile.draw(near_first ? near_line : far_line);
            tile.draw(near_first ? far_line : near_line);
            tile.finish();
            const std::size_t k = tile.index(8, 8);
            EXPECT_FLOAT_EQ(tile.alpha()[k], 1.0F);
            EXPECT_FLOAT_EQ(tile.color()[0][k], crease_in_front ? 0.0F : 1.0F);
            EXPECT_FLOAT_EQ(tile.color()[2][k], crease_in_front ? 1.0F : 0.0F);
        }
    }
}

TEST(Ink, OfThreeCrossingLinesIsLaidFrontToBack) {
    InkSettings settings;
    settings.styles.assign(kLineTypes, {40.0F, {1, 0, 0}, 0.5F});
    settings.styles[1].color = {0, 1, 0};
    settings.styles[2].color = {0, 0, 1};
    for (const std::array<int, 3> order :
         {std::array{0, 1, 2}, std::array{2, 0, 1}, std::array{1, 2, 0}, std::array{2, 1, 0}}) {
        InkTile tile(settings);
        tile.begin(0, 0, 16, 16);
        for (const int k : order) {
            Segment line{{0, 8}, {16, 8}};
            line.type = static_cast<LineType>(k);
            line.t = std::array{2.0F, 3.0F, 1.0F}[static_cast<std::size_t>(k)];
            tile.draw(line);
        }
        tile.finish();
        const std::size_t k = tile.index(8, 8);
        // The third type is nearest, then the first, then the second.
        EXPECT_FLOAT_EQ(tile.color()[2][k], 0.5F);
        EXPECT_FLOAT_EQ(tile.color()[0][k], 0.25F);
        EXPECT_FLOAT_EQ(tile.color()[1][k], 0.125F);
        EXPECT_FLOAT_EQ(tile.alpha()[k], 0.875F);
    }
}

TEST(Ink, IsTheSameOnAnyTile) {
    const Found found = search(random_spheres(1, 40, 2.0, 9.0), 2);
    for (const double width : {0.5, 3.0, 11.0}) {
        const std::vector<double> whole = draw(found.segments, width);
        InkSettings settings;
        settings.styles.assign(kLineTypes, {static_cast<float>(width), {0, 0, 0}, 1.0F});
        InkTile tile(settings);
        for (const auto& [x0, y0, w, h] :
             {std::tuple{0, 0, 20, 48}, std::tuple{20, 0, 28, 7}, std::tuple{20, 7, 28, 41}}) {
            tile.begin(x0, y0, w, h);
            for (const Segment& segment : found.segments) tile.draw(segment);
            tile.finish();
            for (int y = 0; y < h; ++y) {
                for (int x = 0; x < w; ++x) {
                    const double alpha = tile.empty() ? 0.0 : tile.alpha()[tile.index(x, y)];
                    EXPECT_EQ(alpha, whole[static_cast<std::size_t>((y0 + y) * kSide + x0 + x)]);
                }
            }
        }
    }
}

TEST(Ink, OfOneLineIsTheSameWhateverOtherInksAreOnTheTile) {
    InkSettings settings;
    settings.styles.assign(kLineTypes, {2.7F, {0.3F, 0.6F, 0.1F}, 0.7F});
    settings.styles[static_cast<std::size_t>(LineType::crease)].color = {0, 0, 1};
    Segment line{{1.3F, 2.1F}, {14.6F, 9.2F}};
    line.type = LineType::silhouette;
    Segment other{{1, 28}, {14, 30}};
    other.type = LineType::crease;
    InkTile alone(settings);
    alone.begin(0, 0, 16, 32);
    alone.draw(line);
    alone.finish();
    InkTile both(settings);
    both.begin(0, 0, 16, 32);
    both.draw(line);
    both.draw(other);
    both.finish();
    ASSERT_TRUE(alone.uniform_color() && !both.uniform_color());
    for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 16; ++x) {
            const std::size_t k = alone.index(x, y);
            EXPECT_EQ(both.alpha()[k], alone.alpha()[k]);
            EXPECT_EQ(both.color()[1][k], alone.alpha()[k] * 0.6F);
        }
    }
}

/// However it is inked: narrow or wide, on one row of pixels or many.
TEST(Ink, OfAStrokeIsTheAreaUnderItsBandOnEveryInstructionSet) {
    on_every_instruction_set([] {
        for (const double width : {0.4, 1.0, 2.0, 3.0, 5.0, 9.0, 15.9, 16.1, 21.0}) {
            for (int angle_deg = 0; angle_deg < 180; angle_deg += 17) {
                const Vec2f along{static_cast<float>(std::cos(angle_deg * kDegrees)),
                                  static_cast<float>(std::sin(angle_deg * kDegrees))};
                const Vec2f middle{24.3F, 23.6F};
                const float reach = 9.0F;  // to either end
                const std::vector<double> ink =
                    draw({{middle - along * reach, middle + along * reach}}, width);
                for (int k = 0; k < kSide * kSide; ++k) {
                    const Vec2f place{static_cast<float>(k % kSide) + 0.5F,
                                      static_cast<float>(k / kSide) + 0.5F};
                    const Vec2f way = place - middle;
                    const float beside = std::abs(way.x * along.y - way.y * along.x);
                    const double own = ink[static_cast<std::size_t>(k)];
                    if (std::abs(way.x * along.x + way.y * along.y) < reach) {
                        EXPECT_NEAR(own,
                                    band_coverage(beside, 0.5F * static_cast<float>(width), along.y,
                                                  along.x),
                                    1e-5)
                            << width << " px, " << angle_deg << " degrees, pixel " << k;
                    } else if (length(way) > reach + 0.5 * width + 0.75) {
                        EXPECT_EQ(own, 0.0);
                    }
                }
            }
        }
    });
}

TEST(Ink, OfACircleIsItsLengthTimesTheWidth) {
    const Vec3d c{24.137, 23.711, 0};
    for (const int q : {1, 2, 4}) {
        for (const double r : {3.0, 5.0, 10.0, 18.0}) {
            const Found found = search({{flat(1, 0.0, disc(c, r))}}, q);
            for (const double width : {0.5, 1.0, 2.0, 3.0, 5.5}) {
                double sum = 0.0;
                for (const double alpha : draw(found.segments, width)) sum += alpha;
                const double area = 2 * std::numbers::pi * r * width;
                EXPECT_NEAR(sum, area, 0.015 * area) << r << ", width " << width << ", q " << q;
            }
        }
    }
}

TEST(Ink, OfADotIsADiscOfTheLinesWidth) {
    for (const double width : {2.0, 3.3, 8.0, 20.0}) {
        for (const double shift : {0.0, 0.3, 0.5}) {
            const auto at = static_cast<float>(24 + shift);
            const std::vector<double> ink = draw({{{at, at}, {at, at}}}, width);
            double sum = 0.0;
            for (const double alpha : ink) sum += alpha;
            const double area = std::numbers::pi * width * width / 4;
            // Each pixel takes the disc's rim to be straight.
            EXPECT_NEAR(sum, area, 0.01 * area + 0.25) << width;
        }
    }
}

TEST(Ink, OfFacesLeavesPixelsFarFromTheirEdgesBelowOutlines) {
    InkSettings settings;
    settings.styles.assign(kLineTypes, {2.0F, {0, 0, 0}, 1.0F});
    const auto mesh = static_cast<std::size_t>(LineType::mesh);
    settings.styles[mesh].color = {1, 0, 0};
    InkTile tile(settings);
    tile.begin(0, 0, 8, 8);
    // A line between faces and an outline in front of it, at one place.
    tile.draw({.a = {0, 2}, .b = {8, 2}, .type = LineType::mesh, .t = 1.0F});
    tile.draw({.a = {0, 2}, .b = {8, 2}, .type = LineType::silhouette, .t = 1.0F});
    const NearestLines far{Lanes<float>::filled(kInfinity), {}, {}, {}};
    tile.draw_faces(0, 0, far, Lanes<float>::filled(1.0F), mesh, 2.0F);
    tile.finish();
    ASSERT_FALSE(tile.uniform_color());
    EXPECT_EQ(tile.color()[0][tile.index(2, 2)], 0.0F);
}

}  // namespace
}  // namespace ink::test
