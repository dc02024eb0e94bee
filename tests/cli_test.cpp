// The program as people and scripts run it: what it writes, what it says, how it ends.

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <png.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "inktrace/inktrace.h"
#include "paths.h"
#include "test_files.h"

namespace ink::test {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

const std::string kSample = (ink::test::source_dir() / "samples/acetaminophen.xyz").string();
constexpr std::string_view kXyz = "2\ncarbon monoxide\nC 0 0 0\nO 0 1.2 0\n";
constexpr std::string_view kStl =
    "solid pair\n"
    "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 2 0 0\nendloop\nendfacet\n"
    "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 0 3\nendloop\nendfacet\n"
    "endsolid pair\n";

// ---- Running the program ----

/// How the program ended and what it said.
struct Outcome {
    int status = -1;  ///< exit status; -1 where a signal ended it
    int signal = 0;   ///< that ended it; 0 where it exited
    std::string out, err;
};

/// What is unusual about a run.
struct Circumstances {
    rlim_t largest_file = RLIM_INFINITY;  ///< bytes
    bool terminal = false;                ///< standard error is one
    bool out_full = false;                ///< standard output goes to a full disk
    int ignored_signal = 0;               ///< as nohup ignores SIGHUP
};

/// The program while it runs, in a folder that is also its folder for temporary files.
class Program {
  public:
    Program(const fs::path& folder, const Arguments& arguments,
            const Circumstances& circumstances = {}) {
        std::array<int, 2> out{};
        std::array<int, 2> err{};
        if (pipe(out.data()) != 0) throw std::runtime_error("pipe");
        const bool opened = circumstances.terminal
                                ? openpty(&err[0], &err[1], nullptr, nullptr, nullptr) == 0
                                : pipe(err.data()) == 0;
        if (!opened) throw std::runtime_error("pipe or terminal");
        pid_ = fork();
        if (pid_ == 0) run(folder, arguments, circumstances, out[1], err[1]);
        close(out[1]);
        close(err[1]);
        out_ = out[0];
        err_ = err[0];
    }
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;
    ~Program() {
        if (running_) {
            kill(pid_, SIGKILL);
            wait();
        }
        close(out_);
        close(err_);
    }

    void send(int signal) const { kill(pid_, signal); }

    /// Waits until standard error has said `text`; false where it ends without.
    bool wait_for(std::string_view text) {
        while (outcome_.err.find(text) == std::string::npos) {
            if (!read_some(err_, outcome_.err)) return false;
        }
        return true;
    }

    /// Is it still at work? Does not wait.
    bool is_running() {
        siginfo_t info{};
        return running_ &&
               waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
               info.si_pid == 0;
    }

    Outcome wait() {
        // One after the other: what it says in a test fits into a pipe.
        while (read_some(out_, outcome_.out)) {
        }
        while (read_some(err_, outcome_.err)) {
        }
        int status = 0;
        waitpid(pid_, &status, 0);
        running_ = false;
        if (WIFEXITED(status)) outcome_.status = WEXITSTATUS(status);
        if (WIFSIGNALED(status)) outcome_.signal = WTERMSIG(status);
        return outcome_;
    }

  private:
    [[noreturn]] static void run(const fs::path& folder, const Arguments& arguments,
                                 const Circumstances& circumstances, int out, int err) {
        if (circumstances.out_full) out = open("/dev/full", O_WRONLY);
        if (dup2(out, STDOUT_FILENO) < 0 || dup2(err, STDERR_FILENO) < 0) _exit(126);
        if (chdir(folder.c_str()) != 0) _exit(126);
        setenv("TMPDIR", folder.c_str(), 1);
        // A test that runs in the background may have inherited signals that are ignored.
        for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
        if (circumstances.ignored_signal != 0) std::signal(circumstances.ignored_signal, SIG_IGN);
        const rlimit limit{circumstances.largest_file, RLIM_INFINITY};
        setrlimit(RLIMIT_FSIZE, &limit);
        std::string name = "inktrace";
        Arguments copy = arguments;
        std::vector<char*> argv{name.data()};
        for (std::string& argument : copy) argv.push_back(argument.data());
        argv.push_back(nullptr);
        execv(ink::test::program().c_str(), argv.data());
        _exit(127);
    }

