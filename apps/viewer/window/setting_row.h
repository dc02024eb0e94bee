#pragma once

#include <string>

#include "window/interface.h"

namespace inktrace::viewer {

/// Where values begin, from the panel's left.
inline constexpr float kValuePoints = 132.0F;

/// One row of the panel: the name of a setting, and what its value can be chosen or typed with.
void setting_row(Interface& interface, const SettingInfo& info, float value_points = kValuePoints);

/// A colour to choose, "#rrggbb" or a name; true when another one was chosen.
bool color_button(const char* label, std::string& value);

/// A length to drag, which keeps its unit; true when it was changed.
bool length_slider(const char* label, std::string& value, double least_px, double most_px,
                   float width);

}  // namespace inktrace::viewer
