#pragma once

#include "window/interface.h"

namespace inktrace::viewer {

/// Dialogs that are open: files to open, pictures to write, help.
void draw_dialogs(Interface& interface);

/// Copies the command line of the picture in the window, and prints it.
void copy_command(Interface& interface);

}  // namespace inktrace::viewer
