#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "io/reader.h"
#include "render/settings.h"

namespace ink {

/// Whether a file is a scene by its name: .json or .json.gz.
bool is_scene_file(const std::filesystem::path& file);

/// The settings that a scene file asks for, in order, as names and values that `find_setting` and
/// its `set` take. Throws InputError, with line and key, for what the table of settings refuses.
std::vector<std::pair<std::string, std::string>> read_scene_settings(
    const std::filesystem::path& file);

/// The objects of a scene file (docs/scene-file.md). Files that it names are read by `settings`,
/// where an object says nothing else. Throws InputError with line and key.
/// With `facts`, what they say about each atom and particle is kept.
FileContents read_scene_file(const std::filesystem::path& file, const Settings& settings,
                             bool facts = false);

}  // namespace ink
