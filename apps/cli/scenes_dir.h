#pragma once

#include <string>

namespace inktrace::cli {

/// Where the scenes of the gallery are unless told: installed with the program, or in the tree that
/// it was built from.
std::string scenes_dir();

}  // namespace inktrace::cli
