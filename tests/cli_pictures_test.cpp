// What is in the pictures that the program writes.

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "command_line.h"
#include "inktrace/inktrace.h"

namespace ink::test {
namespace {

// ---- AOVs ----

/// An EXR with every channel as floats; IDs fit.
struct Exr {
    std::map<std::string, std::vector<float>> channels;
    std::map<std::string, std::string> texts;
};

Exr read_exr(const fs::path& path) {
    Exr exr;
    Imf::InputFile in(path.c_str());
    const Imath::Box2i window = in.header().dataWindow();
    const auto width = static_cast<std::size_t>(window.max.x + 1);
    const auto height = static_cast<std::size_t>(window.max.y + 1);
    Imf::FrameBuffer frame;
    std::map<std::string, std::vector<unsigned>> integers;
    for (auto it = in.header().channels().begin(); it != in.header().channels().end(); ++it) {
        const auto insert = [&](Imf::PixelType type, auto& pixels) {
            pixels.resize(width * height);
            frame.insert(it.name(),
                         Imf::Slice(type, reinterpret_cast<char*>(pixels.data()), 4, 4 * width));
        };
        if (it.channel().type == Imf::UINT) {
            insert(Imf::UINT, integers[it.name()]);
        } else {
            insert(Imf::FLOAT, exr.channels[it.name()]);
        }
    }
    in.setFrameBuffer(frame);
    in.readPixels(window.min.y, window.max.y);
    for (const auto& [name, ids] : integers) exr.channels[name].assign(ids.begin(), ids.end());
    for (auto it = in.header().begin(); it != in.header().end(); ++it) {
        const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute());
        if (text != nullptr) exr.texts[it.name()] = text->value();
    }
    return exr;
}

constexpr const char* kEveryAov = "id,depth,normal,position,lines";

TEST_F(CommandLine, WritesAovsAsPicturesBesideAPng) {
    expect_done(render("a.png", {"--aov", kEveryAov}));
    EXPECT_EQ(files(), (std::set<std::string>{"a.png", "a.id.primitive.png", "a.id.part.png",
                                              "a.id.object.png", "a.depth.png", "a.normal.png",
                                              "a.position.png", "a.lines.png"}));
    for (const auto& [name, bytes] : contents()) {
        EXPECT_TRUE(bytes.starts_with("\x89PNG")) << name;
    }
}

TEST_F(CommandLine, WritesAovsAsChannelsOfAnExr) {
    expect_done(render("a.exr", {"--aov", kEveryAov}));
    EXPECT_EQ(files(), std::set<std::string>{"a.exr"});
    auto channels = read_exr(file("a.exr")).channels;
    std::set<std::string> names;
    for (const auto& [name, values] : channels) names.insert(name);
    EXPECT_EQ(names, (std::set<std::string>{"R",
                                            "G",
                                            "B",
                                            "A",
                                            "id.primitive",
                                            "id.part",
                                            "id.object",
                                            "Z",
                                            "N.X",
                                            "N.Y",
                                            "N.Z",
                                            "P.X",
                                            "P.Y",
                                            "P.Z",
                                            "line.A",
                                            "line.distance",
                                            "line.type",
                                            "line.id.near",
                                            "line.id.far",
                                            "line.level"}));
}

TEST_F(CommandLine, WritesOnlyTheAovsThatAreAskedFor) {
    expect_done(render("a.exr", {"--aov", "depth"}));
    std::set<std::string> names;
    for (const auto& [name, values] : read_exr(file("a.exr")).channels) names.insert(name);
    EXPECT_EQ(names, (std::set<std::string>{"R", "G", "B", "A", "Z"}));
}

TEST_F(CommandLine, WritesAovsThatAgreeOnWhatIsBackground) {
    expect_done(render("a.exr", {"--aov", kEveryAov}));
    auto channels = read_exr(file("a.exr")).channels;
    std::set<float> atoms;
    std::size_t background = 0;
    for (std::size_t i = 0; i < channels["Z"].size(); ++i) {
        const bool miss = std::isinf(channels["Z"][i]);
        background += miss ? 1 : 0;
        for (const char* level : {"id.primitive", "id.part", "id.object"}) {
            EXPECT_EQ(channels[level][i] == 0.0F, miss) << level << " of pixel " << i;
        }
        const float normal = std::hypot(channels["N.X"][i], channels["N.Y"][i], channels["N.Z"][i]);
        EXPECT_NEAR(normal, miss ? 0.0F : 1.0F, 1e-4F);
        if (!miss) atoms.insert(channels["id.primitive"][i]);
    }
    EXPECT_GT(background, 0U);
    EXPECT_LT(background, channels["Z"].size());
    EXPECT_GT(atoms.size(), 10U);
    EXPECT_LE(atoms.size(), 20U);
    const auto [least, most] = std::ranges::minmax(channels["line.A"]);
    EXPECT_EQ(least, 0.0F);
    EXPECT_GT(most, 0.5F);
    EXPECT_LE(most, 1.0F);
}

// ---- Metadata ----

std::map<std::string, std::string> png_texts(const fs::path& path) {
    std::FILE* stream = std::fopen(path.c_str(), "rb");
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, stream);
    png_read_info(png, info);
    png_textp chunks = nullptr;
    const int count = png_get_text(png, info, &chunks, nullptr);
    std::map<std::string, std::string> texts;
    for (int i = 0; i < count; ++i) texts[chunks[i].key] = chunks[i].text;
    png_destroy_read_struct(&png, &info, nullptr);
    std::fclose(stream);
    return texts;
}

