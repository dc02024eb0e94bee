// Animations, films and legends, as the program makes them.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <png.h>

#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "command_line.h"

namespace ink::test {
namespace {

/// Of a PNG, without what its file says of how it was made; empty where there is none.
std::vector<std::uint8_t> pixels(const fs::path& path) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_file(&image, path.c_str()) == 0) return {};
    image.format = PNG_FORMAT_RGBA;
    std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(image));
    png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr);
    return bytes;
}

constexpr std::string_view kThreeFrames = "1\n\nC 0 0 0\n1\n\nC 0.5 0 0\n1\n\nC 1 0 0\n";

TEST_F(CommandLine, AnimationDrawsAPictureAFrame) {
    folder_.write("run.xyz", kThreeFrames);
    const Arguments small{"--size", "32x24", "--quiet"};
    const auto draw = [&](Arguments arguments) {
        arguments.insert(arguments.end(), small.begin(), small.end());
        return run(arguments);
    };
    expect_done(draw({"render", "run.xyz", "--frame", "1:", "-o", "out_##.png"}));
    EXPECT_EQ(files(), (std::set<std::string>{"out_01.png", "out_02.png", "run.xyz"}));
    // The camera stays.
    EXPECT_NE(read_bytes(file("out_01.png")), read_bytes(file("out_02.png")));
    const Outcome outcome = draw({"render", "run.xyz", "--frame", "1:7", "-o", "b#.png"});
    EXPECT_EQ(outcome.status, 1);
    expect_says(outcome.err, {"--frame 1:7", "3 frames, 0 to 2"});
}

/// Columns of the upper rows of a square RGBA picture that are not all white.
std::vector<int> inked_columns(const std::vector<std::uint8_t>& rgba, int side, int rows) {
    std::vector<int> columns;
    for (int x = 0; x < side; ++x) {
        bool inked = false;
        for (int y = 0; y < rows; ++y) {
            const auto at = static_cast<std::size_t>(4 * (y * side + x));
            inked |= rgba[at] < 250 || rgba[at + 1] < 250 || rgba[at + 2] < 250;
        }
        if (inked) columns.push_back(x);
    }
    return columns;
}

TEST_F(CommandLine, AnimationHasRoomForEveryFrame) {
    folder_.write("run.xyz", "1\n\nC 0 0 0\n1\n\nC 9 0 0\n1\n\nC 18 0 0\n");
    expect_done(run({"render", "run.xyz", "--frame", "0:", "-o", "#.png", "--size", "40x40",
                     "--view", "front", "--compose", "shaded", "--quiet"}));
    int last = 0;  // column that the frame before ends at
    for (const char* name : {"0.png", "1.png", "2.png"}) {
        const std::vector<int> columns = inked_columns(pixels(file(name)), 40, 40);
        ASSERT_FALSE(columns.empty()) << name;
        EXPECT_GT(columns.front(), last) << name;
        last = columns.back();
    }
    EXPECT_LT(last, 39);
}

TEST_F(CommandLine, AnimationLeavesFinishedPicturesWhenItResumes) {
    folder_.write("run.xyz", kThreeFrames);
    const Arguments arguments{"render", "run.xyz", "--frame", "0:2",    "-o",
                              "#.png",  "--size",  "32x24",   "--quiet"};
    expect_done(run(arguments));
    const std::string whole = read_bytes(file("2.png"));
    folder_.write("1.png", "left alone");
    fs::remove(file("2.png"));
    Arguments again = arguments;
    again.push_back("--resume");
    expect_done(run(again));
    EXPECT_EQ(read_bytes(file("1.png")), "left alone");
    EXPECT_EQ(read_bytes(file("2.png")), whole);
}

TEST_F(CommandLine, TurntableGoesRoundAndFramesTheSceneFromEverySide) {
    folder_.write("rod.csv", "x,y,z,radius\n0,0,0,1\n9,0,0,1\n");
    for (const char* projection : {"", "auto"}) {
        expect_done(run({"render", "rod.csv", "--turntable", "4", "-o", "t#.png", "--size", "40x40",
                         "--view", "front", "--lines", "none", "--orthographic", projection,
                         "--compose", "shaded", "--quiet"}));
        // A quarter turn shows the rod from its end; half a turn shows it whole again.
        EXPECT_NE(read_bytes(file("t0.png")), read_bytes(file("t1.png")));
        EXPECT_TRUE(fs::exists(file("t3.png")));
        EXPECT_FALSE(fs::exists(file("t4.png")));
    }
}