    static bool read_some(int fd, std::string& text) {
        std::array<char, 4096> buffer{};
        const ssize_t count = read(fd, buffer.data(), buffer.size());
        if (count <= 0) return false;  // a terminal ends with an error
        text.append(buffer.data(), static_cast<std::size_t>(count));
        return true;
    }

    pid_t pid_ = -1;
    int out_ = -1, err_ = -1;
    bool running_ = true;
    Outcome outcome_;
};

/// Tests of one program in a folder of its own.
class CommandLine : public testing::Test {
  protected:
    Outcome run(const Arguments& arguments, const Circumstances& circumstances = {}) const {
        return Program(folder_.path(), arguments, circumstances).wait();
    }
    /// Draws the sample small, with more flags.
    Outcome render(const std::string& output, const Arguments& flags = {}) const {
        Arguments arguments{"render", kSample, "-o", output, "--size", "64x48"};
        arguments.insert(arguments.end(), flags.begin(), flags.end());
        return run(arguments);
    }
    fs::path file(const std::string& name) const { return folder_.path() / name; }

    /// Everything in the folder, hidden files too.
    std::set<std::string> files() const {
        std::set<std::string> names;
        for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
            names.insert(entry.path().lexically_relative(folder_.path()).string());
        }
        return names;
    }
    std::map<std::string, std::string> contents() const {
        std::map<std::string, std::string> bytes;
        for (const std::string& name : files()) {
            bytes[name] = fs::is_directory(file(name)) ? "(folder)" : read_bytes(file(name));
        }
        return bytes;
    }

    TemporaryFolder folder_;
};

void expect_done(const Outcome& outcome) {
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.signal, 0);
}

void expect_says(const std::string& text, const std::vector<std::string>& parts) {
    for (const std::string& part : parts) {
        EXPECT_NE(text.find(part), std::string::npos) << "no '" << part << "' in: " << text;
    }
}

// ---- Errors ----

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
        Mistake{"no_command", {}, {"a command is missing", kSeeHelp}},
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
              ".png, .jpg, .tiff, .exr, .svg or .pdf"}),
        draw("output_without_extension", kSample, "a",
             {"a: ", "cannot tell the picture's format", ".png, .jpg, .tiff, .exr, .svg or .pdf"})),
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
        draw_with("unknown_short_flag", {"-x"}, {"'-x'", kSeeHelp}),
        draw_with("flag_without_its_value", {"--size"}, {"--size", "WxH missing", kSeeHelp}),
        draw_with("size_with_zero", {"--size", "0x5"}, {"--size: ", "'0x5'", "from 1 to 65500"}),
        draw_with("size_beyond_every_format", {"--size", "1000000x1000000"},
                  {"--size: ", "'1000000x1000000'", "from 1 to 65500"}),
        draw_with("size_that_is_no_size", {"--size", "foo"},
                  {"--size: ", "'foo' is not a size", "WIDTHxHEIGHT"}),
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
                         testing::Values(".png", ".jpg", ".tiff", ".exr", ".svg", ".pdf"),
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

// ---- Animations and legends ----

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

/// Columns of a square RGBA picture that are not all white.
std::vector<int> inked_columns(const std::vector<std::uint8_t>& rgba, int side) {
    std::vector<int> columns;
    for (int x = 0; x < side; ++x) {
        bool inked = false;
        for (int y = 0; y < side; ++y) {
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
        const std::vector<int> columns = inked_columns(pixels(file(name)), 40);
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
                "0 9\nITEM: ATOMS id x y z heat\n1 0 0 0 0\n2 {} 0 0 {}\n",
                gap, value);
        }
        return text;
    }());
    const auto draw = [&](const Arguments& more) {
        Arguments arguments{"render", "run.lammpstrj", "--view", "front",  "--size",
                            "48x48",  "--color-by",    "heat",   "--quiet"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        expect_done(run(arguments));
    };
    draw({"--frame", "0:1", "-o", "a#.png"});
    draw({"--frame", "0:1", "-o", "b#.png", "--radius", "0.5", "--color-range", "0:50"});
    EXPECT_EQ(pixels(file("a0.png")), pixels(file("b0.png")));
    EXPECT_EQ(pixels(file("a1.png")), pixels(file("b1.png")));
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
    Program program(folder_.path(), {"render", kSample, "-o", "a.png", "--size", "5000x5000",
                                     "--compose", "shaded", "--quiet"});
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
