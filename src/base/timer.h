#pragma once

#include <chrono>

namespace ink {

/// Adds the time of its life to a counter.
class Timer {
  public:
    using Clock = std::chrono::steady_clock;

    explicit Timer(double& total_ms) : total_ms_(total_ms), start_(Clock::now()) {}
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;
    ~Timer() {
        total_ms_ += std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
    }

  private:
    double& total_ms_;
    Clock::time_point start_;
};

/// Divides a stretch of time among counters.
class LapTimer {
  public:
    /// Adds the time since the last lap, or the beginning.
    void lap(double& total_ms) {
        const Timer::Clock::time_point now = Timer::Clock::now();
        total_ms += std::chrono::duration<double, std::milli>(now - last_).count();
        last_ = now;
    }

  private:
    Timer::Clock::time_point last_ = Timer::Clock::now();
};

}  // namespace ink