TEST_F(CommandLine, TurntableLeavesRoomForTheLegend) {
    folder_.write("rod.csv", "x,y,z,radius,heat\n0,0,0,1,1\n9,0,0,1,7\n");
    constexpr int kSide = 256;
    expect_done(run({"render", "rod.csv", "--turntable", "4", "-o", "t#.png", "--size", "256x256",
                     "--view", "front", "--lines", "none", "--color-by", "heat", "--quiet"}));
    for (const char* name : {"t0.png", "t2.png"}) {
        // Above the middle there is the rod alone; the legend is 33 pixels wide with its margin.
        const std::vector<int> columns = inked_columns(pixels(file(name)), kSide, kSide / 2);
        ASSERT_FALSE(columns.empty()) << name;
        EXPECT_LT(columns.back(), kSide - 33) << name;
        EXPECT_LT(columns.front(), 20) << name;
    }
}

TEST_F(CommandLine, FilmHasAPictureAFrame) {
    if (std::system("ffprobe -version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no ffmpeg here";
    folder_.write("run.xyz", kThreeFrames);
    expect_done(run({"render", "run.xyz", "--frame", "0:", "-o", "run.mp4", "--size", "64x49",
                     "--fps", "10", "--quiet"}));
    EXPECT_EQ(files(), (std::set<std::string>{"run.mp4", "run.xyz"}));
    const std::string ask = fmt::format(
        "ffprobe -v error -count_frames -show_entries stream=width,height,r_frame_rate,"
        "nb_read_frames -of csv=p=0 {} > {}",
        file("run.mp4").string(), file("said.txt").string());
    ASSERT_EQ(std::system(ask.c_str()), 0);
    EXPECT_EQ(read_bytes(file("said.txt")).substr(0, 13), "64,48,10/1,3\n");
}

TEST_F(CommandLine, FilmNeedsFramesAndFfmpegAndLeavesNothingWithoutThem) {
    folder_.write("run.xyz", kThreeFrames);
    const Outcome still = run({"render", "run.xyz", "-o", "run.mp4"});
    EXPECT_EQ(still.status, 2);
    expect_says(still.err, {"--frame A:B", "--turntable"});
    const char* const path = std::getenv("PATH");
    const std::string before = path == nullptr ? "" : path;
    setenv("PATH", "/nowhere", 1);
    const Outcome outcome = run({"render", "run.xyz", "--frame", "0:", "-o", "run.mp4"});
    setenv("PATH", before.c_str(), 1);
    EXPECT_EQ(outcome.status, 1);
    expect_says(outcome.err, {"run.mp4", "ffmpeg", "-o out_####.png"});
    EXPECT_EQ(files(), (std::set<std::string>{"run.xyz"}));
}

TEST_F(CommandLine, AnimationKeepsRadiiAndColoursThatAreChosen) {
    // Neighbours at distance 1, then 2; the last value of the field is the greatest of all.
    folder_.write("run.lammpstrj", [] {
        std::string text;
        for (const auto& [gap, value] : {std::pair{1, 5}, {2, 50}}) {
            text += fmt::format(
                "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n"
                "0 9\nITEM: ATOMS id x y z heat vx vy vz\n1 0 0 0 0 0 0 0\n2 {} 0 0 {} 0 {} 0\n",
                gap, value, -value);
        }
        return text;
    }());
    for (const char* field : {"heat", "v"}) {  // a column, and the length of three
        const auto draw = [&](const Arguments& more) {
            Arguments arguments{"render", "run.lammpstrj", "--view", "front",  "--size",
                                "48x48",  "--color-by",    field,    "--quiet"};
            arguments.insert(arguments.end(), more.begin(), more.end());
            expect_done(run(arguments));
        };
        draw({"--frame", "0:1", "-o", "a#.png"});
        draw({"--frame", "0:1", "-o", "b#.png", "--radius", "0.5", "--color-range", "0:50"});
        EXPECT_EQ(pixels(file("a0.png")), pixels(file("b0.png")));
        EXPECT_EQ(pixels(file("a1.png")), pixels(file("b1.png")));
    }
}

TEST_F(CommandLine, AnimationColoursKindsInFramesThatHaveOne) {
    folder_.write("run.lammpstrj", [] {
        std::string text;
        for (const int type : {1, 2, 1}) {
            text += fmt::format(
                "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n"
                "0 9\nITEM: ATOMS id type x y z\n1 1 0 0 0\n2 {} 1 0 0\n",
                type);
        }
        return text;
    }());
    const auto draw = [&](const Arguments& more) {
        Arguments arguments{"render", "run.lammpstrj", "--size", "48x48", "--quiet"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        expect_done(run(arguments));
    };
    draw({"--frame", "0:2", "-o", "a#.png"});
    draw({"--frame", "0:2", "-o", "b#.png", "--color-by", "type", "--colormap", "categories"});
    for (const char* name : {"0.png", "1.png", "2.png"}) {
        EXPECT_EQ(pixels(file(std::string("a") + name)), pixels(file(std::string("b") + name)));
    }
    // One kind in all of them is no reason for a colour.
    draw({"--frame", "0:0", "-o", "c#.png"});
    draw({"-o", "d.png"});
    EXPECT_EQ(pixels(file("c0.png")), pixels(file("d.png")));
    EXPECT_NE(pixels(file("a0.png")), pixels(file("d.png")));
}

TEST_F(CommandLine, LegendComesWithColoursOfNumbersUnlessItIsUnwanted) {
    folder_.write("a.csv", "x,y,z,radius,heat\n0,0,0,1,1\n3,0,0,1,7\n");
    const auto draw = [&](const char* name, const Arguments& more) {
        Arguments arguments{"render", "a.csv", "-o", name, "--size", "256x256", "--quiet"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        expect_done(run(arguments));
        return pixels(file(name));
    };
    const auto field = draw("a.png", {"--color-by", "heat"});
    EXPECT_EQ(field, draw("b.png", {"--color-by", "heat", "--legend", "bottom-right"}));
    EXPECT_NE(field, draw("c.png", {"--color-by", "heat", "--legend", "none"}));
    EXPECT_EQ(draw("d.png", {}), draw("e.png", {"--legend", "none"}));
    EXPECT_EQ(field, draw("f.png", {"--color-by", "heat"})) << "twice the same";
    // As curves, the words are paths of a layer of their own.
    expect_done(run(
        {"render", "a.csv", "-o", "a.svg", "--size", "256x256", "--color-by", "heat", "--quiet"}));
    expect_says(read_bytes(file("a.svg")), {"<g id=\"legend\""});
    // In a PDF they can be searched.
    expect_done(run(
        {"render", "a.csv", "-o", "a.pdf", "--size", "256x256", "--color-by", "heat", "--quiet"}));
    expect_says(read_bytes(file("a.pdf")), {"/ToUnicode", "/FontFile", "DejaVuSans"});
}

TEST_F(CommandLine, AnimationNeedsNumbersInTheNamesOfItsPictures) {
    folder_.write("run.xyz", kThreeFrames);
    for (const Arguments& flags : {Arguments{"--frame", "0:2"}, Arguments{"--turntable", "4"},
                                   Arguments{"--turntable", "4", "--frame", "0:2"}}) {
        Arguments arguments{"render", "run.xyz", "-o", "out.png"};
        arguments.insert(arguments.end(), flags.begin(), flags.end());
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.status, 2);
        expect_says(outcome.err, {"-o out_####.png"});
    }
}

TEST_F(CommandLine, SeriesOfFilesAreFramesInTheOrderPeopleCount) {
    folder_.write("run_2.xyz", "1\n\nC 2 0 0\n");
    folder_.write("run_10.xyz", "1\n\nC 10 0 0\n");
    folder_.write("run_1.xyz", "1\n\nC 1 0 0\n");
    const auto json =
        nlohmann::json::parse(run({"info", "--json", "run_*.xyz", "--frame", "2"}).out);
    EXPECT_EQ(json[0]["frames"], 3);
    EXPECT_NEAR(json[0]["lower"][0].get<double>(), 10 - 1.7, 1e-6);
    expect_says(run({"info", "none_*.xyz"}).err, {"none_*.xyz", "no file has such a name"});
}

}  // namespace
}  // namespace ink::test
