#include "accel/cost.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <string>

#include "base/error.h"
#include "base/memory.h"

namespace ink {
namespace {

constexpr double kMegabyte = 1e6;

/// Does `work` in a process that may have so many more bytes of address space.
bool holds_with(double free_bytes, const std::function<bool()>& work) {
    const pid_t child = fork();
    if (child == 0) {
        double pages = 0.0;
        std::ifstream("/proc/self/statm") >> pages;
        const double mapped = pages * static_cast<double>(sysconf(_SC_PAGE_SIZE));
        const auto most = static_cast<rlim_t>(mapped + free_bytes);
        const rlimit limit{most, most};
        setrlimit(RLIMIT_AS, &limit);
        _exit(work() ? 0 : 1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(FreeMemory, IsAtMostWhatTheProcessMayHave) {
    EXPECT_TRUE(holds_with(100 * kMegabyte, [] {
        const double free = free_memory_bytes();
        return free > 90 * kMegabyte && free <= 100 * kMegabyte;
    }));
}

TEST(CheckMemory, NamesTheNeedOfASceneThatDoesNotFit) {
    EXPECT_TRUE(holds_with(100 * kMegabyte, [] {
        try {
            check_memory({.build_bytes = 250 * kMegabyte});
        } catch (const Error& error) {
            const std::string said = error.what();
            return said.find("needs 0.25 GB of memory more") != std::string::npos &&
                   said.find("0.1 GB are free; draw less of it") != std::string::npos;
        }
        return false;
    }));
}

TEST(CheckMemory, LetsASceneThatFitsPass) {
    EXPECT_TRUE(holds_with(400 * kMegabyte, [] {
        check_memory({.build_bytes = 250 * kMegabyte});
        return true;
    }));
}

TEST(CostOf, GrowsWithTheCopiesOfSpheresButDoesNotStoreThem) {
    std::vector<Object> objects(1);
    Spheres once;
    once.spheres.resize(1000, {{}, 1.0F});
    objects[0].shape = once;
    const Cost of_one = cost_of(objects);
    once.copies.resize(60);
    objects[0].shape = once;
    const Cost of_all = cost_of(objects);
    EXPECT_LT(of_all.stored_bytes, 1.5 * of_one.stored_bytes);
    EXPECT_LT(of_all.build_bytes, 10.0 * of_one.build_bytes);
    EXPECT_GT(of_all.build_bytes, of_one.build_bytes);
}

}  // namespace
}  // namespace ink
