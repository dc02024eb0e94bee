// Lights, shadows, looks, and what they leave alone.

#include "shading/lights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "drawing.h"
#include "render/light_text.h"
#include "render/looks.h"
#include "render/settings.h"
#include "scenes.h"
#include "shading/shadows.h"

namespace ink::test {
namespace {

Settings with(Settings settings, std::string_view name, std::string_view value) {
    find_setting(name).set(settings, value);
    return settings;
}

/// Orthographic along -z, `side` units high, the origin in the middle.
Settings plan_view(int side, int pixels) {
    Settings settings;
    settings.size = {pixels, pixels};
    settings.view.eye = Vec3d{0, 0, 50};
    settings.view.look_at = Vec3d{0, 0, 0};
    settings.view.up = Vec3d{0, 1, 0};
    settings.view.orthographic = side;
    settings.threads = 2;
    return settings;
}

Rgb8 pixel(const Film& film, int x, int y) {
    const std::uint32_t rgba =
        film.display().pixels[static_cast<std::size_t>(y * film.size().width + x)];
    return {static_cast<std::uint8_t>(rgba), static_cast<std::uint8_t>(rgba >> 8U),
            static_cast<std::uint8_t>(rgba >> 16U)};
}

// A ball of radius 1 between a floor at height 0, three below its centre, and a disc of radius 0.5
// six above the floor.
constexpr double kBall = 1.0, kHeight = 3.0, kLight = 0.5, kLightHeight = 6.0;

Scene eclipse() {
    return Scene(
        {mesh_object({{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}, {{0, 1, 2}, {0, 2, 3}}),
         sphere_object({{{0, 0, kHeight}, kBall}})});
}

/// Share of the disc that a point of the floor at distance x from its middle sees.
double seen_of_disc(double x) {
    constexpr int kSteps = 400;
    int seen = 0;
    int all = 0;
    for (int i = 0; i < kSteps; ++i) {
        for (int j = 0; j < kSteps; ++j) {
            const double u = (2.0 * i + 1.0) / kSteps - 1.0;
            const double v = (2.0 * j + 1.0) / kSteps - 1.0;
            if (u * u + v * v >= 1.0) continue;
            const Vec3d p{x, 0, 0};
            const Vec3d d = normalize(Vec3d{kLight * u, kLight * v, kLightHeight} - p);
            const Vec3d to = Vec3d{0, 0, kHeight} - p;
            const double along = dot(to, d);
            ++all;
            if (dot(to, to) - along * along >= kBall * kBall) ++seen;
        }
    }
    return static_cast<double>(seen) / all;
}

Lanes<float> visible(const Scene& scene, ShadowMode mode, const std::array<double, kLanes>& x) {
    const auto tracer = make_tracer(scene);
    const Camera camera(scene, plan_view(20, 64).view, {64, 64});
    const LightRig rig = make_lights(scene, camera, read_lights("disc:from=0,0,6,size=0.5"));
    RayPacket rays{};
    PointPacket points{};
    HitPacket hits = HitPacket::miss();
    NormalPacket normals{};
    const Frame& frame = scene.frame();
    for (int i = 0; i < kLanes; ++i) {
        const Vec3f p = frame.from_world({x[static_cast<std::size_t>(i)], 0, 0});
        rays.origin_x[i] = p.x;
        rays.origin_y[i] = p.y;
        rays.origin_z[i] = p.z + 0.5F;
        rays.dir_z[i] = -1.0F;
        normals.z[i] = 1.0F;
        hits.t[i] = 0.5F;
        hits.object[i] = 0;
        points.x[i] = static_cast<float>(i) + 0.5F;
    }
    Lanes<float> result;
    Shadows(*tracer, mode).visible(rig.sources[0], {rays, points, hits, normals}, result);
    return result;
}

TEST(Shadows, OfADiscLightHaveTheUmbraAndPenumbraOfGeometry) {
    // The tangents of ball and disc on one side, and on opposite sides, meet the floor here.
    const auto meets_floor = [](double side) {
        // Numerically: the least x from which the far edge of the disc is seen past the ball.
        double low = 0.0;
        double high = 9.0;
        for (int step = 0; step < 60; ++step) {
            const double x = 0.5 * (low + high);
            const Vec3d p{x, 0, 0};
            const Vec3d d = normalize(Vec3d{side * kLight, 0, kLightHeight} - p);
            const Vec3d to = Vec3d{0, 0, kHeight} - p;
            const bool hidden = dot(to, to) - dot(to, d) * dot(to, d) < kBall * kBall;
            (hidden ? low : high) = x;
        }
        return low;
    };
    const double umbra = meets_floor(1.0);
    const double penumbra = meets_floor(-1.0);
    ASSERT_GT(penumbra, umbra + 0.5);
    const Scene scene = eclipse();
    std::array<double, kLanes> x;
    for (std::size_t i = 0; i < kLanes; ++i) {
        const double share = static_cast<double>(i) / (kLanes - 1);
        x[i] = umbra - 0.2 + share * (penumbra - umbra + 0.4);
    }
    const Lanes<float> soft = visible(scene, ShadowMode::soft, x);
    const Lanes<float> hard = visible(scene, ShadowMode::hard, x);
    for (std::size_t i = 0; i < kLanes; ++i) {
        const auto lane = static_cast<int>(i);
        EXPECT_NEAR(soft[lane], seen_of_disc(x[i]), 0.04) << x[i];
        if (x[i] < umbra - 0.01) {
            EXPECT_EQ(soft[lane], 0.0F);
        }
        if (x[i] > penumbra + 0.01) {
            EXPECT_EQ(soft[lane], 1.0F);
        }
        // The disc's middle, seen past the ball: tan of the tangent's angle from the axis.
        const double edge =
            kLightHeight * kBall /
            std::sqrt((kLightHeight - kHeight) * (kLightHeight - kHeight) - kBall * kBall);
        if (std::abs(x[i] - edge) > 0.02) {
            EXPECT_EQ(hard[lane], x[i] < edge ? 0.0F : 1.0F) << x[i];
        }
    }
}

TEST(Shadows, DarkenThePictureWhereTheyFall) {
    const Scene scene = eclipse();
    Settings settings = with(plan_view(16, 64), "lines", "none");
    settings = with(settings, "light", "disc:from=8,0,8,size=0.5");
    const int before = pixel(draw(scene, settings), 22, 32).g;
    const int after = pixel(draw(scene, with(settings, "shadows", "soft")), 22, 32).g;
    EXPECT_GT(before, after + 60);
}

TEST(Lights, OfTheCameraTurnWithItAndThoseOfTheSceneDoNot) {
    const Scene scene({sphere_object({{{0, 0, 0}, 1}})});
    const auto seen = [&](const char* light, double z) {
        Settings settings = with(plan_view(3, 48), "light", light);
        settings.view.eye = Vec3d{0, 0, z};
        return draw(scene, settings).display().pixels;
    };
    for (const char* light : {"", "camera:from=-1,1,1", "camera:from=0,0,1;sky:strength=0.2"}) {
        EXPECT_EQ(seen(light, 50), seen(light, -50)) << light;
    }
    EXPECT_NE(seen("sun:from=1,0,0.5", 50), seen("sun:from=1,0,0.5", -50));
}

TEST(Lights, AddUp) {
    const Scene scene(
        {mesh_object({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}})});
    const auto level = [&](const char* lights) {
        Settings settings = with(plan_view(2, 16), "lines", "none");
        const Film film = draw(scene, with(settings, "light", lights));
        return srgb_decode(static_cast<float>(pixel(film, 8, 8).g) / 255.0F);
    };
    const float color = srgb_decode(204.0F / 255.0F);
    EXPECT_NEAR(level("sun:from=0,0,1,strength=0.5"), 0.5F * color, 0.005F);
    // At 60 degrees a light gives half.
    EXPECT_NEAR(level("sun:from=1.7320508,0,1,strength=0.8"), 0.4F * color, 0.005F);
    EXPECT_NEAR(level("sun:from=0,0,1,strength=0.5;sun:from=0,0,1,strength=0.25"), 0.75F * color,
                0.005F);
    // A surface upright in the picture sees half of the sky above and half of the ground.
    EXPECT_NEAR(level("sky:strength=0.6,ground=#000000"), 0.3F * color, 0.005F);
}

/// Rays from what is not a sphere take a hundred times as long as the rest of the frame.
TEST(Lights, ComeFromAllAroundUnlessToldWhereAtomsAndParticlesAreSpheres) {
    const auto ambient = [](std::vector<Object> objects, const Settings& settings = {}) {
        return shading_of(settings, Scene(std::move(objects))).ambient.value();
    };
    std::vector<Object> balls = random_objects(1, 5, 3);
    EXPECT_EQ(ambient(balls), 1.0F);
    EXPECT_EQ(ambient({balls[1]}), 0.0F);
    std::vector<Object> balls_and_sticks{balls[0], copied_sticks(1, 5)};
    balls_and_sticks[1].kind = ObjectKind::molecule;
    EXPECT_EQ(ambient(balls_and_sticks), 0.0F);
    Settings told;
    told.shading.ambient = 0.5F;
    EXPECT_EQ(ambient(balls_and_sticks, told), 0.5F);
}

TEST(Lights, SayWhatIsWrong) {
    const auto refusal = [](const char* text) -> std::string {
        try {
            with({}, "light", text);
        } catch (const UsageError& error) {
            return error.what();
        }
        return "(accepted)";
    };
    EXPECT_NE(refusal("lamp").find("camera, sun, disc, sky"), std::string::npos);
    EXPECT_NE(refusal("sky:from=1,1,1").find("'from'"), std::string::npos);
    EXPECT_NE(refusal("sun:from=0,0,0").find("no length"), std::string::npos);
    EXPECT_NE(refusal("sun:strength=-1").find("strength"), std::string::npos);
    EXPECT_NE(refusal("camera:size=120").find("size"), std::string::npos);
}

std::vector<Object> heap() {
    std::mt19937 random(11);
    std::vector<Sphere> balls;
    for (int i = 0; i < 60; ++i) {
        balls.push_back({uniform_point(random), 0.06F + 0.08F * uniform(random)});
    }
    return {sphere_object(std::move(balls)),
            mesh_object({{-1, -1, 0.3F}, {2, -1, 0.2F}, {0.5F, 2, 0.4F}, {0.5F, 0, 1.5F}},
                        {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}})};
}

const auto& values(const Film& film, std::string_view name) {
    for (const Channel& channel : film.channels().channels) {
        if (channel.name == name) return channel.values;
    }
    throw std::logic_error("no such plane");
}

TEST(Lines, KeepPlaceWidthAndTypeInAnyLight) {
    const Scene scene(heap());
    Settings settings = plan_view(4, 128);
    settings.lines = LineTypes::all();
    settings.aovs = {Aov::lines};
    const Film plain = draw(scene, settings, {.display = true, .linear = true});
    for (const auto& [name, value] : std::vector<std::pair<std::string, std::string>>{
             {"ambient", "1"},
             {"shadows", "soft"},
             {"shadows", "hard"},
             {"fog", "0.8"},
             {"pastel", "0.6"},
             {"shade", "toon"},
             {"shade", "gooch"},
             {"shade", "none"},
             {"light", "disc:from=1,2,3,size=1;sky:strength=0.4"}}) {
        const Film other =
            draw(scene, with(settings, name, value), {.display = true, .linear = true});
        for (const char* channel : {"line.A", "line.type", "line.distance"}) {
            EXPECT_EQ(values(plain, channel), values(other, channel)) << name << " " << channel;
        }
    }
}

TEST(Lines, KeepPlaceWidthAndTypeInEveryLook) {
    const Scene scene(heap());
    Settings settings = plan_view(4, 128);
    settings.lines = LineTypes::all();
    settings.aovs = {Aov::lines};
    const Film usual = draw(scene, settings, {.display = true, .linear = true});
    for (const Look& look : looks()) {
        // Light, colours and paper of the look, with the usual lines.
        Settings lit = with(settings, "look", look.name);
        lit.look_rules.clear();
        for (const std::string_view name :
             {"line-width", "line-density", "line-fade", "line-taper", "halo", "compose"}) {
            lit = with(lit, name, find_setting(name).get(settings));
        }
        const Film other = draw(scene, lit, {.display = true, .linear = true});
        for (const char* channel : {"line.A", "line.type", "line.distance"}) {
            EXPECT_EQ(values(usual, channel), values(other, channel)) << look.name << channel;
        }
    }
}

/// Widths are a look's own, places are not: a line's middle is where it is in any other look.
TEST(Lines, RunInTheSamePlacesInEveryLook) {
    const Scene scene({sphere_object({{{0, 0, 0}, 1}})});
    Settings settings = plan_view(4, 128);
    settings.aovs = {Aov::lines};
    for (const Look& look : looks()) {
        const Settings own = with(settings, "look", look.name);
        const Film film = draw(scene, own, {.display = true, .linear = true});
        const auto& alpha = plane(film, "line.A");
        double ink = 0.0;
        double moment = 0.0;
        for (int x = 64; x < 128; ++x) {
            const auto a = static_cast<double>(alpha[static_cast<std::size_t>(64 * 128 + x)]);
            ink += a;
            moment += a * (x + 0.5);
        }
        ASSERT_GT(ink, 0.2) << look.name;
        // 32 pixels a unit. Half a pixel above the middle the outline is 0.004 pixels nearer.
        EXPECT_NEAR(moment / ink, 64.0 + 32.0, 0.05) << look.name;
    }
}

TEST(Toon, HasFourTonesWithSmoothBorders) {
    const Scene scene({sphere_object({{{0, 0, 0}, 1}})});
    Settings settings = with(with(plan_view(3, 192), "lines", "none"), "shade", "toon");
    const Film film = draw(scene, settings);
    std::map<int, int> levels;
    for (int y = 0; y < 192; ++y) {
        for (int x = 0; x < 192; ++x) {
            const double dx = x + 0.5 - 96.0;
            const double dy = y + 0.5 - 96.0;
            if (dx * dx + dy * dy < 60.0 * 60.0) ++levels[pixel(film, x, y).g];
        }
    }
    int frequent = 0;
    int rest = 0;
    for (const auto& [level, count] : levels) {
        if (count > 200) {
            ++frequent;
        } else {
            rest += count;
        }
    }
    EXPECT_GE(frequent, 3);
    EXPECT_LE(frequent, 4);
    // Borders of a few hundred pixels' length, one or two pixels wide.
    EXPECT_GT(rest, 150);
    EXPECT_LT(rest, 900);
}

/// Ink of the picture's lines within columns [x0, x1).
double ink(const Film& film, int x0, int x1) {
    const auto& alpha = plane(film, "line.A");
    double sum = 0.0;
    for (int y = 0; y < film.size().height; ++y) {
        for (int x = x0; x < x1; ++x) {
            sum += static_cast<double>(alpha[static_cast<std::size_t>(y * film.size().width + x)]);
        }
    }
    return sum;
}

/// Two balls alike, one at the front and one at the back of the scene.
Scene near_and_far() { return Scene({sphere_object({{{-2, 0, 0}, 1}, {{2, 0, -8}, 1}})}); }

/// The setting takes away a share of 0.6 of the ink, at the very back.
void expect_less_ink_behind(std::string_view setting) {
    const Scene scene = near_and_far();
    Settings settings = plan_view(8, 128);
    settings.aovs = {Aov::lines};
    const PixelFormats formats{.display = true, .linear = true};
    const Film usual = draw(scene, settings, formats);
    const Film less = draw(scene, with(settings, setting, "0.6"), formats);
    // Outlines lie one unit behind a ball's foremost point, of ten that the scene is deep.
    EXPECT_NEAR(ink(less, 0, 64) / ink(usual, 0, 64), 1.0 - 0.6 * 0.1, 0.01);
    EXPECT_NEAR(ink(less, 64, 128) / ink(usual, 64, 128), 1.0 - 0.6 * 0.9, 0.01);
}

TEST(Lines, FadeWithDistance) { expect_less_ink_behind("line-fade"); }

TEST(Lines, GetThinnerWithDistance) { expect_less_ink_behind("line-taper"); }

/// Two upright sheets of squares, one at the front and one at the back of the scene.
Scene near_and_far_sheets() {
    std::vector<Vec3f> vertices;
    std::vector<Mesh::Triangle> triangles;
    for (const auto& [left, z] :
         std::vector<std::pair<float, float>>{{-4.0F, 0.0F}, {1.0F, -10.0F}}) {
        const auto first = static_cast<std::uint32_t>(vertices.size());
        for (int j = 0; j <= 3; ++j) {
            for (int i = 0; i <= 3; ++i) {
                vertices.push_back({left + static_cast<float>(i), static_cast<float>(j) - 1.5F, z});
            }
        }
        for (std::uint32_t j = 0; j < 3; ++j) {
            for (std::uint32_t i = 0; i < 3; ++i) {
                const std::uint32_t a = first + 4 * j + i;
                triangles.push_back({a, a + 1, a + 5});
                triangles.push_back({a, a + 5, a + 4});
            }
        }
    }
    return Scene({mesh_object(std::move(vertices), std::move(triangles))});
}

TEST(Lines, BetweenFacesFadeAndGetThinnerLikeOthers) {
    const Scene scene = near_and_far_sheets();
    Settings settings = with(with(plan_view(10, 160), "lines", "mesh"), "line-width", "2px");
    settings.aovs = {Aov::lines};
    const PixelFormats formats{.display = true, .linear = true};
    const Film usual = draw(scene, settings, formats);
    for (const char* name : {"line-fade", "line-taper"}) {
        const Film film = draw(scene, with(settings, name, "0.5"), formats);
        EXPECT_NEAR(ink(film, 0, 80) / ink(usual, 0, 80), 1.0, 0.01) << name;
        EXPECT_NEAR(ink(film, 80, 160) / ink(usual, 80, 160), 0.5, 0.02) << name;
    }
}

TEST(Halos, ShowPaperBesideOutlinesInWhatLiesFarBehind) {
    std::vector<Object> objects{
        sphere_object({{{0, 0, 0}, 1}}),
        mesh_object({{-3, -3, -6}, {3, -3, -6}, {3, 3, -6}, {-3, 3, -6}}, {{0, 1, 2}, {0, 2, 3}})};
    objects[1].material.color = {40, 40, 40};
    const Scene scene(std::move(objects));
    // 16 pixels a unit: the ball's outline is at column 64 + 16.
    Settings settings = with(plan_view(8, 128), "line-width", "2px");
    const Film usual = draw(scene, settings);
    const Film film = draw(scene, with(settings, "halo", "4px"));
    EXPECT_EQ(pixel(film, 83, 64), (Rgb8{255, 255, 255}));
    EXPECT_LT(pixel(usual, 83, 64).g, 100);
    EXPECT_EQ(pixel(film, 88, 64), pixel(usual, 88, 64));  // beyond the halo
    EXPECT_EQ(pixel(film, 79, 64), pixel(usual, 79, 64));  // the line itself
    EXPECT_EQ(pixel(film, 74, 64), pixel(usual, 74, 64));  // the near side
}

TEST(Halos, LeaveWhatIsNearAlone) {
    const Scene scene({sphere_object({{{0, 0, 0}, 1}, {{0.8F, 0, -0.4F}, 1}, {{0, 3, -9}, 1}})});
    const Settings settings = plan_view(8, 128);
    EXPECT_EQ(draw(scene, settings).display().pixels,
              draw(scene, with(settings, "halo", "4px")).display().pixels);
}

TEST(InnerLines, RunWithinOnePartOnly) {
    Object object = sphere_object({{{-1.2F, 0, 0}, 1}, {{0, 0, 0}, 1}, {{1.2F, 0, 0}, 1}});
    std::get<Spheres>(object.shape).parts = {0, 0, 1};
    object.part_names = {"A", "B"};
    const Scene scene({std::move(object)});
    Settings settings = plan_view(4, 160);
    settings.aovs = {Aov::lines};
    const PixelFormats formats{.display = true, .linear = true};
    const Film usual = draw(scene, settings, formats);
    const Film film = draw(scene, with(settings, "line", "inner:width=1px"), formats);
    // Seams at x = -0.6 and 0.6: columns 56 and 104; away from the outline's junctions.
    const auto across = [&](const Film& of, int column) {
        const auto& alpha = plane(of, "line.A");
        double sum = 0.0;
        for (int x = column - 6; x < column + 6; ++x) {
            sum += static_cast<double>(alpha[static_cast<std::size_t>(80 * 160 + x)]);
        }
        return sum;
    };
    EXPECT_NEAR(across(usual, 56), 3.0, 0.05);
    EXPECT_NEAR(across(film, 56), 1.0, 0.05);
    EXPECT_NEAR(across(film, 104), 3.0, 0.05);
}

TEST(Looks, SetWhatCanStillBeSetAfterThem) {
    const Settings technical = with({}, "look", "technical");
    EXPECT_EQ(find_setting("shade").get(technical), "gooch");
    EXPECT_EQ(find_setting("shade").get(with(technical, "shade", "flat")), "flat");
    EXPECT_EQ(technical.line_style(LineType::silhouette, 1).width_px, 3.5);
    EXPECT_EQ(with(technical, "line", "silhouette:width=7px")
                  .line_style(LineType::silhouette, 1)
                  .width_px,
              7.0);
}

TEST(Looks, LeaveNothingOfTheOneBefore) {
    for (const Look& first : looks()) {
        for (const Look& second : looks()) {
            const Settings once = with({}, "look", second.name);
            const Settings twice = with(with({}, "look", first.name), "look", second.name);
            for (const Setting& row : settings_table()) {
                EXPECT_EQ(row.get(once), row.get(twice)) << first.name << second.name << row.name;
            }
            EXPECT_EQ(print(once.look_rules), print(twice.look_rules));
        }
    }
}

TEST(Looks, ChangeThePicture) {
    const Scene scene(heap());
    std::vector<decltype(DisplayImage::pixels)> seen;
    for (const Look& look : looks()) {
        const auto pixels = draw(scene, with(plan_view(4, 96), "look", look.name)).display().pixels;
        for (const auto& other : seen) EXPECT_NE(pixels, other) << look.name;
        seen.push_back(pixels);
    }
}

}  // namespace
}  // namespace ink::test
