#include "base/memory.h"

#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

#include "base/parallel.h"

namespace ink {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

std::optional<double> number_in(const char* file) {
    std::ifstream in(file);
    double value = 0.0;
    if (in >> value) return value;
    return std::nullopt;
}

/// The number after a key, in a file of such pairs.
double entry_in(const char* file, const std::string& wanted) {
    std::ifstream in(file);
    std::string key;
    double value = 0.0;
    while (in >> key >> value) {
        if (key == wanted) return value;
    }
    return 0.0;
}

/// Of the machine: what is not used, or is only a copy of files.
double free_on_machine() {
    std::ifstream in("/proc/meminfo");
    std::string key;
    double kilobytes = 0.0;
    std::string unit;
    while (in >> key >> kilobytes && std::getline(in, unit)) {
        if (key == "MemAvailable:") return kilobytes * 1024.0;
    }
    return kUnknown;
}

/// Of the control group, version 2 or 1. Copies of files count as used there, but give way.
double free_in_group() {
    const auto left = [](const char* most, const char* used, const char* stat) {
        const auto limit = number_in(most);
        const auto now = number_in(used);
        constexpr double kNoLimit = 0x1p60;  // what version 1 says where there is none
        if (!limit || !now || *limit > kNoLimit) return kUnknown;
        return std::max(*limit - *now + entry_in(stat, "inactive_file"), 0.0);
    };
    return std::min(
        left("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current",
             "/sys/fs/cgroup/memory.stat"),
        left("/sys/fs/cgroup/memory/memory.limit_in_bytes",
             "/sys/fs/cgroup/memory/memory.usage_in_bytes", "/sys/fs/cgroup/memory/memory.stat"));
}

/// Of the address space that the process may have.
double free_in_process() {
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnknown;
    const double pages = number_in("/proc/self/statm").value_or(0.0);
    const double used = pages * static_cast<double>(sysconf(_SC_PAGE_SIZE));
    return std::max(static_cast<double>(limit.rlim_cur) - used, 0.0);
}

}  // namespace

double free_memory_bytes() {
    return std::min({free_on_machine(), free_in_group(), free_in_process()});
}

void use_large_pages([[maybe_unused]] const void* begin, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
    constexpr std::uintptr_t kPage = std::uintptr_t{2} << 20;
    constexpr std::size_t kWorthIt = 4 * kPage;
    if (bytes < kWorthIt) return;
    const auto from = reinterpret_cast<std::uintptr_t>(begin);
    const std::uintptr_t first = (from + kPage - 1) / kPage * kPage;
    const std::uintptr_t last = (from + bytes) / kPage * kPage;
    // A wish: that it may not be granted does no harm.
    madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
    // The system clears a page when it is first written to: now, and on all threads.
    parallel_ranges((last - first) / kPage, 4, [&](std::size_t from_page, std::size_t to_page) {
        for (std::size_t k = from_page; k < to_page; ++k) {
            *reinterpret_cast<volatile char*>(first + k * kPage) = 0;
        }
    });
#endif
}

}  // namespace ink
