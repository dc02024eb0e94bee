#include "io/movie_writer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "io/atomic_file.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

/// ffmpeg as the shell would find it; empty where it would not.
std::string find_ffmpeg() {
    const char* const path = std::getenv("PATH");
    for (const std::string_view folder : split(path == nullptr ? "/usr/bin" : path, ':')) {
        std::string program = fmt::format("{}/ffmpeg", folder);
        if (access(program.c_str(), X_OK) == 0) return program;
    }
    return {};
}

std::vector<std::string> arguments(const Path& output, int width, int height, double rate) {
    return {"ffmpeg", "-hide_banner", "-loglevel", "error", "-nostdin", "-y",
            // What comes in.
            "-f", "rawvideo", "-pixel_format", "rgb24", "-video_size",
            fmt::format("{}x{}", width, height), "-framerate", fmt::format("{}", rate), "-i",
            "pipe:0",
            // Sides must be even, and colours those that players take for granted.
            "-vf", "crop=trunc(iw/2)*2:trunc(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv",
            "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709",
            // Lines stay sharp at this quality, and every player decodes it. The same pictures give
            // the same film.
            "-c:v", "libx264", "-preset", "medium", "-crf", "16", "-pix_fmt", "yuv420p", "-fflags",
            "+bitexact", "-flags:v", "+bitexact", "-movflags", "+faststart", "-f", "mp4",
            output.string()};
}

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

}  // namespace

bool is_movie(const Path& file) { return to_lower(file.extension().string()) == ".mp4"; }

struct MovieWriter::Impl {
    Impl(const Path& destination, int width, int height, double rate)
        : file(destination), output(destination), messages(std::tmpfile()) {
        const std::string program = find_ffmpeg();
        if (program.empty()) {
            throw Error(
                fmt::format("{}: films are made by ffmpeg, which is not installed; install "
                            "it, or write pictures, as -o out_####.png",
                            file.string()));
        }
        std::array<int, 2> ends{};
        if (!messages || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
            throw Error(fmt::format("{}: ffmpeg cannot be started", file.string()));
        }
        input = ends[0];
        start(program, arguments(output.path(), width, height, rate), ends[1]);
    }

    ~Impl() {
        if (input >= 0) close(input);
        if (child > 0) {
            kill(child, SIGKILL);
            waitpid(child, nullptr, 0);
        }
    }

    void start(const std::string& program, std::vector<std::string> words, int pictures) {
        std::vector<char*> argv;
        for (std::string& word : words) argv.push_back(word.data());
        argv.push_back(nullptr);
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, pictures, STDIN_FILENO);
        posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
        posix_spawn_file_actions_adddup2(&actions, fileno(messages.get()), STDERR_FILENO);
        const int failure =
            posix_spawn(&child, program.c_str(), &actions, nullptr, argv.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        close(pictures);
        if (failure == 0) return;
        child = 0;
        throw Error(fmt::format("{}: ffmpeg cannot be started", file.string()));
    }

    /// Waits for the end; throws where it is not a good one.
    void end() {
        if (input >= 0) close(std::exchange(input, -1));
        int status = 0;
        while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
        }
        child = 0;
        if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
        std::array<char, 400> text{};
        std::rewind(messages.get());
        const std::size_t size = std::fread(text.data(), 1, text.size(), messages.get());
        const std::string_view said = trim(std::string_view(text.data(), size));
        throw Error(
            fmt::format("{}: ffmpeg gave up{}{}; write pictures instead, as -o out_####.png",
                        file.string(), said.empty() ? "" : ": ", said));
    }

    void send_all(std::span<const std::uint8_t> bytes) {
        while (!bytes.empty()) {
            const ssize_t sent = send(input, bytes.data(), bytes.size(), MSG_NOSIGNAL);
            if (sent < 0 && errno == EINTR) continue;
            if (sent <= 0) {
                end();
                throw Error(fmt::format("{}: ffmpeg ended too early", file.string()));
            }
            bytes = bytes.subspan(static_cast<std::size_t>(sent));
        }
    }

    Path file;
    AtomicFile output;
    std::unique_ptr<std::FILE, CloseFile> messages;
    int input = -1;
    pid_t child = 0;
};

MovieWriter::MovieWriter(const Path& file, int width, int height, double rate)
    : impl_(std::make_unique<Impl>(file, width, height, rate)) {}

MovieWriter::~MovieWriter() = default;

void MovieWriter::add(std::span<const std::uint8_t> rgb) { impl_->send_all(rgb); }

void MovieWriter::finish() {
    impl_->end();
    impl_->output.commit();
}

}  // namespace ink
