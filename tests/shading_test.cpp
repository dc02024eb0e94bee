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

}  // namespace
}  // namespace ink::test
