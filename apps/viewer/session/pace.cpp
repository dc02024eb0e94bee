#include "session/pace.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace inktrace::viewer {

namespace {

constexpr std::array kScales{1.0, 0.75, 0.5, 0.375, 0.25};

std::size_t step_of(double scale) {
    const auto* const found = std::ranges::find(kScales, scale);
    return static_cast<std::size_t>(found - kScales.begin()) % kScales.size();
}

/// What costs no more than so many times the least is as good.
constexpr double kNothing = 1.1;

}  // namespace

double Pace::scale() const { return kScales[step_]; }

void Pace::plain_took(double ms) {
    // Lines may add a fifth. Below the shortest, nobody sees a frame come sooner.
    constexpr double kWithLines = 1.2;
    constexpr double kShortest = 8.0;
    target_ms_ = std::clamp(kWithLines * ms, kShortest, kLongest);
    // Of fewer rays, too slow as well, it may have been another program's fault: see again.
    if (took_ms_[step_] > target_ms_) forget();
}

void Pace::forget() {
    took_ms_ = {};
    frames_ = 0;
}

void Pace::go_to(std::size_t step) {
    if (step != step_) frames_ = 0;
    step_ = step;
}

double Pace::fastest_ms() const {
    return *std::min_element(frame_ms_.begin(), frame_ms_.begin() + std::min(frames_, kFrames));
}

/// As seen, or by the nearest steps that were.
double Pace::expected_ms(std::size_t step) const {
    std::optional<std::size_t> more;  // rays
    std::optional<std::size_t> fewer;
    for (std::size_t k = 0; k < kSteps; ++k) {
        if (took_ms_[k] <= 0.0) continue;
        if (k <= step) more = k;
        if (k >= step && !fewer) fewer = k;
    }
    const auto at = [&](std::size_t known, double power) {
        return took_ms_[known] * std::pow(kScales[step] / kScales[known], power);
    };
    // Between the sides of a picture and its area: lines cost by their length.
    double power = 1.5;
    if (more && fewer && *more != *fewer) {
        power = std::log(took_ms_[*more] / took_ms_[*fewer]) /
                std::log(kScales[*more] / kScales[*fewer]);
    }
    if (more) return at(*more, power);
    return fewer ? at(*fewer, power) : 0.0;
}

void Pace::frame_took(double scale, double ms) {
    go_to(step_of(scale));
    const bool first_frames = frames_ < kFrames;
    frame_ms_[frames_++ % kFrames] = ms;
    const double before = took_ms_[step_];
    took_ms_[step_] = fastest_ms();
    // From then on the view makes frames dearer or cheaper, of all steps alike.
    for (std::size_t k = 0; k < kSteps && !first_frames; ++k) {
        if (k != step_) took_ms_[k] *= took_ms_[step_] / before;
    }
    choose();
}

void Pace::full_took(double ms) {
    if (took_ms_ != std::array<double, kSteps>{}) return;
    took_ms_[0] = ms;
    step_ = 0;
    frames_ = 0;
    choose();
}

/// Fewer rays soon, more of them only with room to spare: two frames of the same cost are to be
/// drawn alike.
void Pace::choose() {
    const double now = took_ms_[step_];
    if (now > target_ms_) {
        // One slow frame may be another program's fault, unless it is very slow.
        constexpr double kVery = 1.5;
        constexpr std::size_t kSome = 3;
        if (frames_ > 0 && frames_ < kSome && now < kVery * target_ms_) return;
        for (std::size_t step = step_ + 1; step < kSteps; ++step) {
            if (expected_ms(step) <= target_ms_) return go_to(step);
        }
        const std::size_t cheapest = cheapest_step();
        if (cheapest > step_ || frames_ >= kFrames) go_to(cheapest);
        return;
    }
    if (frames_ < kFrames) return;
    for (std::size_t step = 0; step < step_; ++step) {
        const double room = took_ms_[step] > 0.0 ? 0.9 : 0.75;  // less where it was seen
        if (expected_ms(step) <= room * target_ms_) return go_to(step);
    }
}

/// Where none is fast enough: as many rays as cost next to nothing.
std::size_t Pace::cheapest_step() const {
    std::size_t cheapest = 0;
    for (std::size_t step = 1; step < kSteps; ++step) {
        if (expected_ms(step) < expected_ms(cheapest)) cheapest = step;
    }
    const double bearable_ms = kNothing * expected_ms(cheapest);
    while (cheapest > 0 && expected_ms(cheapest - 1) < bearable_ms) --cheapest;
    const bool has_more = step_ < cheapest && expected_ms(step_) < bearable_ms;
    return has_more ? step_ : cheapest;
}

}  // namespace inktrace::viewer
