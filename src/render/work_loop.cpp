#include "render/work_loop.h"

#include "base/error.h"
#include "base/parallel.h"

namespace ink {

void WorkLoop::run(std::size_t count, const std::function<void(std::size_t, std::size_t)>& body) {
    parallel_for(count, threads_,
                 [&](std::size_t k, std::size_t worker) { item([&] { body(k, worker); }); });
}

void WorkLoop::item(const std::function<void()>& body) {
    if (control_.cancel != nullptr && control_.cancel->load(std::memory_order_relaxed)) {
        throw Cancelled();
    }
    body();
    if (!control_.progress) return;
    const std::scoped_lock lock(mutex_);
    ++done_;
    control_.progress(static_cast<double>(done_) / static_cast<double>(items_));
}

}  // namespace ink
