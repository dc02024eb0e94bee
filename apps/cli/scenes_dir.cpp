#include "scenes_dir.h"

#include <filesystem>
#include <system_error>

namespace inktrace::cli {

std::string scenes_dir() {
    namespace fs = std::filesystem;
    std::error_code failure;
    const fs::path program = fs::read_symlink("/proc/self/exe", failure);
    return (program.parent_path() / INKTRACE_DATA / "scenes").lexically_normal().string();
}

}  // namespace inktrace::cli
