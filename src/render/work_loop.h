#pragma once

#include <cstddef>
#include <functional>
#include <mutex>

#include "render/render.h"

namespace ink {

/// Runs a picture's work items in parallel, watches for cancellation and reports progress.
class WorkLoop {
  public:
    /// `items` in all, over every call of `run`.
    WorkLoop(int threads, const RenderControl& control, std::size_t items)
        : threads_(threads), control_(control), items_(items) {}

    int threads() const { return threads_; }
    /// There will be so many more.
    void expect(std::size_t items) { items_ += items; }
    /// Calls `body(item, worker)` as parallel_for does. Throws Cancelled when told to stop.
    void run(std::size_t count,
             const std::function<void(std::size_t item, std::size_t worker)>& body);
    /// A single item, on a thread that is there already. Likewise.
    void item(const std::function<void()>& body);

  private:
    int threads_;
    const RenderControl& control_;
    std::size_t items_;
    std::size_t done_ = 0;
    std::mutex mutex_;
};

}  // namespace ink
