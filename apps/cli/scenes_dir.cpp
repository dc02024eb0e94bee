#include "scenes_dir.h"

#include <filesystem>
#include <system_error>

namespace inktrace::cli {

std::string scenes_dir() {
    namespace fs = std::filesystem;
    std::error_code failure;
    const fs::path program = fs::read_symlink("/proc/self/exe", failure);
    const fs::path installed = program.parent_path().parent_path() / "share/inktrace/scenes";
    return fs::is_directory(installed, failure) ? installed.string() : INKTRACE_SCENES_DIR;
}

}  // namespace inktrace::cli
