#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "paths.h"
#include "test_files.h"

/// The program as people and scripts run it.
namespace ink::test {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

inline const std::string kSample = (source_dir() / "samples/acetaminophen.xyz").string();

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

inline void expect_done(const Outcome& outcome) {
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.signal, 0);
}

inline void expect_says(const std::string& text, const std::vector<std::string>& parts) {
    for (const std::string& part : parts) {
        EXPECT_NE(text.find(part), std::string::npos) << "no '" << part << "' in: " << text;
    }
}

}  // namespace ink::test
