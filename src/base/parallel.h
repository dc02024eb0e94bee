#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace ink {

/// Threads that the machine offers, at least 1.
int hardware_threads();

/// Calls `body(i, worker)` for every i in [0, count), on up to `threads` threads (0: all of the
/// machine's). No two calls at one time have the same `worker`, which is in [0, threads). The order
/// is not defined; an exception from `body` ends the loop and is rethrown.
void parallel_for(std::size_t count, int threads,
                  const std::function<void(std::size_t i, std::size_t worker)>& body);

/// Calls `body`, in which `parallel_ranges` and `parallel_sort` use up to `threads` threads (0: all
/// of the machine's), and `parallel_for` with as many starts no threads of its own.
void with_threads(int threads, const std::function<void()>& body);

/// Cuts [0, count) into ranges of about `grain` and calls `body(begin, end)` for each, on all
/// threads of the machine unless told otherwise. Which ranges there are is not defined.
void parallel_ranges(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body);

/// Sorts ascending, on as many threads.
void parallel_sort(std::vector<std::pair<std::uint64_t, std::uint32_t>>& keys);

}  // namespace ink
