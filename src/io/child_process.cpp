#include "io/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string_view>

namespace ink {

namespace {

constexpr int kOutOfMemory = 3;
constexpr int kFailed = 4;

/// The address sanitizer maps terabytes for itself.
#ifdef __SANITIZE_ADDRESS__
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

std::size_t mapped_bytes() {
    std::size_t pages = 0;
    if (FILE* const statm = std::fopen("/proc/self/statm", "r")) {
        if (std::fscanf(statm, "%zu", &pages) != 1) pages = 0;
        std::fclose(statm);
    }
    return pages * static_cast<std::size_t>(sysconf(_SC_PAGE_SIZE));
}

void limit(int resource, std::size_t most) {
    // At the hard limit of time the signal would be one that a crash may give, too.
    const rlimit soft_and_hard{most, most + 1};
    setrlimit(static_cast<__rlimit_resource_t>(resource), &soft_and_hard);
}

void apply(const ChildLimits& limits) {
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, static_cast<std::size_t>(limits.cpu_seconds));
    if (!kSanitized) limit(RLIMIT_AS, mapped_bytes() + limits.memory_bytes);
    // What the program does at an interrupt is not for the child to do.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(signal, SIG_DFL);
}

void write_all(int pipe, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = write(pipe, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) _exit(kFailed);
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
}

[[noreturn]] void run_child(int pipe, const std::function<std::string()>& work,
                            const ChildLimits& limits) {
    try {
        apply(limits);
        write_all(pipe, work());
    } catch (const std::bad_alloc&) {
        _exit(kOutOfMemory);
    } catch (...) {
        _exit(kFailed);
    }
    // Without the destructors of what belongs to the parent.
    _exit(0);
}

/// Reads until the child closes its end; false when it is too late or too much.
bool read_all(int pipe, const ChildLimits& limits, std::string& bytes) {
    using Clock = std::chrono::steady_clock;
    // A child that waits uses no processor time; it gets twice as long by the clock.
    const auto end = Clock::now() + std::chrono::seconds(2 * limits.cpu_seconds);
    std::array<char, 1 << 16> buffer{};
    for (;;) {
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
        if (left.count() <= 0) return false;
        pollfd waiting{pipe, POLLIN, 0};
        const int ready = poll(&waiting, 1, static_cast<int>(left.count()));
        if (ready < 0 && errno == EINTR) continue;
        if (ready <= 0) return false;
        const ssize_t got = read(pipe, buffer.data(), buffer.size());
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return got == 0;
        bytes.append(buffer.data(), static_cast<std::size_t>(got));
        if (bytes.size() > limits.result_bytes) return false;
    }
}

ChildResult::End how_it_ended(int status) {
    if (WIFEXITED(status)) {
        const int code = WEXITSTATUS(status);
        if (code == 0) return ChildResult::End::done;
        return code == kOutOfMemory ? ChildResult::End::too_large : ChildResult::End::died;
    }
    return WTERMSIG(status) == SIGXCPU ? ChildResult::End::too_large : ChildResult::End::died;
}

}  // namespace

ChildResult in_child_process(const std::function<std::string()>& work, const ChildLimits& limits) {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) return {};
    const pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        run_child(ends[1], work, limits);
    }
    close(ends[1]);
    ChildResult result;
    if (child < 0) {
        close(ends[0]);
        return result;
    }
    const bool complete = read_all(ends[0], limits, result.bytes);
    close(ends[0]);
    if (!complete) kill(child, SIGKILL);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    result.end = complete ? how_it_ended(status) : ChildResult::End::too_large;
    return result;
}

}  // namespace ink
