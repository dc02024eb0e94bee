#include "animation.h"

#include <fmt/format.h>

namespace inktrace::cli {

bool is_numbered(std::string_view output) { return output.find('#') != std::string_view::npos; }

std::string numbered(std::string_view output, int number) {
    const std::size_t last = output.rfind('#');
    if (last == std::string_view::npos) return std::string(output);
    std::size_t first = last;
    while (first > 0 && output[first - 1] == '#') --first;
    return fmt::format("{}{:0{}}{}", output.substr(0, first), number, last - first + 1,
                       output.substr(last + 1));
}

FrameRange frame_range(const Settings& settings, int frames) {
    const std::string text = settings.get("frame");
    const std::size_t colon = text.find(':');
    FrameRange range;
    range.first = std::stoi(text.substr(0, colon));
    range.last = range.first;
    if (colon != std::string::npos) {
        const std::string end = text.substr(colon + 1);
        range.last = end.empty() ? frames - 1 : std::stoi(end);
    }
    if (range.last < frames && range.first <= range.last) return range;
    throw Error(Error::Kind::input,
                fmt::format("--frame {}: there are {} frames, 0 to {}", text, frames, frames - 1));
}

std::vector<Shot> plan_shots(std::string_view output, FrameRange frames, int views) {
    std::vector<Shot> shots;
    for (int k = 0; k < views; ++k) {
        shots.push_back({frames.first, 360.0 * k / views, numbered(output, k)});
    }
    if (views > 0) return shots;
    for (int frame = frames.first; frame <= frames.last; ++frame) {
        shots.push_back({frame, 0.0, numbered(output, frame)});
    }
    return shots;
}

}  // namespace inktrace::cli
