#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>

#include "session/session.h"

namespace inktrace::viewer {

/// A session whose owner has no window and no other events, and waits for its news.
class WaitingOwner {
  public:
    WaitingOwner() : session([this] { wake(); }) {}

    /// Takes in news until `done`; false where that takes longer than `limit`.
    bool wait_until(const std::function<bool()>& done, std::chrono::milliseconds limit) {
        const auto end = Clock::now() + limit;
        for (;;) {
            session.update();
            if (done()) return true;
            if (Clock::now() > end) return false;
            // What `done` looks at may change without news.
            await_news(std::chrono::milliseconds(5));
        }
    }
    /// Takes in the next news, if there are any before a moment.
    void take_news(Clock::time_point until) {
        await_news(until - Clock::now());
        session.update();
    }
    /// Whether the picture of the present settings is there in full.
    bool has_picture() const {
        return !session.busy() && session.painting().picture && session.painting().exact;
    }

  private:
    void wake() {
        {
            const std::scoped_lock lock(mutex_);
            woken_ = true;
        }
        news_.notify_all();
    }
    void await_news(std::chrono::duration<double, std::milli> most) {
        std::unique_lock lock(mutex_);
        news_.wait_for(lock, most, [this] { return woken_; });
        woken_ = false;
    }

    std::mutex mutex_;
    std::condition_variable news_;
    bool woken_ = false;

  public:
    Session session;  ///< ends before what it wakes
};

}  // namespace inktrace::viewer
