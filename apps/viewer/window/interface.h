#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>

#include "session/session.h"
#include "window/window.h"

namespace inktrace::viewer {

/// What the parts of the user interface share.
struct Interface {
    Session& session;
    Window& window;

    bool panel = true;
    bool performance = false;
    bool help = false;
    bool open_dialog = false;
    bool export_dialog = false;

    std::optional<Hit> under_pointer;
    std::optional<Hit> picked;  ///< clicked at

    /// Texts while they are typed, by the name of their setting or field.
    std::map<std::string, std::string> drafts;

    float px(float points) const { return points * window.scale(); }
    /// Changes a setting and says so where it is refused.
    void set(const std::string& name, const std::string& value);
    /// Calls what may throw Error, and says what it threw.
    template <class Action>
    void attempt(const Action& action) {
        try {
            action();
        } catch (const Error& error) {
            session.say(error.what(), true);
        }
    }
};

/// "atom CA, residue ALA 7, chain A, bfactor 20.25".
std::string describe(const Hit& hit);

}  // namespace inktrace::viewer
