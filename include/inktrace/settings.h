#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace inktrace {

/// One setting, as help and user interfaces show it.
struct SettingInfo {
    std::string name;           ///< "line-width"; on the command line "--line-width"
    std::string topic;          ///< "Lines"
    std::string value;          ///< how a value is written: "LEN"
    std::string help;           ///< one sentence, no full stop
    std::string default_value;  ///< in the form that `Settings::set` reads; empty: automatic
    bool repeatable = false;    ///< `set` adds to earlier values; an empty one clears them
};

/// All settings, grouped by topic.
const std::vector<SettingInfo>& all_settings();

/// Everything that decides what a picture looks like, as the command line knows it:
///
///     inktrace::Settings settings;
///     settings.set("size", "800x600").set("line-width", "0.5pt");
class Settings {
  public:
    Settings();
    Settings(const Settings& other);
    Settings(Settings&&) noexcept;
    Settings& operator=(const Settings& other);
    Settings& operator=(Settings&&) noexcept;
    ~Settings();

    /// Throws Error (usage) for a name that does not exist or a value that makes no sense, and
    /// says what does.
    Settings& set(std::string_view name, std::string_view value);
    /// The value in the form that `set` reads; empty where it is chosen automatically.
    std::string get(std::string_view name) const;
    /// Names and values of the settings that differ from their defaults.
    std::vector<std::pair<std::string, std::string>> changed() const;

    struct Impl;
    const Impl& impl() const { return *impl_; }

  private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace inktrace
