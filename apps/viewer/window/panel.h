#pragma once

#include "window/interface.h"

namespace inktrace::viewer {

/// The panel at the window's right side: the file, what was clicked at, and every setting.
/// `left` and `width` are pixels.
void draw_panel(Interface& interface, float left, float width, float height);

inline constexpr float kPanelPoints = 340.0F;

}  // namespace inktrace::viewer
