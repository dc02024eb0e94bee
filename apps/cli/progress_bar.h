#pragma once

#include <chrono>

namespace inktrace::cli {

/// A bar with rate and time left on standard error, if that is a terminal. It keeps silent for the
/// first moments, so that quick work leaves no trace, and clears its line at the end.
class ProgressBar {
  public:
    explicit ProgressBar(bool wanted);
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;
    ~ProgressBar();

    /// `share` of the work that is done, in (0, 1], of `megapixels` in all.
    void update(double share, double megapixels);

  private:
    using Clock = std::chrono::steady_clock;

    bool enabled_;
    bool drawn_ = false;
    Clock::time_point start_ = Clock::now();
    Clock::time_point last_ = start_;
};

}  // namespace inktrace::cli
