// How the program ends on bad input and bad usage, and what it says.

#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "command_line.h"

namespace ink::test {
namespace {

constexpr std::string_view kXyz = "2\ncarbon monoxide\nC 0 0 0\nO 0 1.2 0\n";

/// A mistake, and the parts of the message that name it, say what is wrong and what to do.
struct Mistake {
    const char* name;
    Arguments arguments;
    std::vector<std::string> says;
};

void PrintTo(const Mistake& mistake, std::ostream* out) { *out << mistake.name; }

std::string name_of(const testing::TestParamInfo<Mistake>& mistake) { return mistake.param.name; }

class AnyMistake : public CommandLine, public testing::WithParamInterface<Mistake> {
  protected:
    void expect_refused(int status) const {
        const auto before = contents();
        const Outcome outcome = run(GetParam().arguments);
        EXPECT_EQ(outcome.status, status) << outcome.err;
        EXPECT_EQ(outcome.out, "");
        EXPECT_EQ(outcome.err.find("inktrace: "), 0U) << outcome.err;
        expect_says(outcome.err, GetParam().says);
        EXPECT_EQ(contents(), before);
    }
};

class BadInput : public AnyMistake {
  protected:
    void SetUp() override {
        folder_.write("good.xyz", kXyz);
        folder_.write("empty.xyz", "");
        folder_.write("unknown.foo", kXyz);
        folder_.write("bare", kXyz);
        folder_.write("no_atoms.xyz", "0\nnothing\n");
        folder_.write("nan.xyz", "2\n\nC 0 0 0\nO 0 nan 0\n");
        fs::create_directory(file("folder.xyz"));
        fs::create_directory(file("folder.png"));
    }
};

TEST_P(BadInput, EndsWithStatus1NamesFileProblemAndRemedyAndLeavesNoFile) { expect_refused(1); }

Mistake draw(const char* name, std::string input, std::string output,
             std::vector<std::string> says) {
    return {name, {"render", std::move(input), "-o", std::move(output)}, std::move(says)};
}

INSTANTIATE_TEST_SUITE_P(
    Render, BadInput,
    testing::Values(
        draw("missing_input", "missing.xyz", "a.png",
             {"missing.xyz: ", "no such file", "check the path"}),
        draw("directory_as_input", "folder.xyz", "a.png",
             {"folder.xyz: ", "is a directory", "name a file"}),
        draw("empty_file", "empty.xyz", "a.png", {"empty.xyz: ", "is empty", "written to the end"}),
        draw("unknown_extension", "unknown.foo", "a.png",
             {"unknown.foo: ", "cannot tell the format from '.foo'", "expected one of", ".pdb"}),
        draw("no_extension", "bare", "a.png",
             {"bare: ", "no extension", "expected one of", ".xyz"}),
        draw("file_without_atoms", "no_atoms.xyz", "a.png",
             {"no_atoms.xyz: ", "holds no atoms", "coordinates"}),
        draw("coordinate_that_is_no_number", "nan.xyz", "a.png",
             {"nan.xyz:4: ", "coordinate y 'nan' is not a number", "repair or remove"}),
        draw("missing_output_folder", "good.xyz", "missing/a.png",
             {"missing/a.png: ", "does not exist", "create it or choose another"}),
        draw("output_below_a_file", "good.xyz", "good.xyz/a.png",
             {"good.xyz/a.png: ", "is not a folder", "choose another place"}),
        draw("output_that_is_a_folder", "good.xyz", "folder.png",
             {"folder.png: ", "names a folder", "add a file name"}),
        Mistake{"frame_that_is_not_there",
                {"render", "good.xyz", "-o", "a.png", "--frame", "3"},
                {"good.xyz: ", "has no frame 3", "its only frame is 0"}},
        Mistake{"second_input_missing",
                {"render", "good.xyz", "missing.xyz", "-o", "a.png"},
                {"missing.xyz: ", "no such file", "check the path"}},
        Mistake{"value_in_two_words",
                {"render", "good.xyz", "-o", "a.png", "--lines", "silhouette", "crease"},
                {"crease: ", "no such file", "silhouette,crease"}},
        Mistake{"missing_statistics_folder",
                {"render", "good.xyz", "-o", "a.png", "--stats", "missing/s.json"},
                {"missing/s.json: ", "cannot write the statistics", "check that the folder"}},
        Mistake{"statistics_that_are_a_folder",
                {"render", "good.xyz", "-o", "a.png", "--stats", "folder.png"},
                {"folder.png: ", "cannot write the statistics", "check that the folder"}}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    Info, BadInput,
    testing::Values(Mistake{"missing_input",
                            {"info", "missing.xyz"},
                            {"missing.xyz: ", "no such file", "check the path"}},
                    Mistake{"missing_input_as_json",
                            {"info", "--json", "good.xyz", "missing.xyz"},
                            {"missing.xyz: ", "no such file", "check the path"}},
                    Mistake{"frame_that_is_not_there",
                            {"info", "good.xyz", "--frame", "3"},
                            {"good.xyz: ", "has no frame 3", "its only frame is 0"}}),
    name_of);

class BadUsage : public AnyMistake {};

TEST_P(BadUsage, EndsWithStatus2NamesFlagProblemAndRemedyAndLeavesNoFile) { expect_refused(2); }

Mistake draw_with(const char* name, const Arguments& flags, std::vector<std::string> says) {
    Arguments arguments{"render", kSample, "-o", "a.png"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    return {name, arguments, std::move(says)};
}

const std::string kSeeHelp = "See 'inktrace --help' and 'inktrace render --help'";

INSTANTIATE_TEST_SUITE_P(
    Program, BadUsage,
    testing::Values(
        Mistake{"no_command", {}, {"a file to draw or a command is missing", kSeeHelp}},
        Mistake{"unknown_command",
                {"rendr", kSample, "-o", "a.png"},
                {"'rendr'", "did you mean render?", kSeeHelp}},
        Mistake{"unknown_flag_before_the_command",
                {"--versio"},
                {"'--versio'", "did you mean --version?", kSeeHelp}},
        Mistake{"unknown_flag_of_info",
                {"info", "--jsn", kSample},
                {"'--jsn'", "did you mean --json?", kSeeHelp}},
        Mistake{"negative_frame_of_info", {"info", "--frame", "-1", kSample}, {"--frame", "-1"}},
        Mistake{"no_input", {"render", "-o", "a.png"}, {"INPUT is required", kSeeHelp}},
        draw("output_with_unknown_extension", kSample, "a.foo",
             {"a.foo: ", "cannot tell the picture's format",
              ".png, .jpg, .tiff, .exr, .svg, .svgz or .pdf"}),
        draw("output_without_extension", kSample, "a",
             {"a: ", "cannot tell the picture's format",
              ".png, .jpg, .tiff, .exr, .svg, .svgz or .pdf"})),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    Flags, BadUsage,
    testing::Values(
        draw_with("unknown_flag", {"--line-wdth", "3"},
                  {"'--line-wdth'", "did you mean --line-width?", kSeeHelp}),
        draw_with("unknown_flag_with_its_value", {"--line-wdth=3"},
                  {"'--line-wdth'", "did you mean --line-width?", kSeeHelp}),
        draw_with("unknown_flag_that_is_no_setting", {"--quite"},
                  {"'--quite'", "did you mean --quiet?", kSeeHelp}),
        draw_with("short_flag_with_two_dashes", {"--o", "b.png"},
                  {"'--o'", "did you mean -o?", kSeeHelp}),
        draw_with("unknown_short_flag", {"-x"}, {"'-x'", kSeeHelp}),
        draw_with("flag_without_its_value", {"--size"}, {"--size", "WxH missing", kSeeHelp}),
        draw_with("size_with_zero", {"--size", "0x5"}, {"--size: ", "'0x5'", "from 1 to 65500"}),
        draw_with("size_beyond_every_format", {"--size", "1000000x1000000"},
                  {"--size: ", "'1000000x1000000'", "from 1 to 65500"}),
        draw_with("size_that_is_no_size", {"--size", "foo"},
                  {"--size: ", "'foo' is not a size", "WIDTHxHEIGHT"}),
        draw_with("size_in_millimetres", {"--size", "85mmx60mm"},
                  {"--size: ", "'85mmx60mm' is not a size", "WIDTHxHEIGHT in pixels"}),
        draw_with("background_none", {"--background", "none"},
                  {"--background: ", "'none' is not a colour", "write transparent, a name"}),
        draw_with("line_width_zero", {"--line-width", "0"},
                  {"--line-width: ", "'0' is not a width", "a positive number"}),
        draw_with("line_width_negative", {"--line-width", "-1"},
                  {"--line-width: ", "'-1' is not a width", "a positive number"}),
        draw_with("line_width_beyond_reason", {"--line-width", "100mm"},
                  {"--line-width: ", "comes to 1181 pixels", "the most is 1000"}),
        draw_with("fov_zero", {"--fov", "0"}, {"--fov: ", "'0'", "from 0.001 to 170"}),
        draw_with("eye_at_look_at", {"--eye", "1,2,3", "--look-at", "1,2,3"},
                  {"--eye and --look-at", "the same point", "move one"}),
        draw_with("up_without_length", {"--up", "0,0,0"}, {"--up", "no length", "0,1,0"}),
        draw_with("eye_that_is_no_point", {"--eye", "1,2"}, {"--eye: ", "'1,2'", "X,Y,Z"}),
        draw_with("unknown_view", {"--view", "above"},
                  {"--view: ", "'above' is not one of", "front, back, left"}),
        draw_with("unknown_line_type", {"--lines", "crooked"},
                  {"--lines: ", "'crooked' is not one of", "silhouette"}),
        draw_with("unknown_colour", {"--line-color", "reddish"},
                  {"--line-color: ", "'reddish' is not a colour", "#rrggbb"}),
        draw_with("unknown_aov", {"--aov", "depth,colour"},
                  {"--aov: ", "'colour' is not one of", "go with commas"}),
        draw_with("unknown_aa", {"--aa", "fxaa"}, {"--aa: ", "'fxaa'", "multisample:S"}),
        draw_with("repeat_zero", {"--repeat", "0"}, {"--repeat: ", "0", "1 to 1000000"}),
        draw_with("threads_negative", {"--threads", "-1"}, {"--threads: ", "'-1'", "0 to 1024"})),
    name_of);

}  // namespace
}  // namespace ink::test
