#pragma once

#include <functional>
#include <span>
#include <string>

#include "window/interface.h"

namespace inktrace::viewer {

/// A key and what it does; the help shows those that say so.
struct Shortcut {
    const char* key;       ///< as in Input::key
    const char* shown_as;  ///< several keys that go together are shown once
    const char* what;      ///< null: not in the help
    std::function<void(Interface&)> action;
};

std::span<const Shortcut> shortcuts();

struct MouseHelp {
    const char* keys;
    const char* what;
};
std::span<const MouseHelp> mouse_help();

/// Does what the key is for; false where it is for nothing.
bool press(Interface& interface, const std::string& key);

}  // namespace inktrace::viewer
