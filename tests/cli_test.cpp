// The program as people and scripts run it: what it writes, what it says, how it ends.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "command_line.h"
#include "inktrace/inktrace.h"

namespace ink::test {
namespace {

constexpr std::string_view kXyz = "2\ncarbon monoxide\nC 0 0 0\nO 0 1.2 0\n";
constexpr std::string_view kStl =
    "solid pair\n"
    "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 2 0 0\nendloop\nendfacet\n"
    "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 0 3\nendloop\nendfacet\n"
    "endsolid pair\n";

// ---- Errors ----

TEST_F(CommandLine, RefusesAPictureThatDoesNotFitIntoMemoryBeforeItReadsTheInput) {
    constexpr double kNeeded = 326.1e9;  // 65500 x 65500 pixels, 19 numbers of 4 bytes each
    if (static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE)) *
            0.8 >
        kNeeded) {
        GTEST_SKIP() << "it would fit into this machine";
    }
    const Outcome outcome =
        run({"render", "missing.xyz", "-o", "a.exr", "--size", "65500x65500", "--aov", "all"});
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    expect_says(outcome.err, {"--size: 65500x65500 needs 326.1 GB", "this machine has", "smaller"});
    EXPECT_EQ(files(), std::set<std::string>{});
}

TEST_F(CommandLine, DrawsAFileThatIsNamedAlone) {
    fs::create_directory(file("molecules"));
    folder_.write("molecules/water.xyz", kXyz);
    const Outcome outcome = run({"molecules/water.xyz", "--size", "64x48"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(files(), (std::set<std::string>{"molecules", "molecules/water.xyz", "water.png"}));
}

TEST_F(CommandLine, OverwritesNoPictureThatWasNotNamed) {
    folder_.write("water.xyz", kXyz);
    folder_.write("water.png", "somebody's");
    const Outcome outcome = run({"render", "water.xyz"});
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    expect_says(outcome.err, {"water.png exists", "-o"});
    EXPECT_EQ(fs::file_size(file("water.png")), 10U);
}

TEST_F(CommandLine, LeavesNothingOnADiskThatIsFull) {
    fs::create_symlink("/dev/full", file("full.png"));
    const Outcome outcome = render("full.png");
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    expect_says(outcome.err, {"full.png: ", "no space left", "free some"});
    EXPECT_EQ(files(), std::set<std::string>{"full.png"});
}

TEST_F(CommandLine, DrawsLinesAsCurves) {
    const Outcome outcome = run({"render", kSample, "-o", "a.svg", "--lines-json", "a.json",
                                 "--size", "200x150", "--line-width", "2"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(files(), (std::set<std::string>{"a.svg", "a.json"}));
    const std::string svg = read_bytes(file("a.svg"));
    expect_says(svg, {"viewBox=\"0 0 200 150\"", "stroke-width=\"2\"", "id=\"regions\"",
                      "--size 200x150 --line-width 2px", "</svg>"});
    const auto json = nlohmann::json::parse(read_bytes(file("a.json")));
    EXPECT_EQ(json["format"], "inktrace-lines");
    EXPECT_GT(json["lines"].size(), 30U);

    // What curves cannot show is said.
    const Outcome soft = run({"render", kSample, "-o", "b.svg", "--size", "40x30", "--metric",
                              "linear", "--halo", "2px"});
    EXPECT_EQ(soft.status, 0);
    expect_says(soft.err, {"no soft profile", "--metric linear", "no halos", "--halo 2px"});
    expect_says(read_bytes(file("b.svg")), {"inktrace:Settings=", "</rdf:RDF>"});

    // The same text, packed: gzip's own tool unpacks it.
    EXPECT_EQ(run({"render", kSample, "-o", "c.svgz", "--size", "200x150"}).status, 0);
    EXPECT_EQ(run({"render", kSample, "-o", "c.svg", "--size", "200x150"}).status, 0);
    EXPECT_LT(fs::file_size(file("c.svgz")), fs::file_size(file("c.svg")) / 3);
    const std::string unpack =
        "gunzip -S z " + file("c.svgz").string() + " -c > " + file("unpacked.svg").string();
    EXPECT_EQ(std::system(unpack.c_str()), 0);
    EXPECT_EQ(read_bytes(file("unpacked.svg")), read_bytes(file("c.svg")));

    EXPECT_EQ(run({"render", kSample, "-o", "a.pdf", "--size", "200x150"}).status, 0);
    EXPECT_TRUE(read_bytes(file("a.pdf")).starts_with("%PDF-"));
}

TEST_F(CommandLine, MakesAPageOfThePapersFiguresAndTables) {
    const Outcome outcome = run({"gallery", "-o", "g", "--figures", "4"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::string page = read_bytes(file("g/index.html"));
    expect_says(page, {"<h2 id=\"Figure 4\">", "Table 1", "Table 2", "24.3", "</html>"});
    int pictures = 0;
    constexpr std::string_view kSource = "src=\"";
    for (auto at = page.find(kSource); at != std::string::npos; at = page.find(kSource, at + 1)) {
        const auto from = at + kSource.size();
        const std::string name = page.substr(from, page.find('"', from) - from);
        EXPECT_TRUE(fs::exists(file("g/" + name))) << name;
        ++pictures;
    }
    EXPECT_EQ(pictures, 3);
    // The caption's count of rays comes from the points themselves.
    expect_says(read_bytes(file("g/figure4-b.svg")), {"= 24,", "= 9</text>"});

    EXPECT_EQ(run({"gallery", "-o", "g", "--figures", "11"}).status, 2);
    // A missing mesh is found before anything is drawn.
    EXPECT_EQ(run({"gallery", "-o", "none", "--mesh", "missing.obj"}).status, 1);
    EXPECT_FALSE(fs::exists(file("none")));
}

TEST_F(CommandLine, WritesAovsBesideCurvesAsPictures) {
    EXPECT_EQ(run({"render", kSample, "-o", "a.svg", "--size", "40x30", "--aov", "depth"}).status,
              0);
    EXPECT_EQ(files(), (std::set<std::string>{"a.svg", "a.depth.png"}));
}

TEST_F(CommandLine, RefusesCurvesWithoutLocatedLines) {
    for (const Arguments& output :
         {Arguments{"a.svg"}, Arguments{"a.png", "--lines-json", "b.json"}}) {
        Arguments arguments{"render", kSample, "--method", "stencil", "-o"};
        arguments.insert(arguments.end(), output.begin(), output.end());
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.status, 2);
        expect_says(outcome.err, {"--method", "edges"});
    }
    EXPECT_EQ(files(), std::set<std::string>{});
}

TEST_F(CommandLine, ChecksTheFileForLinesBeforeItRenders) {
    const Outcome outcome = run({"render", kSample, "-o", "a.png", "--lines-json", "no/b.json"});
    EXPECT_EQ(outcome.status, 1);
    expect_says(outcome.err, {"no/b.json"});
    EXPECT_EQ(files(), std::set<std::string>{});
}

class EveryFormat : public CommandLine, public testing::WithParamInterface<const char*> {};

TEST_P(EveryFormat, LeavesNothingWhereFilesMayNotGrowAsLarge) {
    const std::string name = std::string("a") + GetParam();
    const Outcome outcome =
        run({"render", kSample, "-o", name, "--size", "64x48"}, {.largest_file = 500});
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    expect_says(outcome.err, {name + ": ", "larger than a file may be", "ulimit -f"});
    EXPECT_EQ(files(), std::set<std::string>{});
}

TEST_P(EveryFormat, KeepsAnOlderPictureWhenANewOneFails) {
    const std::string name = std::string("a") + GetParam();
    folder_.write(name, "older");
    const Outcome outcome =
        run({"render", kSample, "-o", name, "--size", "64x48"}, {.largest_file = 500});
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_EQ(contents(), (std::map<std::string, std::string>{{name, "older"}}));
}

INSTANTIATE_TEST_SUITE_P(Written, EveryFormat,
                         testing::Values(".png", ".jpg", ".tiff", ".exr", ".svg", ".svgz", ".pdf"),
                         [](const auto& format) { return std::string(format.param + 1); });

TEST_F(CommandLine, FailsWhereStandardOutputCannotBeWritten) {
    const Outcome outcome = run({"info", kSample}, {.out_full = true});
    EXPECT_EQ(outcome.status, 1);
    expect_says(outcome.err, {"standard output cannot be written", "check the disk"});
}

// ---- Version and help ----

TEST_F(CommandLine, TellsItsVersion) {
    const Outcome outcome = run({"--version"});
    expect_done(outcome);
    EXPECT_EQ(outcome.out, fmt::format("inktrace {}\n", inktrace::version()));
    EXPECT_EQ(outcome.err, "");
}

TEST_F(CommandLine, HelpListsCommandsAndFormats) {
    const Outcome outcome = run({"--help"});
    expect_done(outcome);
    expect_says(outcome.out, {"--help", "--version", "render", "info"});
    for (const auto& [name, extensions] : inktrace::input_formats()) {
        expect_says(outcome.out, {name, extensions});
    }
}

/// The lines of a help page by the heading above them.
std::map<std::string, std::vector<std::string>> sections(const std::string& help) {
    std::map<std::string, std::vector<std::string>> lines;
    std::istringstream in(help);
    std::string heading;
    for (std::string line; std::getline(in, line);) {
        if (line.ends_with(':') && !line.starts_with(' ')) {
            heading = line.substr(0, line.size() - 1);
        } else if (!line.empty()) {
            lines[heading].push_back(line);
        }
    }
    return lines;
}

TEST_F(CommandLine, HelpOfRenderListsEverySettingUnderItsTopic) {
    const Outcome outcome = run({"render", "--help"});
    expect_done(outcome);
    auto lines = sections(outcome.out);
    for (const inktrace::SettingInfo& info : inktrace::all_settings()) {
        const std::string start = fmt::format("  --{} {} ", info.name, info.value);
        const auto& topic = lines[info.topic];
        const auto line = std::ranges::find_if(
            topic, [&](const std::string& text) { return text.starts_with(start); });
        ASSERT_NE(line, topic.end()) << start << "is not under " << info.topic;
        EXPECT_NE(line->find(info.help), std::string::npos) << *line;
        if (info.default_value.empty()) continue;
        EXPECT_TRUE(line->ends_with(fmt::format("[{}]", info.default_value))) << *line;
    }
}

// ---- Info ----

TEST_F(CommandLine, InfoTellsWhatIsInAFile) {
    folder_.write("a.xyz", kXyz);
    folder_.write("b.stl", kStl);
    const Outcome outcome = run({"info", "a.xyz", "b.stl"});
    expect_done(outcome);
    expect_says(outcome.out, {"a.xyz", "XYZ (molecule)", "atoms       2", "angstrom", "b.stl",
                              "STL (mesh)", "triangles   2", "0 to 3"});
    EXPECT_EQ(outcome.err, "");
}

TEST_F(CommandLine, InfoNamesWhatCanBeSelected) {
    folder_.write("a.pdb",
                  "ATOM      1  CA  ALA A   1       0.000   0.000   0.000  1.00 10.00           C\n"
                  "ATOM      2  CA  GLY B   1       9.000   0.000   0.000  1.00 10.00           C\n"
                  "HETATM    3 FE   HEM B   2       5.000   5.000   0.000  1.00 10.00          FE\n"
                  "HETATM    4  NA  HEM B   2       5.000   7.000   0.000  1.00 10.00           N\n"
                  "HETATM    5 ZN    ZN B   3       5.000   9.000   0.000  1.00 10.00          ZN\n"
                  "END\n");
    expect_says(run({"info", "a.pdb"}).out,
                {"chains      2: A B", "ligands     HEM", "ions        ZN"});
    const auto json = nlohmann::json::parse(run({"info", "--json", "a.pdb"}).out);
    EXPECT_EQ(json[0]["names"]["chains"], (std::vector<std::string>{"A", "B"}));
    EXPECT_EQ(json[0]["names"]["ligands"], (std::vector<std::string>{"HEM"}));
    expect_done(run({"render", "a.pdb", "-o", "a.png", "--select", "chain A or resn HEM"}));
}

TEST_F(CommandLine, InfoTellsMachinesTheSame) {
    folder_.write("a.xyz", kXyz);
    folder_.write("b.stl", kStl);
    const Outcome outcome = run({"info", "--json", "a.xyz", "b.stl"});
    expect_done(outcome);
    const auto json = nlohmann::json::parse(outcome.out);
    ASSERT_EQ(json.size(), 2U);

    EXPECT_EQ(json[0]["file"], "a.xyz");
    EXPECT_EQ(json[0]["format"], "XYZ");
    EXPECT_EQ(json[0]["kind"], "molecule");
    EXPECT_EQ(json[0]["frames"], 1);
    EXPECT_EQ(json[0]["counts"]["atoms"], 2);
    EXPECT_EQ(json[0]["length_unit"], "angstrom");
    EXPECT_EQ(json[0]["warnings"].size(), 0U);
    const double carbon_radius = -json[0]["lower"][1].get<double>();
    EXPECT_GT(carbon_radius, 1.0);
    EXPECT_LT(carbon_radius, 2.0);

    EXPECT_EQ(json[1]["kind"], "mesh");
    EXPECT_EQ(json[1]["counts"]["triangles"], 2);
    EXPECT_EQ(json[1]["lower"], (std::vector<double>{0, 0, 0}));
    EXPECT_EQ(json[1]["upper"], (std::vector<double>{2, 1, 3}));
    EXPECT_EQ(json[1]["length_unit"], "");
}

TEST_F(CommandLine, InfoTellsTypesAndWhichColumnsAreWords) {
    folder_.write("a.csv", "x,y,z,radius,name,type\n0,0,0,1,sand,1\n3,0,0,1,clay,4\n");
    expect_says(
        run({"info", "a.csv"}).out,
        {"types       1 4", "field       name  words: clay sand", "field       type  1 to 4"});
    const auto json = nlohmann::json::parse(run({"info", "--json", "a.csv"}).out);
    EXPECT_EQ(json[0]["names"]["types"], (std::vector<std::string>{"1", "4"}));
    EXPECT_EQ(json[0]["fields"][1]["name"], "name");
    EXPECT_TRUE(json[0]["fields"][1]["least"].is_null());
    EXPECT_EQ(json[0]["fields"][1]["words"], (std::vector<std::string>{"clay", "sand"}));
    EXPECT_EQ(json[0]["fields"][2]["most"], 4.0);
}

TEST_F(CommandLine, InfoLooksAtTheFrameThatIsAskedFor) {
    folder_.write("a.xyz", std::string(kXyz) + "1\n\nN 9 9 9\n");
    const auto json = nlohmann::json::parse(run({"info", "--json", "a.xyz", "--frame", "1"}).out);
    EXPECT_EQ(json[0]["frames"], 2);
    EXPECT_EQ(json[0]["counts"]["atoms"], 1);
}

// ---- What a render says ----

TEST_F(CommandLine, SaysInOneLineWhatItWrote) {
    const Outcome outcome = render("a.png");
    expect_done(outcome);
    EXPECT_EQ(outcome.out, "");
    expect_says(outcome.err, {"a.png: 64 x 48 pixels, 20 primitives, "});
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1);
    folder_.write("one.xyz", "1\n\nC 0 0 0\n");
    const Outcome one = run({"render", "one.xyz", "-o", "b.png", "--size", "64x48"});
    expect_says(one.err, {" 1 primitive, "});
}

TEST_F(CommandLine, SaysNothingWhenQuiet) {
    const Outcome outcome = render("a.png", {"--quiet"});
    expect_done(outcome);
    EXPECT_EQ(outcome.out + outcome.err, "");
    EXPECT_EQ(files(), std::set<std::string>{"a.png"});
}

/// About half a second, in which a terminal would get a bar, and much longer.
const Arguments kSlow{"render",    kSample,  "-o",       "a.png",  "--size",
                      "256x256",   "--tile", "4",        "--aa",   "multisample:16",
                      "--quality", "2",      "--method", "stencil"};
const Arguments kEndless{"render",   kSample,   "-o",        "a.png", "--size",
                         "512x512",  "--tile",  "4",         "--aa",  "multisample:4096",
                         "--method", "stencil", "--quality", "16"};

TEST_F(CommandLine, DrawsNoProgressBarWhereThereIsNoTerminal) {
    const Outcome outcome = run(kSlow);
    expect_done(outcome);
    EXPECT_EQ(outcome.err.find_first_of("\r\033["), std::string::npos) << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
}

TEST_F(CommandLine, TakesTheLastOfAFlagThatIsRepeated) {
    const Outcome outcome = render("a.png", {"--size", "32x16"});
    expect_done(outcome);
    expect_says(outcome.err, {"32 x 16 pixels"});
}

TEST_F(CommandLine, WritesStatisticsForMachines) {
    expect_done(render("a.png", {"--stats", "s.json", "--repeat", "3", "--threads", "2"}));
    const auto json = nlohmann::json::parse(read_bytes(file("s.json")));
    EXPECT_EQ(json["width"], 64);
    EXPECT_EQ(json["height"], 48);
    EXPECT_EQ(json["threads"], 2);
    EXPECT_EQ(json["method"], inktrace::Settings().get("method"));
    EXPECT_EQ(json["primitives"], 20);
    EXPECT_GE(json["crossings"], 0);
    EXPECT_GT(json["peak_rss_bytes"], 1000000);
    // Every block of 4 x 4 pixels that the molecule touches takes sixteen rays and their stencils.
    EXPECT_GE(json["rays"], 16 * 9);
    for (const char* time : {"load_ms", "build_ms"}) EXPECT_GE(json[time], 0.0) << time;
    for (const char* times : {"render_ms", "trace_ms", "lines_ms"}) {
        ASSERT_EQ(json[times].size(), 3U) << times;
        for (const double ms : json[times]) EXPECT_GE(ms, 0.0) << times;
    }
    EXPECT_GT(json["render_ms"][0], json["trace_ms"][0]);
}

// ---- Signals ----

class EverySignal : public CommandLine, public testing::WithParamInterface<int> {};

TEST_P(EverySignal, EndsALongRenderWithoutAFile) {
    Program program(folder_.path(), kEndless, {.terminal = true});
    ASSERT_TRUE(program.wait_for("Mpixel/s")) << "a terminal gets a progress bar";
    program.send(GetParam());
    EXPECT_EQ(program.wait().signal, GetParam());
    EXPECT_EQ(files(), std::set<std::string>{});
}

/// A file is being written in the folder.
bool has_unfinished_file(const fs::path& folder) {
    std::error_code gone;
    for (const auto& entry : fs::directory_iterator(folder, gone)) {
        const auto size = entry.file_size(gone);
        if (!gone && size > 0) return true;
    }
    return false;
}

TEST_P(EverySignal, LeavesNoHalfFileOfOneThatIsBeingWritten) {
    Program program(folder_.path(), {"render", kSample, "-o", "a.png", "--size", "2500x2500",
                                     "--compose", "shaded", "--look", "plain", "--quiet"});
    while (program.is_running() && !has_unfinished_file(folder_.path())) {
        std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    program.send(GetParam());
    const Outcome outcome = program.wait();
    if (outcome.signal == 0) GTEST_SKIP() << "this machine was faster than the signal";
    EXPECT_EQ(outcome.signal, GetParam());
    EXPECT_EQ(files(), std::set<std::string>{});
}

INSTANTIATE_TEST_SUITE_P(Sent, EverySignal, testing::Values(SIGINT, SIGTERM, SIGHUP),
                         [](const auto& signal) {
                             return std::string(sigabbrev_np(signal.param));
                         });

TEST_F(CommandLine, OutlivesASignalThatItWasStartedToIgnore) {
    Program program(folder_.path(), kEndless, {.terminal = true, .ignored_signal = SIGHUP});
    ASSERT_TRUE(program.wait_for("Mpixel/s"));
    program.send(SIGHUP);
    program.send(SIGTERM);
    EXPECT_EQ(program.wait().signal, SIGTERM);
}

}  // namespace
}  // namespace ink::test
