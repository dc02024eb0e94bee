// Materials, lights and shadows.

#include "shading/shading.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "drawing.h"
#include "render/settings.h"
#include "scenes.h"

namespace ink::test {
namespace {

/// Orthographic, straight on, one scene unit a pixel, the origin in the middle of the picture.
Settings plan_view(Size size) {
    Settings settings;
    settings.size = size;
    settings.view.eye = Vec3d{0, 0, 10};
    settings.view.look_at = Vec3d{0, 0, 0};
    settings.view.up = Vec3d{0, 1, 0};
    settings.view.orthographic = static_cast<double>(size.height);
    settings.threads = 1;
    settings.lines = {};
    return settings;
}

Settings with(Settings settings, std::string_view name, std::string_view value) {
    find_setting(name).set(settings, value);
    return settings;
}

/// Red, green and blue of a pixel, 0 to 255.
std::array<int, 3> pixel(const Film& film, int x, int y) {
    const DisplayImage& image = film.display();
    const std::uint32_t rgba =
        image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(film.size().width) +
                     static_cast<std::size_t>(x)];
    return {static_cast<int>(rgba & 0xFFU), static_cast<int>(rgba >> 8U & 0xFFU),
            static_cast<int>(rgba >> 16U & 0xFFU)};
}

int brightest(const Film& film) {
    int most = 0;
    for (int y = 0; y < film.size().height; ++y) {
        for (int x = 0; x < film.size().width; ++x) most = std::max(most, pixel(film, x, y)[1]);
    }
    return most;
}

std::vector<Object> grey_ball() {
    std::vector<Object> objects{sphere_object({{{0, 0, 0}, 20}})};
    objects[0].material.color = {60, 60, 60};
    return objects;
}

TEST(Materials, ShowHighlightsAsBrightAsTheyAreStrong) {
    const Scene scene(grey_ball());
    Settings settings = plan_view({48, 48});
    settings.shading.background = {0, 0, 0};
    int before = brightest(draw(scene, settings));
    for (const char* specular : {"specular=0.3", "specular=0.6", "specular=1"}) {
        const int now = brightest(draw(scene, with(settings, "material", specular)));
        EXPECT_GT(now, before + 20) << specular;
        before = now;
    }
}

TEST(Materials, HaveWiderHighlightsTheRougherTheyAre) {
    const Scene scene(grey_ball());
    Settings settings = plan_view({48, 48});
    settings.shading.background = {0, 0, 0};
    const auto bright_pixels = [&](const char* material) {
        const Film film = draw(scene, with(settings, "material", material));
        int count = 0;
        for (int y = 0; y < 48; ++y) {
            for (int x = 0; x < 48; ++x) count += pixel(film, x, y)[1] > 120 ? 1 : 0;
        }
        return count;
    };
    const int narrow = bright_pixels("specular=1,roughness=0.2");
    EXPECT_GT(narrow, 0);
    EXPECT_GT(bright_pixels("specular=1,roughness=0.5"), 3 * narrow);
}

TEST(Materials, OfMetalReflectInTheirOwnColor) {
    const Scene scene(grey_ball());
    const Settings settings = plan_view({48, 48});
    const Film film =
        draw(scene, with(settings, "material", "color=#c08020,metal=1,specular=0.8,roughness=0.4"));
    for (int y = 12; y < 36; ++y) {
        for (int x = 12; x < 36; ++x) {
            const auto [r, g, b] = pixel(film, x, y);
            ASSERT_GE(r, g);
            ASSERT_GE(g, b);
        }
    }
}

TEST(Materials, AreForTheObjectThatIsNamedOrCounted) {
    std::vector<Object> objects{sphere_object({{{-12, 0, 0}, 10}}),
                                sphere_object({{{12, 0, 0}, 10}})};
    objects[1].name = "right";
    const Scene scene(std::move(objects));
    const Settings settings = plan_view({48, 32});
    for (const char* target : {"2", "right"}) {
        const Film film =
            draw(scene, with(settings, "material", std::string(target) + ":color=red"));
        EXPECT_EQ(pixel(film, 12, 16)[0], pixel(film, 12, 16)[1]);
        EXPECT_GT(pixel(film, 36, 16)[0], pixel(film, 36, 16)[1] + 100);
    }
    EXPECT_THROW(draw(scene, with(settings, "material", "left:color=red")), UsageError);
    EXPECT_THROW(draw(scene, with(settings, "material", "3:color=red")), UsageError);
}

// Borders of colour on sticks

/// A stick in two halves, the first red, the second blue, that meet at a point.
Scene two_colored_stick(Vec3d middle, Vec3d half, std::vector<std::uint32_t> parts = {}) {
    Glyphs sticks;
    sticks.shape = {.kind = GlyphKind::frustum, .capped = false};
    sticks.placements = {placement_between(middle - half, middle, 6.0),
                         placement_between(middle, middle + half, 6.0)};
    sticks.colors = {{255, 0, 0}, {0, 0, 255}};
    sticks.other_half = {1, -1};
    sticks.parts = std::move(parts);
    Object object;
    object.kind = ObjectKind::molecule;
    object.usual_ids = IdLevel::object;
    object.shape = std::move(sticks);
    return Scene({std::move(object)});
}

/// Of a side of 32 pixels, or as many times finer: how red the pixels are, row by row.
std::vector<float> redness(const Scene& scene, int finer, std::string_view smoothing,
                           std::optional<IdLevel> ids = {}) {
    constexpr int kSide = 32;
    Settings settings = plan_view({kSide * finer, kSide * finer});
    settings.view.orthographic = double{kSide};
    settings.shading.mode = ShadeMode::flat;
    settings.shading.background = {0, 255, 0};
    settings.ids = ids;
    const Film film =
        draw(scene, with(settings, "aa", smoothing), {.display = false, .linear = true});
    return {plane(film, "R").begin(), plane(film, "R").end()};
}

/// The mean of the finer pixels of pixel k.
double mean(const std::vector<float>& fine, int finer, std::size_t k) {
    const auto f = static_cast<std::size_t>(finer);
    double sum = 0.0;
    for (std::size_t j = 0; j < f; ++j) {
        for (std::size_t i = 0; i < f; ++i) {
            sum += double{fine[((k / 32 * f + j) * 32 + k % 32) * f + i]};
        }
    }
    return sum / static_cast<double>(f * f);
}

/// Calls `check(k)` for the pixels that lie well within the stick's outlines.
template <class Check>
void for_each_inner_pixel(Vec3d middle, Vec3d half, const Check& check) {
    const double size = std::hypot(half.x, half.y);
    for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 32; ++x) {
            const Vec3d p = Vec3d{x - 15.5, 15.5 - y, 0} - middle;
            const double across = std::abs(half.x * p.y - half.y * p.x) / size;
            const double along = std::abs(half.x * p.x + half.y * p.y) / size;
            if (across < 4.5 && along < 0.7 * size) check(static_cast<std::size_t>(32 * y + x));
        }
    }
}

