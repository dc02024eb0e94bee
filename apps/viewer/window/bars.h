#pragma once

#include "window/interface.h"

namespace inktrace::viewer {

/// What surrounds the picture. Places are pixels of the window.

/// The lowest line: messages, or what is under the pointer, and what is being worked at.
void draw_status_bar(Interface& interface, float top, float width);
/// Frames of a trajectory: play, step, scrub. Only where there are several.
void draw_timeline(Interface& interface, float top, float width);
/// Times of the last picture, over its upper left corner.
void draw_performance(Interface& interface);
/// What there is to do, or to wait for, where there is no picture.
void draw_welcome(Interface& interface, float width, float height);

inline constexpr float kBarPoints = 28.0F;

}  // namespace inktrace::viewer
