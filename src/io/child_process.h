#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace ink {

/// What a child process may use.
struct ChildLimits {
    std::size_t memory_bytes = std::size_t{4} << 30;  ///< beyond what the parent has mapped
    std::size_t result_bytes = std::size_t{4} << 30;
    int cpu_seconds = 60;
};

struct ChildResult {
    enum class End {
        done,      ///< `bytes` is what the work returned
        died,      ///< by a signal, or it could not be started
        too_large  ///< it used more time, memory or bytes than it may
    };
    End end = End::died;
    std::string bytes;
};

/// Does `work` in a forked child, for libraries that cannot be trusted with a stranger's bytes: if
/// they crash, hang or eat memory, this process goes on. The child sees this process as it is now,
/// but has only the calling thread; `work` must not wait for others. Not limited in memory under
/// the address sanitizer.
ChildResult in_child_process(const std::function<std::string()>& work, const ChildLimits& limits);

}  // namespace ink
