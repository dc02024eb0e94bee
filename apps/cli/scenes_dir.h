#pragma once

#include <string>

namespace inktrace::cli {

/// Where the scenes of the gallery are unless told; a build is run from its tree.
std::string scenes_dir();

}  // namespace inktrace::cli
