#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "inktrace/inktrace.h"
#include "test_files.h"

namespace ink::test {
namespace {

using inktrace::Error;

/// A scene file of these contents; its objects are loaded.
class SceneFile {
  public:
    explicit SceneFile(std::string_view text, const std::string& name = "scene.json")
        : path_(folder_.write(name, text)) {}

    inktrace::FileInfo load() const { return inktrace::Scene().load(path_); }
    auto settings() const { return inktrace::scene_file_settings(path_); }
    std::string folder() const { return path_.parent_path().string(); }

    /// What loading it, settings first, complains of; without the path.
    std::string complaint() const {
        try {
            settings();
            load();
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), Error::Kind::input);
            const std::string text = error.what();
            EXPECT_TRUE(text.starts_with(path_.string())) << text;
            return text.substr(path_.string().size());
        }
        return "none";
    }

  private:
    TemporaryFolder folder_;
    std::filesystem::path path_;
};

void expect_complaint(std::string_view text, std::string_view start, std::string_view within = {}) {
    const std::string complaint = SceneFile(text).complaint();
    EXPECT_TRUE(complaint.starts_with(start)) << complaint;
    EXPECT_NE(complaint.find(within), std::string::npos) << complaint;
}

TEST(SceneFile, PutsEachShapeWhereItsKeysSay) {
    struct Case {
        std::string object;
        std::array<double, 3> lower, upper;
    };
    const std::vector<Case> cases{
        {R"({"type": "sphere", "center": [1, 2, 3], "radius": 0.5})",
         {0.5, 1.5, 2.5},
         {1.5, 2.5, 3.5}},
        {R"({"type": "box", "size": [2, 4, 6]})", {-1, -2, -3}, {1, 2, 3}},
        {R"({"type": "box", "size": [2, 4, 6], "rotate": [0, 0, 1, 90]})", {-2, -1, -3}, {2, 1, 3}},
        {R"({"type": "box", "axes": [[1, 1, 0], [0, 1, 0], [0, 0, 1]]})", {-1, -2, -1}, {1, 2, 1}},
        {R"({"type": "cylinder", "from": [0, 0, 0], "to": [0, 5, 0], "radius": 1})",
         {-1, 0, -1},
         {1, 5, 1}},
        {R"({"type": "cone", "from": [0, 0, 0], "to": [0, 0, 2], "radius": 1})",
         {-1, -1, 0},
         {1, 1, 2}},
        {R"({"type": "disc", "normal": [0, 3, 0], "radius": 2})", {-2, 0, -2}, {2, 0, 2}},
        {R"({"type": "rectangle", "center": [0, 0, 7], "size": [2, 4]})", {-1, -2, 7}, {1, 2, 7}},
        {R"({"type": "torus", "radius": 2, "tube": 0.5})", {-2.5, -2.5, -0.5}, {2.5, 2.5, 0.5}},
        {R"({"type": "ellipsoid", "radii": [1, 2, 3]})", {-1, -2, -3}, {1, 2, 3}},
        {R"({"type": "superellipsoid", "radii": [1, 2, 3], "roundness": [0.2, 1]})",
         {-1, -2, -3},
         {1, 2, 3}},
        {R"({"type": "gaussian", "size": [2, 2, 1], "sigma": 0.3})", {-1, -1, 0}, {1, 1, 1}},
        {R"({"type": "waves", "size": [2, 2, 1], "waves": [3, 0]})", {-1, -1, -0.5}, {1, 1, 0.5}},
        {R"({"type": "hexahedron", "corners": [[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0,0,2],[1,0,2],[1,1,2],[0,1,2]]})",
         {0, 0, 0},
         {1, 1, 2}},
        {R"({"type": "glyphs", "shape": "ellipsoid", "glyphs": [[5,0,0, 1,0,0, 0,2,0, 0,0,1], [9,0,0, 1,0,0, 0,1,0, 0,0,1]]})",
         {4, -2, -1},
         {10, 2, 1}},
        {R"({"type": "mesh", "vertices": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "faces": [[0,1,2,3]]})",
         {0, 0, 0},
         {1, 1, 0}}};
    for (const Case& one : cases) {
        SCOPED_TRACE(one.object);
        const inktrace::FileInfo info = SceneFile("{\"objects\": [" + one.object + "]}").load();
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(info.lower[k], one.lower[k], 1e-5);
            EXPECT_NEAR(info.upper[k], one.upper[k], 1e-5);
        }
    }
}

