#include "session/pace.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace inktrace::viewer {

namespace {

constexpr std::array kScales{1.0, 0.75, 0.5, 0.375, 0.25};

double scale_at(int step) { return kScales[static_cast<std::size_t>(step)]; }

int step_of(double scale) {
    const auto* const found = std::ranges::find(kScales, scale);
    return static_cast<int>(found - kScales.begin()) % static_cast<int>(kScales.size());
}

}  // namespace

double Pace::scale() const { return scale_at(step_); }

void Pace::plain_took(double ms) {
    // Lines may add a fifth. Below the shortest, nobody sees a frame come sooner.
    constexpr double kWithLines = 1.2;
    constexpr double kShortest = 8.0;
    target_ms_ = std::clamp(kWithLines * ms, kShortest, kLongest);
    took_ms_ = {};
}

/// As seen, or from the nearest step that was.
double Pace::expected_ms(int step) const {
    if (took_ms_[static_cast<std::size_t>(step)] > 0.0) {
        return took_ms_[static_cast<std::size_t>(step)];
    }
    // Between the sides of a picture and its area: lines cost by their length.
    constexpr double kPower = 1.5;
    for (int away = 1; away < kSteps; ++away) {
        for (const int other : {step - away, step + away}) {
            if (other < 0 || other >= kSteps) continue;
            const double ms = took_ms_[static_cast<std::size_t>(other)];
            if (ms > 0.0) return ms * std::pow(scale_at(step) / scale_at(other), kPower);
        }
    }
    return 0.0;
}

void Pace::frame_took(double scale, double ms) {
    double& took = took_ms_[static_cast<std::size_t>(step_of(scale))];
    constexpr double kNewest = 0.3;
    took = took > 0.0 ? took + kNewest * (ms - took) : ms;
    // More rays only with room to spare, so that two frames of the same cost are drawn alike.
    constexpr double kRoom = 0.75;
    const auto fits = [&](int step) {
        return expected_ms(step) <= (step < step_ ? kRoom : 1.0) * target_ms_;
    };
    int least = 0;
    for (int step = 0; step < kSteps; ++step) {
        if (fits(step)) {
            step_ = step;
            return;
        }
        if (expected_ms(step) < expected_ms(least)) least = step;
    }
    // None is fast enough: as many rays as cost next to nothing.
    constexpr double kNothing = 1.1;
    while (least > 0 && expected_ms(least - 1) < kNothing * expected_ms(least)) --least;
    step_ = least;
}

void Pace::full_took(double ms) {
    if (took_ms_ == std::array<double, kSteps>{}) frame_took(1.0, ms);
}

}  // namespace inktrace::viewer
