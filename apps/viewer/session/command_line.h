#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "inktrace/settings.h"

namespace inktrace::viewer {

/// A word as a POSIX shell reads it back.
std::string shell_quoted(std::string_view word);

/// The command that draws the same picture: `inktrace render FILES -o OUTPUT FLAGS`. `base` is what
/// the program starts from: its defaults, and over them the settings of scene files among `files`.
std::string command_line(const std::vector<std::filesystem::path>& files,
                         const std::filesystem::path& output, const Settings& settings,
                         const Settings& base);

/// Writes a scene file (docs/scene-file.md) that names the files and holds the settings. Of a scene
/// file among them, the objects are copied. Throws Error (input).
void save_scene(const std::filesystem::path& output,
                const std::vector<std::filesystem::path>& files, const Settings& settings);

}  // namespace inktrace::viewer
