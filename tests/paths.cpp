#include "paths.h"

namespace ink::test {

std::filesystem::path source_dir() { return INKTRACE_SOURCE_DIR; }

std::filesystem::path data_dir() { return source_dir() / "../shared/data"; }

std::filesystem::path program() { return INKTRACE_PROGRAM; }

}  // namespace ink::test
