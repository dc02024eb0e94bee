#pragma once

#include "render_arguments.h"

namespace inktrace::cli {

/// Whether the arguments ask for several pictures. Throws Error (usage) where they contradict
/// themselves.
bool is_animation(const RenderArguments& arguments);

/// Renders them, as numbered pictures or a film.
void run_animation(const RenderArguments& arguments);

}  // namespace inktrace::cli
