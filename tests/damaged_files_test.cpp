// Every real file that was damaged on purpose, and each of our own, given to the program as a user
// would: it must end by itself, in bounded time and memory, with a picture or with a message.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "test_files.h"

namespace inktrace {
namespace {

namespace fs = std::filesystem;
using ink::test::data_file;
using ink::test::read_bytes;
using ink::test::TemporaryFolder;

#ifdef __SANITIZE_ADDRESS__
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

/// The sanitizers' way to end a program that did something forbidden.
constexpr int kSanitizerStatus = 99;

struct Outcome {
    int status = -1;       ///< of its exit; -1: it was ended by a signal, or by us
    double seconds = 0.0;  ///< of processor time: by the clock, others may be in the way
    double peak_mb = 0.0;
    std::string messages;
};

[[noreturn]] void become(const std::vector<std::string>& arguments, const fs::path& messages) {
    const int file = open(messages.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    dup2(file, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
    setenv("ASAN_OPTIONS", "exitcode=99:allocator_may_return_null=1", 1);
    setenv("UBSAN_OPTIONS", "halt_on_error=1:exitcode=99:print_stacktrace=1", 1);
    if (!kSanitized) {
        const rlimit memory{rlim_t{4} << 30, rlim_t{4} << 30};
        setrlimit(RLIMIT_AS, &memory);
    }
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    const rlimit seconds{60, 60};
    setrlimit(RLIMIT_CPU, &seconds);
    const std::string program = ink::test::program();
    std::vector<char*> words{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) {
        words.push_back(const_cast<char*>(argument.c_str()));
    }
    words.push_back(nullptr);
    execv(program.c_str(), words.data());
    _exit(126);
}

Outcome run(const fs::path& folder, const std::vector<std::string>& arguments) {
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::minutes kLongest{10};  // waiting for nothing
    const fs::path messages = folder / "messages";
    const auto start = Clock::now();
    const pid_t child = fork();
    if (child == 0) become(arguments, messages);
    Outcome outcome;
    int status = 0;
    rusage used{};
    while (wait4(child, &status, WNOHANG, &used) == 0) {
        if (Clock::now() - start > kLongest) kill(child, SIGKILL);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    outcome.seconds = seconds(used.ru_utime) + seconds(used.ru_stime);
    outcome.peak_mb = static_cast<double>(used.ru_maxrss) / 1024.0;
    outcome.messages = read_bytes(messages);
    if (WIFEXITED(status)) outcome.status = WEXITSTATUS(status);
    return outcome;
}

/// Those that are hard but right, or have a good part that is drawn with a warning.
const std::set<std::string>& loadable() {
    static const std::set<std::string> kFiles{"1crn_no_element_column.pdb",
                                              "1crn_unknown_element.pdb",
                                              "coincident.xyz",
                                              "odd_start.pdb",
                                              "coincident_1000.csv",
                                              "csv_nan_negative_radius.csv",
                                              "csv_no_header.csv",
                                              "lammps_box-not-numbers.lammpstrj",
                                              "lammps_items-after-atoms.lammpstrj",
                                              "points_nan_negradius.ply",
                                              "all_degenerate.obj",
                                              "fandisk_fin_dup_flipped.obj",
                                              "fandisk_zero_area.obj",
                                              "nonmanifold_edge.obj",
                                              "spot_far_from_origin.obj",
                                              "spot_tiny_scale.obj",
                                              "stl_header_says_solid.stl"};
    return kFiles;
}

void expect_a_good_end(const Outcome& outcome, const fs::path& file, bool loads) {
    const std::string& said = outcome.messages;
    ASSERT_NE(outcome.status, kSanitizerStatus) << said;
    EXPECT_EQ(outcome.status, loads ? 0 : 1) << said;
    EXPECT_LT(outcome.seconds, 60.0);
    // Most of it are the libraries and the picture.
    if (!kSanitized) {
        EXPECT_LT(outcome.peak_mb, 400.0);
    }
    if (outcome.status != 1) return;
    EXPECT_NE(said.find(file.filename().string()), std::string::npos) << said;
    EXPECT_NE(said.find_first_of(";?"), std::string::npos) << "no remedy: " << said;
}

TEST(LargeFiles, AreRefusedBeforeTheyAreReadWhereTheyDoNotFit) {
    if (kSanitized) GTEST_SKIP() << "sanitizers map terabytes for themselves";
    const TemporaryFolder folder;
    const fs::path file = folder.write("large.vtp", "<VTKFile");
    fs::resize_file(file, std::uintmax_t{8} << 30);  // takes no place on the disk
    const Outcome outcome = run(folder.path(), {"info", file});
    expect_a_good_end(outcome, file, false);
    EXPECT_NE(outcome.messages.find("needs at least 6.4 GB of memory to be read, but"),
              std::string::npos)
        << outcome.messages;
}

class DamagedFiles : public testing::TestWithParam<const char*> {};

TEST_P(DamagedFiles, EndInAPictureOrAMessage) {
    const fs::path broken = data_file(GetParam()) / "broken";
    if (!fs::exists(broken)) GTEST_SKIP() << broken << " is not there";
    const TemporaryFolder folder;
    for (const auto& entry : fs::directory_iterator(broken)) {
        const fs::path& file = entry.path();
        SCOPED_TRACE(file.filename());
        const bool loads = loadable().contains(file.filename());
        expect_a_good_end(run(folder.path(), {"info", file}), file, loads);
        const fs::path picture = folder.path() / "a.png";
        fs::remove(picture);
        expect_a_good_end(
            run(folder.path(), {"render", file, "-o", picture, "--size", "64x64", "--quiet"}), file,
            loads);
        EXPECT_EQ(fs::exists(picture), loads);
    }
}

INSTANTIATE_TEST_SUITE_P(Real, DamagedFiles, testing::Values("molecules", "meshes", "particles"));

}  // namespace
}  // namespace inktrace