TEST(SceneFile, TakesEverySettingThatTheCommandLineTakes) {
    std::string text = "{\"settings\": {";
    for (const inktrace::SettingInfo& info : inktrace::all_settings()) {
        if (info.default_value.empty()) continue;
        text +=
            (text.back() == '{' ? "\"" : ", \"") + info.name + "\": \"" + info.default_value + "\"";
    }
    text += "}, \"objects\": [{\"type\": \"sphere\", \"radius\": 1}]}";
    EXPECT_EQ(SceneFile(text).complaint(), "none");
}

TEST(SceneFile, GivesSettingsAsNumbersListsAndWords) {
    const SceneFile scene(
        R"({"settings": {"fov": 20, "eye": [0, 0.5, -3], "line-width": "2px", "lines": ["crease", "silhouette"]},
            "objects": []})");
    const std::vector<std::pair<std::string, std::string>> expected{
        {"fov", "20"}, {"eye", "0,0.5,-3"}, {"line-width", "2px"}, {"lines", "crease,silhouette"}};
    EXPECT_EQ(scene.settings(), expected);
}

TEST(SceneFile, HasLightsOfItsOwnAndLooksBeforeWhatChangesThem) {
    const SceneFile scene(
        R"({"settings": {"fog": 0.2, "look": "goodsell"},
            "lights": [{"type": "camera", "from": [-1, 1, 1], "strength": 0.7},
                       {"type": "disc", "from": [0, 5, 0], "size": 2, "color": "#ffeedd"}],
            "objects": []})");
    const std::vector<std::pair<std::string, std::string>> expected{
        {"look", "goodsell"},
        {"fog", "0.2"},
        {"light", "camera:from=-1,1,1,strength=0.7"},
        {"light", "disc:from=0,5,0,size=2,color=#ffeedd"}};
    EXPECT_EQ(scene.settings(), expected);
    inktrace::Settings settings;
    for (const auto& [name, value] : expected) settings.set(name, value);
    EXPECT_EQ(settings.get("fog"), "0.2");
    EXPECT_EQ(settings.get("shade"), "flat");
    inktrace::Settings again;
    for (const auto& [name, value] : settings.changed()) again.set(name, value);
    EXPECT_EQ(again.changed(), settings.changed());
}

TEST(SceneFile, ReadsFilesBesideItself) {
    TemporaryFolder folder;
    folder.write("water.xyz", "3\n\nO 0 0 0\nH 1 0 0\nH 0 1 0\n");
    const auto file = folder.write("scene.json", R"({"objects": [
        {"type": "input", "file": "water.xyz"},
        {"type": "input", "file": "water.xyz", "translate": [100, 0, 0], "scale": 2}]})");
    inktrace::Scene scene;
    const inktrace::FileInfo info = scene.load(file);
    EXPECT_EQ(scene.primitive_count(), 6U);
    EXPECT_NEAR(info.upper[0], 100 + 2 * (1 + 1.1), 0.1);
}

