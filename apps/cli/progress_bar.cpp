#include "progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include <string>

#include "messages.h"

namespace inktrace::cli {

namespace {

constexpr auto kQuietStart = std::chrono::milliseconds(400);
constexpr auto kInterval = std::chrono::milliseconds(100);
constexpr int kBarWidth = 30;

}  // namespace

ProgressBar::ProgressBar(bool wanted) : enabled_(wanted && isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
    if (drawn_) say("\r\033[K");
}

void ProgressBar::update(double share, double megapixels) {
    if (!enabled_) return;
    const Clock::time_point now = Clock::now();
    if (now - start_ < kQuietStart || now - last_ < kInterval) return;
    last_ = now;
    drawn_ = true;

    const double seconds = std::chrono::duration<double>(now - start_).count();
    const int left = static_cast<int>(seconds / share - seconds + 0.5);
    const int filled = static_cast<int>(share * kBarWidth);
    say(fmt::format("\r[{:<{}}] {:3.0f} %  {:.2f} Mpixel/s  {}:{:02} left\033[K",
                    std::string(static_cast<std::size_t>(filled), '#'), kBarWidth, share * 100.0,
                    megapixels * share / seconds, left / 60, left % 60));
}

}  // namespace inktrace::cli
