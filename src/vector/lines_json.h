#pragma once

#include <filesystem>

#include "vector/line_art.h"

namespace ink {

/// Writes the polylines as JSON (docs/formats.md). Likewise.
void write_lines_json(const std::filesystem::path& file, const LineArt& art);

}  // namespace ink
