#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace inktrace {

/// What a value may be, as user interfaces offer it. `Settings::set` has the last word.
struct ValueForm {
    enum class Kind {
        text,    ///< anything, or one of `words`
        word,    ///< one of `words`
        list,    ///< some of `words`, with commas between, or "none", or "all"
        whole,   ///< a whole number from `least` to `most`
        number,  ///< from `least` to `most`
        length,  ///< a number from `least` to `most` pixels, or in pt, mm or %
        color    ///< a name or #rrggbb
    };
    Kind kind = Kind::text;
    std::vector<std::string> words{};
    double least = 0.0, most = 0.0;  ///< what is usual: more may be allowed
};

/// One setting, as help and user interfaces show it.
struct SettingInfo {
    std::string name;           ///< "line-width"; on the command line "--line-width"
    std::string topic;          ///< "Lines"
    std::string value;          ///< how a value is written: "LEN"
    std::string help;           ///< one sentence, no full stop
    std::string default_value;  ///< in the form that `Settings::set` reads; empty: automatic
    bool repeatable = false;    ///< `set` adds to earlier values; an empty one clears them
    ValueForm form{};
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
    /// Names and values that, set one after the other, give these settings again: the look, if
    /// there is one, then what differs from it, else from the defaults.
    std::vector<std::pair<std::string, std::string>> changed() const;

    /// The same picture at `factor` times the size: lengths that are given in pixels, and those in
    /// points and millimetres, grow with it.
    Settings scaled(double factor) const;

    struct Impl;  ///< the library's own
    const Impl& impl() const { return *impl_; }

  private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace inktrace
