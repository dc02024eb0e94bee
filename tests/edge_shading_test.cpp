#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "drawing.h"
#include "edges_view.h"
#include "lines/coverage.h"
#include "scenes.h"

namespace ink::test {
namespace {

// Shading

TEST(EdgeSmoothing, GivesAPixelTheMeanOfItsTwoSidesByArea) {
    for (const int q : {1, 2, 3, 4}) {
        double worst = 0.0;
        for (double angle_deg = 0.0; angle_deg < 360.0; angle_deg += 7.5) {
            const Vec3d shift{0.137, 0.211, 0};
            Object object = half_plane(angle_deg, 300);
            object.material.color = {255, 255, 255};
            Settings settings = plan_view({32, 32});
            settings.compose = Compose::shaded;
            settings.shading.mode = ShadeMode::flat;
            settings.shading.background = {0, 0, 0};
            settings.aa = AntiAliasing{AntiAliasing::Kind::edges, 1};
            settings.lattice = q;
            const Film film = draw(Scene(placed({object}, 1.0, shift)), settings, {false, true});
            const double nx = -std::sin(angle_deg * kDegrees);
            const double ny = std::cos(angle_deg * kDegrees);
            for (int y = 0; y < 32; ++y) {
                for (int x = 0; x < 32; ++x) {
                    const double inside =
                        (x + 0.5 - 16 - shift.x) * nx + (16 - y - 0.5 - shift.y) * ny;
                    const double area = square_coverage(
                        static_cast<float>(inside), static_cast<float>(nx), static_cast<float>(ny));
                    const double grey = plane(film, "R")[at({32, 32}, x, y)];
                    EXPECT_NEAR(grey, area, 0.02)
                        << angle_deg << " degrees, q " << q << ", at " << x << ", " << y;
                    worst = std::max(worst, std::abs(grey - area));
                }
            }
        }
        RecordProperty("worst_" + std::to_string(q), std::to_string(worst));
    }
}

TEST(EdgeSmoothing, KeepsTheAreaOfADisc) {
    for (const int q : {1, 2, 4}) {
        for (const double radius : {2.0, 5.0, 12.3}) {
            Settings settings = plan_view({32, 32});
            settings.compose = Compose::shaded;
            settings.shading.transparent_background = true;
            settings.lattice = q;
            const Scene scene(placed({sphere_object({{{0, 0, 0}, static_cast<float>(radius)}})},
                                     1.0, {0.137, 0.211, 0}));
            const Film film = draw(scene, settings, {false, true});
            double area = 0.0;
            for (const float alpha : plane(film, "A")) area += alpha;
            EXPECT_NEAR(area, std::numbers::pi * radius * radius,
                        0.65 / (q * q) + 0.1)  // chords cut off pi / 6 at a spacing of 1
                << radius << ", q " << q;
        }
    }
}

TEST(EdgeSmoothing, LeavesPixelsAwayFromLinesAsTheyAre) {
    const Scene scene = acetaminophen();
    Settings settings;
    settings.size = {96, 96};
    settings.aovs = {Aov::lines};
    settings.line_width = {4, Length::Unit::px};
    const Film with_lines = draw(scene, settings);
    settings.compose = Compose::shaded;
    settings.aa = AntiAliasing{AntiAliasing::Kind::none, 1};
    const Film plain = draw(scene, settings);
    settings.aa = AntiAliasing{AntiAliasing::Kind::edges, 1};
    const Film smooth = draw(scene, settings);
    int changed = 0;
    for (std::size_t k = 0; k < plain.display().pixels.size(); ++k) {
        if (plain.display().pixels[k] == smooth.display().pixels[k]) continue;
        ++changed;
        EXPECT_GT(plane(with_lines, "line.A")[k], 0.9F);
    }
    EXPECT_GT(changed, 100);
}

// Compositing

TEST(LinesAlone, OnATransparentGroundAreAsOpaqueAsTheirCoverage) {
    const Scene scene(random_objects(5, 60, 40));
    Settings settings;
    settings.size = {90, 70};
    settings.view.view = View::front;
    settings.compose = Compose::lines;
    settings.shading.transparent_background = true;
    settings.line_color = {200, 30, 10};
    settings.aovs = {Aov::lines};
    for (const int q : {1, 2}) {
        settings.lattice = q;
        const Film film = draw(scene, settings);
        for (std::size_t k = 0; k < film.display().pixels.size(); ++k) {
            const std::uint32_t pixel = film.display().pixels[k];
            const float coverage = plane(film, "line.A")[k];
            EXPECT_NEAR(static_cast<float>(pixel >> 24U), 255.0F * coverage, 0.51F);
            if (pixel >> 24U < 4U) continue;
            EXPECT_NEAR(static_cast<int>(pixel & 0xFFU), 200, 1);
            EXPECT_NEAR(static_cast<int>(pixel >> 8U & 0xFFU), 30, 1);
            EXPECT_NEAR(static_cast<int>(pixel >> 16U & 0xFFU), 10, 1);
        }
    }
}

TEST(LinesAlone, AreThoseDrawnOverTheShading) {
    const Scene scene(random_objects(5, 60, 40));
    Settings settings;
    settings.size = {90, 70};
    settings.view.view = View::front;
    settings.aovs = {Aov::lines};
    const Film both = draw(scene, settings);
    settings.compose = Compose::lines;
    const Film alone = draw(scene, settings);
    EXPECT_EQ(plane(both, "line.A"), plane(alone, "line.A"));
    for (std::size_t k = 0; k < alone.display().pixels.size(); ++k) {
        const float expected = 255.0F * (1.0F - plane(alone, "line.A")[k]);
        EXPECT_NEAR(static_cast<float>(alone.display().pixels[k] & 0xFFU), expected, 0.51F);
    }
}

TEST(LineTypes, AreDrawnAsAskedFor) {
    const Scene scene({sphere_object({{{-8, 0, 0}, 12}, {{8, 0, 0}, 12}})});
    Settings settings = plan_view({64, 48});
    const auto ink = [&](std::string_view lines, int x, int y) {
        set(settings, "lines", lines);
        return plane(draw(scene, settings), "line.A")[at({64, 48}, x, y)];
    };
    // The seam is at x = 32, the outline's left end at 12.
    EXPECT_FLOAT_EQ(ink("silhouette", 32, 24), 0.0F);
    EXPECT_FLOAT_EQ(ink("silhouette", 12, 24), 1.0F);
    EXPECT_FLOAT_EQ(ink("intersection", 32, 24), 1.0F);
    EXPECT_FLOAT_EQ(ink("intersection", 12, 24), 0.0F);
    EXPECT_FLOAT_EQ(ink("crease,self-occlusion", 32, 24), 0.0F);
    EXPECT_FLOAT_EQ(ink("crease,self-occlusion", 12, 24), 0.0F);
    EXPECT_FLOAT_EQ(ink("none", 12, 24), 0.0F);
    EXPECT_FLOAT_EQ(ink("all", 32, 24), 1.0F);
    EXPECT_FLOAT_EQ(ink("all", 12, 24), 1.0F);
}

/// A box with sides of 20 that lies in the view of its parallel projection.
Object box() {
    std::vector<Vec3f> corners;
    for (int k = 0; k < 8; ++k) {
        corners.push_back({k & 1 ? 10.0F : -10.0F, k & 2 ? 10.0F : -10.0F, k & 4 ? 10.0F : -10.0F});
    }
    return mesh_object(corners, {{0, 2, 1},
                                 {1, 2, 3},
                                 {4, 5, 6},
                                 {5, 7, 6},
                                 {0, 1, 4},
                                 {1, 5, 4},
                                 {2, 6, 3},
                                 {3, 6, 7},
                                 {0, 4, 2},
                                 {2, 4, 6},
                                 {1, 3, 5},
                                 {3, 7, 5}});
}

TEST(Box, HasCreasesAtItsThreeInnerEdgesAndASilhouetteAroundThem) {
    for (const double fov_deg : {0.0, 5.0, 60.0}) {
        Settings settings;
        settings.size = {96, 96};
        settings.view.view = View::iso;
        settings.aovs = {Aov::lines};
        if (fov_deg == 0.0) settings.view.orthographic = 48.0;
        if (fov_deg > 0.0) settings.view.fov_deg = fov_deg;
        settings.line_width = {2, Length::Unit::px};
        for (const int q : {1, 2, 3}) {
            settings.lattice = q;
            const auto total = [&](std::string_view lines) {
                set(settings, "lines", lines);
                double sum = 0.0;
                const Film film = draw(Scene({box()}), settings);
                for (const float alpha : plane(film, "line.A")) sum += alpha;
                return sum;
            };
            EXPECT_EQ(total("self-occlusion"), 0.0) << fov_deg << ", q " << q;
            EXPECT_EQ(total("intersection"), 0.0);
            if (fov_deg > 0.0) continue;
            // Each edge of a cube seen along its diagonal is sqrt(2 / 3) as long.
            const double edge = 20 * std::sqrt(2.0 / 3.0) * 96 / 48;
            EXPECT_NEAR(total("silhouette"), 6 * edge * 2, 6) << "q " << q;
            EXPECT_NEAR(total("crease"), 3 * edge * 2, 6) << "q " << q;
        }
    }
}

}  // namespace
}  // namespace ink::test
