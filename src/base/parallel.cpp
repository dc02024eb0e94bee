#include "base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace ink {

int hardware_threads() { return tbb::info::default_concurrency(); }

namespace {

/// In the arena at hand.
void run(std::size_t count, const std::function<void(std::size_t, std::size_t)>& body) {
    // A loop around this one that is cancelled must not cut it short: its caller would go on with
    // what was not done.
    tbb::task_group_context context(tbb::task_group_context::isolated);
    // Grain 1: a tile is already a large piece of work, and tiles differ in cost.
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            const auto worker =
                static_cast<std::size_t>(tbb::this_task_arena::current_thread_index());
            for (std::size_t i = range.begin(); i != range.end(); ++i) body(i, worker);
        },
        tbb::simple_partitioner{}, context);
}

/// Whether the arena at hand has just so many threads.
bool has_arena(int threads) {
    return tbb::this_task_arena::current_thread_index() >= 0 &&
           tbb::this_task_arena::max_concurrency() == threads;
}

}  // namespace

void parallel_for(std::size_t count, int threads,
                  const std::function<void(std::size_t, std::size_t)>& body) {
    if (threads == 0) threads = hardware_threads();
    if (threads == 1) {
        for (std::size_t i = 0; i < count; ++i) body(i, 0);
        return;
    }
    if (has_arena(threads)) {
        // A thread that waits here must not begin another loop's call: it could be for the same
        // worker.
        tbb::this_task_arena::isolate([&] { run(count, body); });
        return;
    }
    with_threads(threads, [&] { run(count, body); });
}

void with_threads(int threads, const std::function<void()>& body) {
    if (threads == 0) threads = hardware_threads();
    // TBB starts as many threads as the machine has; more have to be asked for.
    const tbb::global_control limit(
        tbb::global_control::max_allowed_parallelism,
        static_cast<std::size_t>(std::max(threads, hardware_threads())));
    tbb::task_arena arena(threads);
    arena.execute(body);
}

void parallel_ranges(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body) {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, grain),
        [&](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); });
}

void parallel_sort(std::vector<std::pair<std::uint64_t, std::uint32_t>>& keys) {
    tbb::parallel_sort(keys);
}

}  // namespace ink
