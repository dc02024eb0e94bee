#include "session/history.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace inktrace::viewer {

namespace {

constexpr std::array<std::string_view, 7> kOfView{"size", "view",  "eye",         "look-at",
                                                  "up",   "frame", "orthographic"};

/// The settings of `other`, seen by the camera of `current`.
Settings with_view_of(const Settings& current, Settings other) {
    for (const std::string_view name : kOfView) other.set(name, current.get(name));
    return other;
}

}  // namespace

bool is_of_view(const std::string& name) {
    return std::ranges::find(kOfView, name) != kOfView.end();
}

void History::remember(const Settings& before, const std::string& name, Clock::time_point now) {
    constexpr auto kOneChange = std::chrono::milliseconds(700);
    const bool continues = name == last_name_ && now - last_time_ < kOneChange && !past_.empty();
    last_name_ = name;
    last_time_ = now;
    future_.clear();
    if (continues) return;
    constexpr std::size_t kMost = 200;
    if (past_.size() == kMost) past_.erase(past_.begin());
    past_.push_back(before);
}

Settings History::undo(const Settings& current) {
    Settings settings = with_view_of(current, past_.back());
    past_.pop_back();
    future_.push_back(current);
    last_name_.clear();
    return settings;
}

Settings History::redo(const Settings& current) {
    Settings settings = with_view_of(current, future_.back());
    future_.pop_back();
    past_.push_back(current);
    last_name_.clear();
    return settings;
}

Settings History::take_back(const Settings& current) {
    Settings settings = with_view_of(current, past_.back());
    past_.pop_back();
    last_name_.clear();
    return settings;
}

void History::clear() {
    past_.clear();
    future_.clear();
    last_name_.clear();
}

}  // namespace inktrace::viewer
