#pragma once

/// The public interface of Inktrace: files are loaded into a Scene, a Renderer is made of it, which
/// renders Pictures by Settings, and these are saved. See examples/ for programs that use nothing
/// else.

#include "inktrace/error.h"
#include "inktrace/lines.h"
#include "inktrace/render.h"
#include "inktrace/scene.h"
#include "inktrace/settings.h"

namespace inktrace {

/// "0.1.0"
const char* version();

/// Removes what `Picture::save` has begun and not finished, for a program that is about to end.
/// Safe to call from a signal handler.
void remove_unfinished_files() noexcept;

}  // namespace inktrace