TEST(SceneFile, NamesLineAndKeyOfWhatIsWrong) {
    expect_complaint("{\n\"objects\": [\n{\"type\": \"sphere\",\n\"radius\": -1\n}]}",
                     ":4: objects[0].radius:", "above 0");
    expect_complaint("{\"objects\": [{\"type\": \"sphere\"}]}",
                     ":1: objects[0]:", "\"radius\" is missing");
    expect_complaint("{\"objects\": [\n{\"type\": \"torus\", \"radius\": 1,\n\"tub\": 2}]}",
                     ":3: objects[0].tub:", "\"tube\"");
    expect_complaint("{\"objects\": [{\"type\": \"torus\", \"radius\": 1, \"tube\": 2}]}",
                     ":1: objects[0].tube:", "smaller");
    expect_complaint("{\"objects\": [{\"type\": \"bal\", \"radius\": 1}]}",
                     ":1: objects[0].type:", "sphere");
    expect_complaint("{\"objects\": []}", ":1: objects:", "empty");
    expect_complaint("{\"object\": []}", ":1: object:", "\"objects\"");
    expect_complaint("{}", ":1: ", "\"objects\"");
    expect_complaint("{\"settings\":\n{\"line-width\": \"wide\"}, \"objects\": []}",
                     ":2: settings.line-width:", "'wide'");
    expect_complaint("{\"settings\": {\"line-widht\": 2}}",
                     ":1: settings.line-widht:", "line-width");
    expect_complaint("{\"settings\": {\"eye\": {}}}", ":1: settings.eye:", "expected");
    expect_complaint("{\"lights\": [{\"type\": \"lamp\"}]}", ":1: lights[0].type:", "disc");
    expect_complaint("{\"lights\": [{\"type\": \"sun\",\n\"strength\": -1}]}",
                     ":2: lights[0].strength:", "-1");
    expect_complaint("{\"lights\": [{\"type\": \"sky\", \"size\": 1}]}",
                     ":1: lights[0].size:", "ground");
    expect_complaint(
        "{\"objects\": [{\"type\": \"sphere\", \"radius\": 1, \"color\": \"reddish\"}]}",
        ":1: objects[0].color:", "'reddish'");
    expect_complaint(
        "{\"objects\": [{\"type\": \"sphere\", \"radius\": 1, \"material\": \"gold\"}]}",
        ":1: objects[0].material:", "'gold'");
    expect_complaint("{\"objects\": [{\"type\": \"sphere\", \"radius\": 1, \"ids\": \"all\"}]}",
                     ":1: objects[0].ids:", "primitive");
    expect_complaint("{\"objects\": [{\"type\": \"box\", \"axes\": [[1,0,0],[0,1,0],[1,1,0]]}]}",
                     ":1: objects[0].axes:", "plane");
    // The third is twice the first but for rounding.
    expect_complaint(
        "{\"objects\": [{\"type\": \"glyphs\", \"shape\": \"box\", \"glyphs\": "
        "[[0,0,0, 1,0,0, 0,1,0, 0,0,1], [0,0,0, 0.15,0.15,0.15, 0,-0.3,0.15, -0.3,-0.3,-0.3]]}]}",
        ":1: objects[0].glyphs[1]:", "plane");
    expect_complaint(
        "{\"objects\": [{\"type\": \"mesh\", \"vertices\": [[0,0,0],[1,0,0],[0,1,0]], \"faces\": "
        "[[0,1,3]]}]}",
        ":1: objects[0].faces[0][2]:", "from 0 to 2");
    expect_complaint("{\"objects\": [{\"type\": \"input\", \"file\": \"other.json\"}]}",
                     ":1: objects[0].file:", "another");
    expect_complaint("{\"inktrace\": 2, \"objects\": []}", ":1: inktrace:", "version 1");
}

TEST(SceneFile, RefusesWhatIsNotJson) {
    expect_complaint("{\"objects\": [\n1, 2,\n}", ":3: ", "not JSON");
    expect_complaint("{\"objects\": []} x", ":1: ", "not JSON");
    expect_complaint("[1, 2", ":1: ", "not JSON");
    expect_complaint("nan", ":1: ", "not JSON");
    expect_complaint("{\"settings\": {}, \"settings\": {}}", ":1: ", "twice");
    expect_complaint("{\"objects\": [{\"type\": \"sphere\", \"radius\": 1e999}]}", ":1: ");
    expect_complaint(std::string(100, '[') + std::string(100, ']'), ":1: ", "brackets");
    expect_complaint("\"\xff\xfe\"", ":1: ", "not JSON");
    expect_complaint("7", ":1: ", "expected an object");
}

}  // namespace
}  // namespace ink::test
