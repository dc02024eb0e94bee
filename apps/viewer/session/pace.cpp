#include "session/pace.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace inktrace::viewer {

namespace {

constexpr std::array kScales{1.0, 0.75, 0.5, 0.375, 0.25};
constexpr int kLast = static_cast<int>(kScales.size()) - 1;

double scale_at(int step) { return kScales[static_cast<std::size_t>(step)]; }

}  // namespace

double Pace::scale() const { return scale_at(step_); }

void Pace::plain_took(double ms) {
    // Lines may add a fifth. Below the shortest, nobody sees a frame come sooner.
    constexpr double kWithLines = 1.2;
    constexpr double kShortest = 8.0;
    target_ms_ = std::clamp(kWithLines * ms, kShortest, kLongest);
}

void Pace::frame_took(double scale, double ms) {
    known_ = true;
    // Between the sides of a picture and its area: lines cost by their length.
    constexpr double kPower = 1.5;
    const auto predicted = [&](int step) { return ms * std::pow(scale_at(step) / scale, kPower); };
    // A step down where a frame takes too long, and up only with room to spare, so that two frames
    // of the same cost are drawn alike.
    constexpr double kRoom = 0.75;
    while (step_ < kLast && predicted(step_) > target_ms_) ++step_;
    if (step_ > 0 && predicted(step_ - 1) < kRoom * target_ms_) --step_;
}

void Pace::full_took(double ms) {
    if (!known_) frame_took(1.0, ms);
}

}  // namespace inktrace::viewer
