#pragma once

namespace inktrace::viewer {

/// Font, colours and sizes of the user interface, for a screen of so many pixels a point.
void set_theme(float scale);

}  // namespace inktrace::viewer
