#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <string>
#include <utility>

#include "inktrace/inktrace.h"
#include "test_files.h"

namespace ink::test {
namespace {

using inktrace::Error;
using inktrace::Picture;
using inktrace::RenderOptions;

Picture draw_ball(const RenderOptions& options, const std::string& fill = "flat") {
    inktrace::Scene scene;
    scene.add_spheres("ball", std::array{0.0F, 0.0F, 0.0F, 1.0F});
    inktrace::Settings settings;
    settings.set("size", "32x32").set("fill", fill);
    return inktrace::Renderer(std::move(scene)).render(settings, options);
}

/// What saving complains of, which must be the caller's use and leave no file; empty if nothing.
std::string complaint(const Picture& picture, const std::filesystem::path& file) {
    try {
        picture.save(file);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), Error::Kind::usage);
        EXPECT_FALSE(std::filesystem::exists(file));
        return error.what();
    }
    EXPECT_TRUE(std::filesystem::exists(file));
    return {};
}

TEST(Pictures, SayWhatAFileNeedsThatTheyLack) {
    const TemporaryFolder folder;
    const Picture linear = draw_ball({.display = false, .linear = true});
    for (const char* name : {"a.png", "a.jpg", "a.tiff"}) {
        EXPECT_NE(complaint(linear, folder.path() / name).find("RenderOptions::display"),
                  std::string::npos);
    }
    EXPECT_EQ(complaint(linear, folder.path() / "a.exr"), "");

    const Picture display = draw_ball({});
    EXPECT_NE(complaint(display, folder.path() / "b.exr").find("RenderOptions::linear"),
              std::string::npos);
    EXPECT_NE(complaint(display, folder.path() / "b.svg").find("RenderOptions::curves"),
              std::string::npos);
    EXPECT_EQ(complaint(display, folder.path() / "b.png"), "");
}

TEST(Pictures, NeedPixelsBelowCurvesOnlyWhereTheyAreShown) {
    const TemporaryFolder folder;
    const RenderOptions curves_alone{.display = false, .curves = true};
    for (const char* fill : {"flat", "image"}) {
        const Picture picture = draw_ball(curves_alone, fill);
        for (const char* name : {"a.svg", "a.pdf"}) {
            EXPECT_NE(complaint(picture, folder.path() / name).find("RenderOptions::display"),
                      std::string::npos);
        }
    }
    EXPECT_EQ(complaint(draw_ball(curves_alone, "none"), folder.path() / "b.svg"), "");
}

}  // namespace
}  // namespace ink::test
