// The table of settings: what it reads, what it refuses, and what it says then.

#include "render/settings.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "inktrace/settings.h"

namespace ink::test {
namespace {

using Texts = std::vector<std::string_view>;

std::string get(const Settings& settings, std::string_view name) {
    return find_setting(name).get(settings);
}

Settings with(std::string_view name, std::string_view value) {
    Settings settings;
    find_setting(name).set(settings, value);
    return settings;
}

/// What `action` says when it throws UsageError.
template <class Action>
std::string refusal(const Action& action) {
    try {
        action();
    } catch (const UsageError& error) {
        return error.what();
    }
    return "(it was accepted)";
}

void expect_all(const std::string& message, const Texts& parts) {
    for (const std::string_view part : parts) {
        EXPECT_NE(message.find(part), std::string::npos) << "no '" << part << "' in: " << message;
    }
}

/// Values in the form that `get` gives, at least one for every setting.
const std::map<std::string_view, Texts> kValues{
    {"look", {"plain", "soft", "toon", "goodsell", "technical", "ink", "blueprint"}},
    {"ambient", {"", "0", "0.5", "1"}},
    {"ambient-quality", {"1", "5"}},
    {"light",
     {"", "camera:from=-1,1,1,size=10,strength=0.5",
      "sun:from=0,0,1,strength=1,color=#ff8000;sky:strength=0.3,ground=#402000",
      "disc:from=0,5,0,size=2,strength=1"}},
    {"shadows", {"none", "hard", "soft"}},
    {"pastel", {"0", "0.5"}},
    {"fog", {"0", "1"}},
    {"line-fade", {"0", "0.25"}},
    {"line-taper", {"0", "0.25"}},
    {"halo", {"0px", "2.5px", "1mm"}},
    {"size", {"1x1", "640x480", "65500x65500"}},
    {"dpi", {"1", "72", "299.5"}},
    {"background", {"#ffffff", "#102030", "transparent"}},
    {"compose", {"shaded", "lines", "both"}},
    {"legend", {"auto", "none", "top-left", "top-right", "bottom-left", "bottom-right"}},
    {"aov", {"none", "depth", "id,lines", "lines,id"}},
    {"frame", {"0", "7", "1073741823", "0:20", "5:"}},
    {"select", {"", "chain A and not water"}},
    {"assembly", {"", "1"}},
    {"clip", {"", "x=0:2", "x=-1.5:2,z=:5", "y=1e-09:"}},
    {"represent", {"spheres", "ball-and-stick", "sticks"}},
    {"stick-radius", {"", "0.2"}},
    {"radii", {"vdw", "bondi", "covalent"}},
    {"glyph", {"sphere", "box", "ellipsoid"}},
    {"glyph-field", {"", "F"}},
    {"radius", {"", "0.5", "diameter"}},
    {"color-by", {"", "chain", "velocity.x"}},
    {"colormap", {"viridis", "coolwarm"}},
    {"color-range", {"", "0:1", "-2.5:10000000000"}},
    {"view", {"auto", "front", "back", "left", "right", "top", "bottom", "iso"}},
    {"eye", {"", "0,0,0", "1.5,-2,1e+30"}},
    {"look-at", {"", "0,0,0", "-1e-07,0.1,3"}},
    {"up", {"", "0,1,0", "0,0,-1"}},
    {"fov", {"0.001", "30", "45.5", "170"}},
    {"orthographic", {"", "auto", "12.5", "1e-30"}},
    {"margin", {"0", "0.04", "0.45"}},
    {"method", {"edges", "stencil"}},
    {"lines", {"all", "none", "crease", "silhouette,intersection,self-occlusion,boundary"}},
    {"lattice", {"1", "2", "4"}},
    {"line-width", {"2px", "0.5pt", "0.3mm", "0.2%"}},
    {"line-density", {"0.05", "0.75", "1"}},
    {"hidden", {"none", "solid", "dashed", "dashed:6,2.5"}},
    {"hidden-layers", {"1", "4", "64"}},
    {"specular-depth", {"0", "4", "16"}},
    {"fill", {"auto", "none", "flat", "image"}},
    {"curve-tolerance", {"0.01", "0.1", "10"}},
    {"min-length", {"0px", "2.5px", "1mm", "0.5%"}},
    {"line-color", {"#000000", "#0a0b0c"}},
    {"line",
     {"", "crease:width=1px", "all@2:color=#ff0000,opacity=0.5",
      "silhouette:width=0.5pt;mesh@3:color=#000001", "hidden@2:opacity=0.5",
      "crease@2/1:width=1px;all/+:opacity=0.5"}},
    {"ids", {"", "primitive", "part", "object", "part:chain", "part:residue"}},
    {"metric", {"", "linear", "power:10", "power:2.5", "solid"}},
    {"quality", {"1", "3", "64"}},
    {"normals", {"auto", "shading", "geometric"}},
    {"ridge-scale", {"0.8%", "6px"}},
    {"ridge-turn", {"3", "0.5"}},
    {"crease-gradient", {"0.1", "0.25", "10"}},
    {"depth-jump", {"0.2", "0.5", "1000"}},
    {"line-blend", {"auto", "display", "linear"}},
    {"shade", {"lambert", "toon", "gooch", "flat", "none"}},
    {"material",
     {"", "specular=0.5", "2:color=#ff0000,metal=1", "color=#010203;lid:roughness=0.02"}},
    {"aa", {"", "none", "edges", "stencil", "multisample:1", "multisample:4096"}},
    {"threads", {"0", "1", "1024"}},
    {"tile", {"4", "64", "4096"}},
};

/// Values that make no sense, for every setting that can be refused one.
const std::map<std::string_view, Texts> kNonsense{
    {"look", {"fancy", "Soft"}},
    {"ambient", {"-0.1", "1.1", "much"}},
    {"ambient-quality", {"", "0", "6", "2.5"}},
    {"light", {"lamp", "sun:", "sun:from=1", "sun:from=0,0,0", "sky:size=2", "disc:strength=-1"}},
    {"shadows", {"", "dark"}},
    {"pastel", {"", "-1", "2"}},
    {"fog", {"", "-1", "2"}},
    {"line-fade", {"", "-1", "2"}},
    {"line-taper", {"", "-1", "2"}},
    {"halo", {"", "-1px", "wide"}},
    {"size",
     {"", "foo", "0x5", "5x0", "-1x5", "1000000x1000000", "65501x1", "5", "5x", "5x5x5", "1.5x2"}},
    {"dpi", {"", "0", "-72", "nan", "inf", "72dpi", "100001"}},
    {"background", {"", "#12", "whiteish", "0,0,256", "Transparent"}},
    {"compose", {"", "none", "shaded,lines"}},
    {"legend", {"", "left", "top"}},
    {"aov", {"", "colour"}},
    {"frame", {"", "-1", "1.5", "first", "1073741824", "3:2", ":4", "1:2:3"}},
    {"select", {"chain", "and", "(water"}},
    {"clip", {"x", "w=0:1", "x=1", "x=2:1", "x=a:b", "x=nan:1", "x=0:1;y=0:1"}},
    {"represent", {"", "shoe"}},
    {"stick-radius", {"0", "-1", "thick"}},
    {"radii", {"", "pauling"}},
    {"glyph", {"", "cube"}},
    {"glyph-field", {}},
    {"radius", {"0", "-1", "inf"}},
    {"colormap", {"", "jet"}},
    {"color-range", {"1", "1:0", ":1", "a:b"}},
    {"view", {"", "up", "Front"}},
    {"eye", {"0,0", "0,0,0,0", "0,0,x", "0,nan,0", "inf,0,0", "0 0 0"}},
    {"look-at", {"0,0", "middle"}},
    {"up", {"0,0", "y"}},
    {"fov", {"", "0", "-30", "170.5", "180", "nan", "30deg"}},
    {"orthographic", {"0", "-1", "fit", "nan", "inf"}},
    {"margin", {"", "-0.1", "0.5", "nan"}},
    {"method", {"", "magic"}},
    {"lines", {"", "crooked", "silhouette;intersection"}},
    {"lattice", {"", "0", "5", "1.5"}},
    {"line-width", {"", "0", "-1", "0px", "px", "nan", "inf", "2 cm", "2ptpx", "1e400"}},
    {"line-density", {"", "0", "1.5", "nan", "thin"}},
    {"hidden", {"", "dotted", "dashed:", "dashed:1", "dashed:0,1", "dashed:3,nan"}},
    {"hidden-layers", {"", "0", "65", "all"}},
    {"specular-depth", {"", "-1", "17", "all"}},
    {"fill", {"", "solid", "flat,image"}},
    {"curve-tolerance", {"", "0", "-1", "11", "nan", "0.1px"}},
    {"min-length", {"", "-1px", "nan", "short", "2km"}},
    {"line-color", {"", "#12345", "transparent", "1,2"}},
    {"line",
     {"crooked:width=1px", "crease", "crease:thickness=1", "crease:width=-1", "mesh:opacity=2",
      "mesh@0:width=1px", "mesh:red"}},
    {"ids", {"atom", "parts", "part:", "object:chain"}},
    {"metric", {"cubic", "power:", "power:0.5", "power:nan", "power:1001"}},
    {"quality", {"", "0", "65", "1.5", "high"}},
    {"normals", {"", "smooth"}},
    {"ridge-scale", {"", "0", "-1px", "wide"}},
    {"ridge-turn", {"", "0", "-1", "nan"}},
    {"crease-gradient", {"", "0", "-0.1", "nan", "11"}},
    {"depth-jump", {"", "0", "-0.1", "nan", "2e6"}},
    {"line-blend", {"", "srgb"}},
    {"shade", {"", "phong"}},
    {"material",
     {"shiny", "gloss=1", "specular=2", "roughness=0", "metal=nan", "color=reddish", ":metal=1",
      "2:metal"}},
    {"aa", {"multisample", "multisample:", "multisample:0", "multisample:4097", "fxaa"}},
    {"threads", {"", "-1", "1025", "all"}},
    {"tile", {"", "0", "2", "6", "66", "4100"}},
};

TEST(Settings, GiveTheirDefaultsInAFormThatTheyRead) {
    const Settings defaults;
    for (const Setting& row : settings_table()) {
        SCOPED_TRACE(row.name);
        Settings settings;
        ASSERT_NO_THROW(row.set(settings, row.get(defaults)));
        EXPECT_EQ(row.get(settings), row.get(defaults));
    }
}

TEST(Settings, GiveBackTheValuesThatTheyWereGiven) {
    for (const Setting& row : settings_table()) {
        SCOPED_TRACE(row.name);
        ASSERT_TRUE(kValues.contains(row.name)) << "give the new setting values above";
        for (const std::string_view value : kValues.at(row.name)) {
            EXPECT_EQ(get(with(row.name, value), row.name), value);
        }
    }
}

TEST(Settings, LeaveEachOtherAlone) {
    const Settings defaults;
    for (const Setting& row : settings_table()) {
        if (row.name == "look") continue;  // that is what it is for
        const Settings settings = with(row.name, kValues.at(row.name).back());
        for (const Setting& other : settings_table()) {
            if (other.name == row.name) continue;
            EXPECT_EQ(other.get(settings), other.get(defaults)) << row.name << " " << other.name;
        }
    }
}

TEST(Settings, CanBeMadeAutomaticAgain) {
    for (const char* name :
         {"eye", "look-at", "up", "orthographic", "ids", "metric", "aa", "line", "material"}) {
        Settings settings = with(name, kValues.at(name).back());
        EXPECT_NE(get(settings, name), "");
        find_setting(name).set(settings, "");
        EXPECT_EQ(get(settings, name), "") << name;
    }
}

TEST(Settings, RefuseNonsenseNamingTheFlagAndTheValue) {
    for (const Setting& row : settings_table()) {
        SCOPED_TRACE(row.name);
        // Whether these make sense, the file tells.
        if (row.name == "assembly" || row.name == "color-by") continue;
        ASSERT_TRUE(kNonsense.contains(row.name)) << "give the new setting bad values above";
        for (const std::string_view value : kNonsense.at(row.name)) {
            // Of power:0.5, the number.
            const std::string_view wrong = row.name == "metric" || row.name == "aa"
                                               ? value.substr(value.find(':') + 1)
                                               : value;
            const std::string refused = refusal([&] { with(row.name, value); });
            expect_all(refused, {fmt::format("--{}: ", row.name)});
            // It names the part that is wrong: see LineRules.
            if (!row.repeatable) expect_all(refused, {fmt::format("'{}'", wrong)});
        }
    }
}

TEST(Settings, KeepTheirValueWhenANewOneIsRefused) {
    for (const auto& [name, values] : kNonsense) {
        Settings settings = with(name, kValues.at(name).back());
        for (const std::string_view value : values) {
            EXPECT_THROW(find_setting(name).set(settings, value), UsageError);
            EXPECT_EQ(get(settings, name), kValues.at(name).back()) << value;
        }
    }
}

TEST(Settings, SayWhatIsAllowed) {
    const auto says = [](std::string_view name, std::string_view value) {
        return refusal([&] { with(name, value); });
    };
    expect_all(says("view", "up"), {"front", "back", "left", "right", "top", "bottom", "iso"});
    expect_all(says("size", "foo"), {"WIDTHxHEIGHT", "1024x768"});
    expect_all(says("size", "0x5"), {"from 1 to 65500"});
    expect_all(says("line-width", "0"), {"positive", "px, pt, mm or %"});
    expect_all(says("fov", "0"), {"from 0.001 to 170"});
    expect_all(says("eye", "1,2"), {"X,Y,Z"});
    expect_all(says("line-color", "reddish"), {"#rrggbb", "r,g,b"});
    expect_all(says("tile", "6"), {"multiple of 4"});
}

TEST(Settings, SuggestTheNearestNameForAnUnknownOne) {
    const auto says = [](std::string_view name) { return refusal([&] { find_setting(name); }); };
    expect_all(says("line-wdth"), {"'line-wdth'", "did you mean line-width?"});
    expect_all(says("lookat"), {"did you mean look-at?"});
    expect_all(says("temperature"), {"'temperature'", "see --help"});
    EXPECT_EQ(says("temperature").find("did you mean"), std::string::npos);
}

TEST(Settings, ReadWidthsWithoutAUnitAsPixels) {
    EXPECT_EQ(get(with("line-width", "2.5"), "line-width"), "2.5px");
    EXPECT_EQ(get(with("line-width", " 0.5 pt "), "line-width"), "0.5pt");
}

TEST(Settings, ReadColoursInEveryForm) {
    for (const char* text : {"red", "#f00", "#FF0000", "255,0,0"}) {
        EXPECT_EQ(get(with("line-color", text), "line-color"), "#ff0000") << text;
    }
}

TEST(ListSettings, KnowAllAndNone) {
    EXPECT_EQ(get(with("aov", "all"), "aov"), "id,depth,normal,position,lines");
    EXPECT_EQ(get(with("lines", "all"), "lines"), "all");
    EXPECT_EQ(get(with("lines", "none"), "lines"), "none");
}

TEST(ListSettings, NameTheWordThatIsNotInTheList) {
    const auto says = [](std::string_view value) { return refusal([&] { with("aov", value); }); };
    expect_all(says("id,colour,depth"), {"--aov: 'colour' is not one of id, depth, normal"});
    expect_all(says("id,"), {"--aov: ''", "go with commas"});
    expect_all(says("all,id"), {"'all'", "all and none stand alone"});
    expect_all(says("id,none"), {"'none'", "all and none stand alone"});
}

TEST(ListSettings, HoldEveryWordOnce) {
    EXPECT_EQ(get(with("aov", "id, depth,id"), "aov"), "id,depth");
}

TEST(SettingsTable, IsGroupedByTopicAndNamesEachRowOnce) {
    std::set<std::string_view> names;
    std::set<std::string_view> topics;
    std::string_view topic;
    for (const Setting& row : settings_table()) {
        EXPECT_TRUE(names.insert(row.name).second) << row.name;
        const bool begins = row.topic != topic;
        EXPECT_TRUE(!begins || topics.insert(row.topic).second) << row.topic;
        topic = row.topic;
        EXPECT_FALSE(row.value.empty()) << row.name;
        EXPECT_FALSE(row.help.empty()) << row.name;
        EXPECT_FALSE(row.help.ends_with('.')) << row.name;
    }
}

// ---- Lengths ----

TEST(Length, OfPixelsDependsOnNothing) {
    EXPECT_EQ((Length{2.5, Length::Unit::px}.pixels(300, 1024)), 2.5);
    EXPECT_EQ((Length{2.5, Length::Unit::px}.pixels(72, 10)), 2.5);
}

TEST(Length, OfSeventyTwoPointsIsAnInch) {
    for (const double dpi : {72.0, 300.0, 1200.0}) {
        EXPECT_DOUBLE_EQ((Length{72.0, Length::Unit::pt}.pixels(dpi, 1)), dpi);
    }
    EXPECT_DOUBLE_EQ((Length{0.5, Length::Unit::pt}.pixels(300, 1)), 0.5 * 300 / 72);
}

TEST(Length, OfTwentyFivePointFourMillimetresIsAnInch) {
    for (const double dpi : {72.0, 300.0, 1200.0}) {
        EXPECT_DOUBLE_EQ((Length{25.4, Length::Unit::mm}.pixels(dpi, 1)), dpi);
    }
    EXPECT_DOUBLE_EQ((Length{0.3, Length::Unit::mm}.pixels(300, 1)), 0.3 * 300 / 25.4);
}

TEST(Length, OfAHundredPercentIsThePicturesHeight) {
    EXPECT_DOUBLE_EQ((Length{100.0, Length::Unit::percent}.pixels(300, 768)), 768.0);
    EXPECT_DOUBLE_EQ((Length{0.2, Length::Unit::percent}.pixels(72, 1000)), 2.0);
}

TEST(LineWidth, FollowsDpiAndHeightOfThePicture) {
    Settings settings = with("line-width", "0.5pt");
    find_setting("dpi").set(settings, "600");
    EXPECT_DOUBLE_EQ(settings.line_width_px(), 0.5 * 600 / 72);
    find_setting("line-width").set(settings, "1%");
    find_setting("size").set(settings, "100x400");
    EXPECT_DOUBLE_EQ(settings.line_width_px(), 4.0);
}

// ---- Settings together ----

TEST(Validate, RefusesALineOfMoreThanAThousandPixels) {
    EXPECT_NO_THROW(validate(with("line-width", "1000px")));
    expect_all(refusal([] { validate(with("line-width", "100mm")); }),
               {"--line-width", "1181 pixels", "the most is 1000"});
}

/// The most bytes a pixel of a 1000 x 1000 picture that four fifths of the memory hold.
int most_bytes_a_pixel() {
    const double memory =
        static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
    return static_cast<int>(0.8 * memory / 1e6);
}

TEST(Validate, AllowsAPictureFourFifthsOfTheMemory) {
    const Settings settings = with("size", "1000x1000");
    EXPECT_NO_THROW(validate(settings, most_bytes_a_pixel()));
    expect_all(refusal([&] { validate(settings, most_bytes_a_pixel() + 1); }),
               {"--size: 1000x1000 needs", "this machine has", "GB of memory", "make it smaller"});
}

TEST(Validate, CountsThePlanesOfAovs) {
    const std::map<std::string_view, int> bytes{{"id", 12},       {"depth", 4},  {"normal", 12},
                                                {"position", 12}, {"lines", 20}, {"all", 60}};
    for (const auto& [aov, planes] : bytes) {
        SCOPED_TRACE(aov);
        Settings settings = with("size", "1000x1000");
        find_setting("aov").set(settings, aov);
        EXPECT_NO_THROW(validate(settings, most_bytes_a_pixel() - planes));
        expect_all(refusal([&] { validate(settings, most_bytes_a_pixel() - planes + 1); }),
                   {"--aov"});
    }
}

TEST(Validate, StatesWhatThePixelsNeed) {
    // A million bytes a pixel: beyond any machine.
    expect_all(refusal([] { validate(with("size", "65500x65500"), 1000000); }),
               {"65500x65500 needs 4290250.0 GB"});
}

TEST(LineRules, NameThePartThatMakesNoSense) {
    expect_all(refusal([] { with("line", "crooked:width=1px"); }), {"'crooked'", "self-occlusion"});
    expect_all(refusal([] { with("line", "crease:thickness=1"); }), {"'thickness'", "opacity"});
    expect_all(refusal([] { with("line", "crease"); }), {"'crease'", "key=value"});
    expect_all(refusal([] { with("line", "mesh:opacity=2"); }), {"'2'", "from 0 to 1"});
}

TEST(LineRules, AddUpAndReadColoursWithCommas) {
    Settings settings = with("line", "crease:color=255,0,0,width=2px");
    find_setting("line").set(settings, "all@2:opacity=0.25");
    EXPECT_EQ(get(settings, "line"), "crease:width=2px,color=#ff0000;all@2:opacity=0.25");
}

TEST(PublicSettings, CanBeAssignedToAfterTheyWereMovedFrom) {
    inktrace::Settings settings;
    settings.set("size", "20x10");
    const inktrace::Settings taken = std::move(settings);
    settings = taken;
    EXPECT_EQ(settings.get("size"), "20x10");
    settings = *&settings;
    EXPECT_EQ(settings.get("size"), "20x10");
}

}  // namespace
}  // namespace ink::test