const Arguments kFlags{"--line-width", "1.5",       "--view", "iso",    "--line-color",
                       "red",          "--threads", "2",      "--tile", "32"};
const std::string kFlagsThatMatter =
    "--size 64x48 --view iso --line-width 1.5px --line-color #ff0000";

TEST_F(CommandLine, KeepsTheSettingsThatMatterInAPng) {
    expect_done(render("a.png", kFlags));
    auto texts = png_texts(file("a.png"));
    EXPECT_EQ(texts["Software"], std::string("Inktrace ") + inktrace::version());
    EXPECT_EQ(texts["Settings"], kFlagsThatMatter);
}

TEST_F(CommandLine, KeepsTheSettingsThatMatterInAnExr) {
    expect_done(render("a.exr", kFlags));
    EXPECT_EQ(read_exr(file("a.exr")).texts["Settings"], kFlagsThatMatter);
}

TEST_F(CommandLine, DrawsTheSamePictureAgainFromTheSettingsInIt) {
    expect_done(render("a.png", kFlags));
    std::istringstream words(png_texts(file("a.png"))["Settings"]);
    Arguments again{"render", kSample, "-o", "b.png"};
    for (std::string word; words >> word;) again.push_back(word);
    expect_done(run(again));
    EXPECT_EQ(read_bytes(file("a.png")), read_bytes(file("b.png")));
}

// ---- The same bytes ----

class EveryAntiAliasing
    : public CommandLine,
      public testing::WithParamInterface<std::tuple<const char*, const char*, const char*>> {};

TEST_P(EveryAntiAliasing, GivesTheSameBytesForAnyNumberOfThreadsAndSizeOfTiles) {
    const auto& [extension, method, aa] = GetParam();
    std::map<std::string, std::string> first;
    for (const char* threads : {"1", "2", "3"}) {
        for (const char* tile : {"4", "32", "64", "200"}) {
            SCOPED_TRACE(fmt::format("--threads {} --tile {}", threads, tile));
            // Sides that tiles and blocks do not divide.
            expect_done(run({"render", kSample, "-o", std::string("a") + extension, "--size",
                             "67x49", "--method", method, "--aa", aa, "--aov", kEveryAov,
                             "--quality", "2", "--threads", threads, "--tile", tile}));
            if (first.empty()) first = contents();
            EXPECT_TRUE(contents() == first);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Written, EveryAntiAliasing,
                         testing::Combine(testing::Values(".png", ".exr"),
                                          testing::Values("edges", "stencil"),
                                          testing::Values("none", "stencil", "multisample:5")),
                         [](const auto& all) {
                             std::string name = std::string(std::get<0>(all.param) + 1) + "_" +
                                                std::get<1>(all.param) + "_" +
                                                std::get<2>(all.param);
                             std::ranges::replace(name, ':', '_');
                             return name;
                         });

}  // namespace
}  // namespace ink::test
