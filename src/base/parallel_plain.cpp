// parallel.h without TBB, for the thread sanitizer: TBB is built without it, which hides from it
// what happens before what.

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "base/parallel.h"

namespace ink {

namespace {

/// That `with_threads` allows to this thread; 0: all of the machine's.
thread_local int allowed_threads = 0;

/// Whose call this thread is in.
struct Place {
    int threads = 0;  ///< of the loop; 0: in none
    std::size_t worker = 0;
};
thread_local Place place;

}  // namespace

int hardware_threads() {
    return std::max(static_cast<int>(std::thread::hardware_concurrency()), 1);
}

void parallel_for(std::size_t count, int threads,
                  const std::function<void(std::size_t, std::size_t)>& body) {
    if (threads == 0) threads = hardware_threads();
    if (place.threads == threads) {
        // As in an arena of TBB, where a thread is the same worker in a loop within a loop: others
        // may be in calls of the outer one.
        for (std::size_t i = 0; i < count; ++i) body(i, place.worker);
        return;
    }
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::exception_ptr error;
    const auto work = [&](std::size_t worker) {
        const Place outside = std::exchange(place, Place{threads, worker});
        try {
            // Relaxed: what bodies share, they must put in order themselves.
            for (std::size_t i = 0; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;) {
                body(i, worker);
            }
        } catch (...) {
            next.store(count, std::memory_order_relaxed);
            const std::scoped_lock lock(mutex);
            if (!error) error = std::current_exception();
        }
        place = outside;
    };
    {
        std::vector<std::jthread> others;
        for (std::size_t worker = 1; worker < static_cast<std::size_t>(threads); ++worker) {
            others.emplace_back(work, worker);
        }
        work(0);
    }
    if (error) std::rethrow_exception(error);
}

void with_threads(int threads, const std::function<void()>& body) {
    struct Restore {
        int before;
        ~Restore() { allowed_threads = before; }
    } const restore{std::exchange(allowed_threads, threads)};
    body();
}

void parallel_ranges(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body) {
    parallel_for((count + grain - 1) / grain, allowed_threads, [&](std::size_t i, std::size_t) {
        body(i * grain, std::min(count, (i + 1) * grain));
    });
}

void parallel_sort(std::vector<std::pair<std::uint64_t, std::uint32_t>>& keys) {
    std::ranges::sort(keys);
}

}  // namespace ink
