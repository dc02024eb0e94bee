#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "inktrace/settings.h"

namespace inktrace::viewer {

/// Settings that were, to go back to. The camera and the size of the window are not part of it:
/// going back leaves them as they are.
class History {
  public:
    using Clock = std::chrono::steady_clock;

    /// Remembers `before`, unless the same setting has been changed a moment ago, as by a slider
    /// that moves: those are one change.
    void remember(const Settings& before, const std::string& name, Clock::time_point now);
    bool can_undo() const { return !past_.empty(); }
    bool can_redo() const { return !future_.empty(); }
    /// The settings before the last change, with the camera of `current`. There must be one.
    Settings undo(const Settings& current);
    Settings redo(const Settings& current);
    /// Forgets the last change, which has failed, and returns the settings before it.
    Settings take_back(const Settings& current);
    void clear();

  private:
    std::vector<Settings> past_, future_;
    std::string last_name_;
    Clock::time_point last_time_{};
};

/// Whether a setting belongs to the view, not to the history.
bool is_of_view(const std::string& name);

}  // namespace inktrace::viewer
