#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "drawing.h"
#include "edges_view.h"
#include "lines/density.h"
#include "scenes.h"

/// Lines denser than they are wide, and outlines of what is hardly wider than they are.
namespace ink::test {
namespace {

/// Spheres side by side in a square of 120 x 120.
Scene packed_spheres() {
    std::mt19937 random(3);
    std::vector<Sphere> spheres;
    for (int k = 0; k < 20000; ++k) {
        const Vec3f p = uniform_point(random) - Vec3f{0.5F, 0.5F, 0.5F};
        spheres.push_back({{p.x * 120.0F, p.y * 120.0F, p.z * 4.0F}, 1.2F});
    }
    return Scene({sphere_object(spheres)});
}

/// Of packed spheres where a square of 100 x 100 of them takes `side` pixels; the middle of it,
/// which looks like all of it, where that is large.
Plane<float> ink_of_packed_spheres(int side, double density, double width_px = 3.0) {
    static const Scene scene = packed_spheres();
    const bool all = side <= 300;
    const int shown = all ? side : side / 2;
    Settings settings = plan_view({shown, shown}, width_px);
    settings.view.orthographic = all ? 100.0 : 50.0;
    settings.line_density = density;
    return plane(draw(scene, settings), "line.A");
}

TEST(DenseLines, BecomeAToneHoweverSmallThePicture) {
    double before = 0.0;
    for (const int side : {600, 400, 280, 200, 140, 100, 70, 50, 35}) {
        const double tone = mean(ink_of_packed_spheres(side, Settings{}.line_density));
        EXPECT_LT(tone, 0.4) << side;
        EXPECT_GT(tone, 0.15) << side;
        // No step in tone between pictures of similar size.
        EXPECT_NEAR(tone, before > 0.0 ? before : tone, 0.12) << side;
        before = tone;
    }
    EXPECT_GT(mean(ink_of_packed_spheres(100, 1.0)), 0.95);
}

TEST(DenseLines, KeepTheirWidthWhereThereIsRoom) {
    const Plane<float> sparse = ink_of_packed_spheres(1400, 0.75, 1.5);
    EXPECT_EQ(sparse, ink_of_packed_spheres(1400, 1.0, 1.5));
}

TEST(DenseLines, LeaveABundleOfThreeTheirWidth) {
    for (const float width : {2.0F, 3.0F, 8.0F}) {
        LineDensity density(0, 0, 1000, 1000, width);
        for (int line = 0; line < 3; ++line) {
            const float y = 500.0F + 2.0F * width * static_cast<float>(line);
            for (int x = 0; x < 1000; ++x) density.add({static_cast<float>(x), y}, 1.0F, width);
        }
        density.finish();
        const auto most = static_cast<float>(Settings{}.line_density);
        for (int y = 450; y < 600; ++y) {
            const float share = density.at({500.0F, static_cast<float>(y)});
            EXPECT_GT(width_scale(share, most), 0.99F) << width << " " << y;
        }
    }
}

// Small things

double sum_of_ink(std::vector<Object> objects, const Settings& settings) {
    const Plane<float> ink = plane(draw(Scene(std::move(objects)), settings), "line.A");
    return mean(ink) * settings.size.width * settings.size.height;
}

/// Of one ball, in a picture where it stands alone.
double ink_of_ball(double diameter_px, const Settings& settings) {
    const auto radius = static_cast<float>(diameter_px / 2.0);
    return sum_of_ink({sphere_object({{{0.3F, 0.2F, 0.0F}, radius}})}, settings);
}

TEST(SmallThings, HaveOutlinesThatCoverNoMoreOfABallThanLinesMay) {
    Settings settings = plan_view({64, 64}, 3.0);
    settings.line_density = 0.4;
    for (const double diameter : {5.0, 8.0, 12.0, 20.0, 40.0}) {
        // Half of the outline lies on the ball: 2 w / d of its area.
        const double width = std::min(3.0, 0.4 * diameter / 2.0);
        const double band = std::numbers::pi * diameter * width;
        EXPECT_NEAR(ink_of_ball(diameter, settings), band, 0.05 * band) << diameter;
    }
}

TEST(SmallThings, HaveOutlinesThatCoverNoMoreOfAStickThanLinesMay) {
    Settings settings = plan_view({64, 64}, 3.0);
    settings.line_density = 0.4;
    for (const double diameter : {2.0, 4.0, 6.0, 12.0, 20.0}) {
        Object stick;
        stick.name = "stick";
        stick.kind = ObjectKind::shape;
        Glyphs glyphs;
        glyphs.shape = {.kind = GlyphKind::frustum, .capped = false};
        glyphs.placements.push_back(
            placement_between({-100.0, 0.3, 0.0}, {100.0, 0.3, 0.0}, diameter / 2.0));
        stick.shape = std::move(glyphs);
        const double width = std::min(3.0, 0.4 * diameter);
        EXPECT_NEAR(sum_of_ink({stick}, settings), 2.0 * 64.0 * width, 0.02 * 128.0 * width)
            << diameter;
    }
}

TEST(SmallThings, AreOutlinedInFullWhereLinesMayCoverAll) {
    Settings settings = plan_view({64, 64}, 3.0);
    settings.line_density = 1.0;
    const double area = std::numbers::pi * (5.5 * 5.5 - 2.5 * 2.5);
    EXPECT_NEAR(ink_of_ball(8.0, settings), area, 0.05 * area);
}

TEST(SmallThings, GetThinnerOutlinesTheFartherAwayTheyAre) {
    Settings settings = plan_view({128, 64}, 3.0);
    settings.view.orthographic.reset();
    settings.line_density = 0.4;
    // One ball, 8 pixels wide, and the same twice as far away.
    const double height = 64.0 / (2.0 * std::tan(15.0 * kDegrees));
    settings.view.eye = Vec3d{0, 0, height};
    const std::vector<Sphere> balls{{{-32.0F, 0.0F, 0.0F}, 4.0F},
                                    {{64.0F, 0.0F, static_cast<float>(-height)}, 4.0F}};
    const double near_width = 0.4 * 8.0 / 2.0;
    const double bands = std::numbers::pi * (8.0 * near_width + 4.0 * near_width / 2.0);
    EXPECT_NEAR(sum_of_ink({sphere_object(balls)}, settings), bands, 0.1 * bands);
}

TEST(SmallThings, OfOneChainKeepItsOutline) {
    Settings settings = plan_view({64, 64}, 3.0);
    settings.line_density = 0.4;
    settings.ids = IdLevel::object;
    const double area = std::numbers::pi * (5.5 * 5.5 - 2.5 * 2.5);
    EXPECT_NEAR(ink_of_ball(8.0, settings), area, 0.05 * area);
}

}  // namespace
}  // namespace ink::test
