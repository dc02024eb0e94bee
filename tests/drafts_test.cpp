// Pictures of a moving camera, drawn from fewer rays.

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <utility>

#include "session/pace.h"
#include "session_owner.h"

namespace inktrace::viewer {
namespace {

using namespace test;

TEST(Pace, TakesFewerRaysWhereLinesCostMuchOfAFrame) {
    Pace pace;
    pace.plain_took(25.0);
    pace.frame_took(1.0, 29.0);
    EXPECT_EQ(pace.scale(), 1.0);
    pace.forget();
    pace.frame_took(1.0, 120.0);
    EXPECT_LE(pace.scale(), 0.5);
}

TEST(Pace, HoldsTheFrameRateHoweverLongAFrameTakesWithoutLines) {
    Pace pace;
    pace.plain_took(400.0);
    pace.frame_took(1.0, 300.0);
    EXPECT_LE(pace.scale(), 0.375);
}

TEST(Pace, TakesNoFewerRaysWhereThatIsNoFaster) {
    Pace pace;
    pace.plain_took(10.0);
    for (int k = 0; k < 60; ++k) pace.frame_took(pace.scale(), 35.0);  // whatever it draws
    EXPECT_EQ(pace.scale(), 1.0);
}

TEST(Pace, StaysWithAScaleWhileFramesCostTheSame) {
    for (const double full_ms : {20.0, 50.0, 90.0, 300.0}) {
        Pace pace;
        for (int k = 0; k < 15; ++k) pace.frame_took(pace.scale(), full_ms * pace.scale());
        const double settled = pace.scale();
        for (int k = 0; k < 20; ++k) {
            pace.frame_took(pace.scale(), full_ms * pace.scale());
            EXPECT_EQ(pace.scale(), settled) << full_ms;
        }
    }
}

/// What one frame in three takes longer because of other programs.
double disturbance(int frame) {
    return frame % 3 == 1 ? 0.5 + std::fmod(frame * 0.618033988749895, 1.0) : 0.0;
}

TEST(Pace, StaysWithAScaleWhileOtherProgramsDisturbIt) {
    for (const double full_ms : {15.0, 20.0, 35.0, 60.0}) {
        for (const double power : {0.4, 1.0, 1.6}) {
            Pace pace;
            pace.plain_took(15.0);
            int changes = 0;  // once it has settled
            double scale = pace.scale();
            for (int k = 0; k < 300; ++k) {
                const double ms = full_ms * std::pow(scale, power) * (1.0 + disturbance(k));
                pace.frame_took(scale, ms);
                if (pace.scale() != scale) ++changes;
                scale = pace.scale();
                if (k == 40) changes = 0;
            }
            EXPECT_EQ(changes, 0) << full_ms << ", " << power;
            const double settled_ms = full_ms * std::pow(scale, power);
            const double least_ms = full_ms * std::pow(0.25, power);
            EXPECT_LE(settled_ms, std::max(1.2 * 15.0, 1.1 * least_ms)) << full_ms << ", " << power;
        }
    }
}

TEST(Pace, JudgesFewerRaysAnewAfterARestWhereTheySeemedTooSlow) {
    const auto cost = [](double scale) { return 10.0 + 20.0 * scale; };
    Pace pace;
    pace.plain_took(8.0);
    for (int k = 0; k < 40; ++k) {  // disturbed whenever it takes fewer rays
        pace.frame_took(pace.scale(), cost(pace.scale()) * (pace.scale() < 1.0 ? 3.0 : 1.0));
    }
    pace.plain_took(8.0);
    for (int k = 0; k < 40; ++k) pace.frame_took(pace.scale(), cost(pace.scale()));
    EXPECT_EQ(pace.scale(), 0.25);
}

TEST(Pace, TakesMoreRaysAgainWhenFramesBecomeCheap) {
    Pace pace;
    pace.plain_took(15.0);
    for (int k = 0; k < 10; ++k) pace.frame_took(pace.scale(), 60.0 * pace.scale());
    EXPECT_LT(pace.scale(), 0.5);
    for (int k = 0; k < 20; ++k) pace.frame_took(pace.scale(), 15.0 * pace.scale());
    EXPECT_EQ(pace.scale(), 1.0);
}

TEST(ScaledSettings, KeepTheShareOfInk) {
    Scene scene;
    scene.load(sample());
    const Renderer renderer(std::move(scene));
    Settings settings;
    settings.set("size", "400x300").set("compose", "lines").set("line-width", "6px");
    settings.set("line", "silhouette:width=1mm").set("line-density", "1");
    const auto ink = [&](const Settings& of) {
        const Picture picture = renderer.render(of);
        double sum = 0.0;
        for (std::size_t i = 0; i < picture.rgba().size(); i += 4) sum += 255 - picture.rgba()[i];
        return sum / static_cast<double>(picture.rgba().size());
    };
    const double full = ink(settings);
    EXPECT_NEAR(ink(settings.scaled(0.5)), full, 0.02 * full);
    EXPECT_NEAR(ink(settings.scaled(2.0)), full, 0.02 * full);
}

/// Of two pictures of one size, per channel.
double mean_difference(const Picture& a, const Picture& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.rgba().size(); ++i) sum += std::abs(a.rgba()[i] - b.rgba()[i]);
    return sum / static_cast<double>(a.rgba().size());
}

double mean_ink(const Picture& picture) {
    double sum = 0.0;
    for (const std::uint8_t byte : picture.rgba()) sum += 255 - byte;
    return sum / static_cast<double>(picture.rgba().size());
}

Renderer draft_scene(const fs::path& file) {
    Scene scene;
    scene.load(file);
    return Renderer(std::move(scene));
}

TEST(Draft, DrawsTheLinesOfThePictureInFullInTheirPlacesAndWidths) {
    for (const char* const file :
         {"samples/acetaminophen.xyz", "tests/pictures/box_on_floor.obj"}) {
        const Renderer renderer = draft_scene(ink::test::source_dir() / file);
        for (const char* const lines :
             {"silhouette,intersection,self-occlusion,crease,boundary", "all"}) {
            Settings settings;
            settings.set("size", "401x300").set("compose", "lines").set("lines", lines);
            settings.set("line", "silhouette:width=4px,color=navy");
            const Picture full = renderer.render(settings);
            for (const double share : {0.75, 0.5, 0.25}) {
                RenderOptions options;
                options.draft = share;
                const Picture draft = renderer.render(settings, options);
                ASSERT_EQ(draft.width(), 401);
                ASSERT_EQ(draft.height(), 300);
                EXPECT_NEAR(mean_ink(draft), mean_ink(full), 0.03 * mean_ink(full))
                    << file << ", " << lines << ", " << share;
                EXPECT_LT(mean_difference(draft, full), 0.1 * mean_ink(full))
                    << file << ", " << lines << ", " << share;
                EXPECT_LT(draft.stats().rays, full.stats().rays);
            }
        }
    }
}

/// A bumpy sheet of triangles of some pixels in a picture of 300.
std::string fine_mesh(int side, double height = 2.0) {
    std::string text = fmt::format("OFF\n{} {} 0\n", side * side, 2 * (side - 1) * (side - 1));
    for (int i = 0; i < side * side; ++i) {
        const double x = i % side;
        const double y = i / side;
        text += fmt::format("{} {} {}\n", x, y, height * std::sin(0.3 * x) * std::cos(0.2 * y));
    }
    for (int i = 0; i < side * (side - 1); ++i) {
        if (i % side == side - 1) continue;
        text += fmt::format("3 {} {} {}\n", i, i + 1, i + side);
        text += fmt::format("3 {} {} {}\n", i + 1, i + side + 1, i + side);
    }
    return text;
}

TEST(Draft, KeepsTheToneOfLinesBetweenFacesThatAreSmallerThanItsLattice) {
    const TemporaryFolder folder;
    const Renderer renderer = draft_scene(folder.write("fine.off", fine_mesh(60)));
    Settings settings;
    settings.set("size", "300x300").set("compose", "lines").set("lines", "mesh");
    const double full = mean_ink(renderer.render(settings));
    for (const auto& [share, tolerance] : {std::pair{0.75, 0.08}, {0.5, 0.08}, {0.25, 0.08}}) {
        RenderOptions options;
        options.draft = share;
        EXPECT_NEAR(mean_ink(renderer.render(settings, options)), full, tolerance * full) << share;
    }
}

TEST(Draft, DrawsLinesBetweenFacesOfARegularMeshWhereThePictureInFullDoes) {
    const TemporaryFolder folder;
    // Some triangles are larger than cells of the lattice, some are smaller.
    for (const int side : {10, 60}) {
        const Renderer renderer = draft_scene(folder.write("flat.off", fine_mesh(side, 0.0)));
        Settings settings;
        settings.set("size", "300x300").set("compose", "lines").set("line-width", "1");
        settings.set("lines", "silhouette,intersection,self-occlusion,boundary,mesh");
        settings.set("eye", "40,25,60").set("look-at", "5,5,0").set("up", "0,1,0");
        if (side == 60) settings.set("eye", "40,25,260").set("look-at", "30,30,0");
        const Picture full = renderer.render(settings);
        for (const double share : {0.5, 0.25}) {
            RenderOptions options;
            options.draft = share;
            EXPECT_LT(mean_difference(renderer.render(settings, options), full),
                      0.12 * mean_ink(full))
                << side << ", " << share;
        }
    }
}

TEST(Draft, DrawsNoLinesBetweenFacesBesideTheMesh) {
    const TemporaryFolder folder;
    const Renderer renderer = draft_scene(folder.write("fine.off", fine_mesh(60)));
    Settings settings;
    settings.set("size", "300x300").set("compose", "lines").set("lines", "all");
    settings.set("line-width", "1");
    // One that has no ink here nor in any pixel around it.
    const Picture full = renderer.render(settings);
    RenderOptions options;
    options.draft = 0.25;
    const Picture draft = renderer.render(settings, options);
    const auto is_clear = [](const Picture& picture, int x, int y) {
        return picture.rgba()[static_cast<std::size_t>(4 * (y * 300 + x))] == 255;
    };
    int beside = 0;
    for (int y = 2; y < 298; ++y) {
        for (int x = 2; x < 298; ++x) {
            bool clear = true;
            for (int k = 0; k < 25; ++k) {
                clear = clear && is_clear(full, x + k % 5 - 2, y + k / 5 - 2);
            }
            beside += clear && !is_clear(draft, x, y) ? 1 : 0;
        }
    }
    EXPECT_LT(beside, 20);
}

TEST(Draft, DrawsLinesBetweenFacesUpToAnOutlineThatLiesJustBelowAPointOfItsLattice) {
    const TemporaryFolder folder;
    const Renderer renderer = draft_scene(folder.write("flat.off", fine_mesh(60, 0.0)));
    Settings settings;
    settings.set("size", "160x160").set("compose", "lines").set("line-width", "1px");
    settings.set("lines", "silhouette,boundary,mesh");
    // The upper edge lies at 14.2 pixels; the last points above it see nothing, nor does any other
    // of their blocks of 4 x 4.
    settings.set("eye", "30,42.55,100").set("look-at", "30,42.55,0").set("up", "0,1,0");
    settings.set("orthographic", "40");
    RenderOptions options;
    options.draft = 0.25;
    const Picture draft = renderer.render(settings, options);
    const auto ink_of_row = [&](int y) {
        double sum = 0.0;
        for (int x = 0; x < 160; ++x) {
            sum += 255 - draft.rgba()[static_cast<std::size_t>(4 * (y * 160 + x))];
        }
        return sum;
    };
    double usual = 0.0;
    for (int y = 20; y < 60; ++y) usual += ink_of_row(y) / 40.0;
    EXPECT_GT(ink_of_row(15), 0.4 * usual);
}

TEST(Draft, LetsNoColorRunAcrossALine) {
    // Two hemispheres of clear colours before white: with a line too thin to hide any bleeding.
    const TemporaryFolder folder;
    const fs::path file = folder.write("s.json", R"({"objects": [
            {"type": "sphere", "center": [-0.8, 0, 0], "radius": 1,
             "color": "#ff0000"},
            {"type": "sphere", "center": [0.8, 0, 0], "radius": 1,
             "color": "#0000ff"}]})");
    const Renderer renderer = draft_scene(file);
    Settings settings;
    settings.set("size", "200x150").set("shade", "flat").set("line-width", "0.25px");
    settings.set("aa", "none").set("view", "front").set("line-color", "white");
    RenderOptions options;
    options.draft = 0.25;
    const Picture draft = renderer.render(settings, options);
    const auto at = [&](int x, int y) { return draft.rgba().data() + 4 * (y * 200 + x); };
    int clear = 0;
    int mixed = 0;
    for (int y = 0; y < 150; ++y) {
        for (int x = 0; x < 200; ++x) {
            const auto* const c = at(x, y);
            const bool red = c[0] > 200 && c[2] < 60;
            const bool blue = c[2] > 200 && c[0] < 60;
            const bool white = c[0] > 200 && c[1] > 200 && c[2] > 200;
            (red || blue || white ? clear : mixed) += 1;
        }
    }
    // Outlines are 800 pixels long; a blur of four pixels would mix thousands.
    EXPECT_LT(mixed, 500) << clear << " are clear";
}

TEST(Draft, OfMethodStencilIsThePictureOfFewerPixels) {
    const Renderer renderer = draft_scene(sample());
    Settings settings;
    settings.set("size", "160x120").set("method", "stencil").set("quality", "1");
    const Picture full = renderer.render(settings);
    RenderOptions options;
    options.draft = 0.5;
    const Picture draft = renderer.render(settings, options);
    ASSERT_EQ(draft.width(), 160);
    EXPECT_LT(mean_difference(draft, full), 12.0);
    EXPECT_LT(draft.stats().rays, full.stats().rays / 2);
}

}  // namespace
}  // namespace inktrace::viewer
