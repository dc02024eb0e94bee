#pragma once

#include "inktrace/inktrace.h"

namespace inktrace::cli {

/// Adds a tube along a (2, 3) torus knot, in triangles: a mesh to look at where none was named.
void add_knot(Scene& scene);

}  // namespace inktrace::cli
