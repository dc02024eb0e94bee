#include "scenes_dir.h"

namespace inktrace::cli {

std::string scenes_dir() { return INKTRACE_SCENES_DIR; }

}  // namespace inktrace::cli
