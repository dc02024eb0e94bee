#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace inktrace::viewer {

/// The rules of `--line` as rows: one for each type or object that has a style of its own.
class LineRules {
  public:
    /// Of the text of the setting "line".
    explicit LineRules(std::string_view text);
    std::string text() const;

    /// What lines of a type have for a key ("width", "color", "opacity"), by rules for the type or
    /// for all, whatever the object; nothing where no rule says.
    std::optional<std::string> get(std::string_view type, std::string_view key) const;
    /// Adds to the rule of that type, or takes the key out of it where the value is empty. Rules of
    /// single objects stay, and stay later.
    void set(std::string_view type, std::string_view key, const std::string& value);
    /// Whether the type has a rule of its own.
    bool has(std::string_view type) const;
    void clear(std::string_view type);

  private:
    struct Rule {
        std::string target;  ///< "crease", "all@2"
        std::vector<std::pair<std::string, std::string>> values;
    };
    std::vector<Rule> rules_;
};

}  // namespace inktrace::viewer