TEST(StickBorders, HaveEachColourByItsAreaInAPixel) {
    constexpr int kFiner = 32;
    for (const Vec3d half : {Vec3d{12, 0, 0}, Vec3d{0, 12, 0}, Vec3d{9, 9, 0}, Vec3d{11, 4, 0}}) {
        for (const double shift : {0.0, 0.15, 0.4, 0.8}) {
            const Vec3d middle{shift, 0.3 * shift, 0};
            const Scene scene = two_colored_stick(middle, half);
            const std::vector<float> seen = redness(scene, 1, "edges");
            const std::vector<float> fine = redness(scene, kFiner, "none");
            for_each_inner_pixel(middle, half, [&](std::size_t k) {
                EXPECT_NEAR(seen[k], mean(fine, kFiner, k), 0.02) << half.x << ' ' << shift;
            });
        }
    }
}

TEST(StickBorders, AreSmoothOnSticksThatLeanTowardsTheEye) {
    constexpr int kFiner = 16;
    const Vec3d half{9, 4, 7};
    const Scene scene = two_colored_stick({0, 0, 0}, half);
    const std::vector<float> seen = redness(scene, 1, "edges");
    const std::vector<float> fine = redness(scene, kFiner, "none");
    int mixed = 0;
    for_each_inner_pixel({0, 0, 0}, half, [&](std::size_t k) {
        const double area = mean(fine, kFiner, k);
        EXPECT_NEAR(seen[k], area, 0.1);  // the border is an arc
        mixed += area > 0.05 && area < 0.95 ? 1 : 0;
    });
    EXPECT_GT(mixed, 5);
}

TEST(StickBorders, AreSmoothedOnceWhereALineRunsAlongThem) {
    const Scene scene = two_colored_stick({0.4, 0, 0}, {12, 0, 0}, {0, 1});
    const std::vector<float> as_one = redness(scene, 1, "edges");
    for (const IdLevel ids : {IdLevel::primitive, IdLevel::part}) {
        const std::vector<float> seen = redness(scene, 1, "edges", ids);
        for_each_inner_pixel({0.4, 0, 0}, {12, 0, 0},
                             [&](std::size_t k) { EXPECT_NEAR(seen[k], as_one[k], 0.02); });
    }
}

TEST(StickBorders, AreSmoothWithinAPart) {
    const Vec3d half{12, 0, 0};
    const std::vector<float> seen =
        redness(two_colored_stick({0.4, 0, 0}, half, {7, 7}), 1, "edges", IdLevel::part);
    const std::vector<float> as_one = redness(two_colored_stick({0.4, 0, 0}, half), 1, "edges");
    for_each_inner_pixel({0.4, 0, 0}, half, [&](std::size_t k) { EXPECT_EQ(seen[k], as_one[k]); });
}

TEST(StickBorders, AreSharpWithoutSmoothing) {
    const Vec3d half{9, 9, 0};
    const std::vector<float> seen = redness(two_colored_stick({0.2, 0, 0}, half), 1, "none");
    for_each_inner_pixel({0.2, 0, 0}, half,
                         [&](std::size_t k) { EXPECT_TRUE(seen[k] == 0.0F || seen[k] > 0.99F); });
}

}  // namespace
}  // namespace ink::test
