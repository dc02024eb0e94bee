#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>

namespace ink {

/// Threads with work that is for one of them, the leader, most of the time. The others do what is
/// beside it, item by item, and between two items help with the leader's loops, so that these
/// neither wait for what is beside nor for a thread to wake up.
class Team {
  public:
    using Body = std::function<void(std::size_t item, std::size_t worker)>;

    /// Calls `beside` for each item in [0, count), in their order, on any thread.
    Team(std::size_t count, Body beside) : count_(count), beside_(std::move(beside)) {}

    /// What the k-th thread does, one call each, `worker` as in parallel_for. That with k = 0 calls
    /// `lead`, and then does what is left beside it. Throws what these throw.
    void work(std::size_t k, std::size_t worker, const std::function<void()>& lead);

    /// For the leader, within `lead`: calls `body` for each item in [0, count), on all threads that
    /// are there. Throws what one of the calls throws, once all are over.
    void loop(std::size_t count, const Body& body);

  private:
    struct Loop;

    bool help(std::size_t worker);
    void tell();
    void end();

    std::size_t count_;
    Body beside_;
    std::atomic<std::size_t> next_ = 0;
    std::size_t leader_ = 0;  ///< its worker
    std::mutex mutex_;
    std::shared_ptr<Loop> loop_;
    std::atomic<bool> has_loop_ = false;
    std::atomic<bool> led_ = false;        ///< the leader has come to its end
    std::atomic<std::uint32_t> news_ = 0;  ///< counts what the others may wait for
};

}  // namespace ink
