#pragma once

#include <filesystem>

#include "vector/line_art.h"

namespace ink {

/// Writes an SVG 1.1 file: `viewBox` in pixels, the size on paper by the dpi; a layer for the
/// shaded image or the regions, and one for each type of line (docs/formats.md). Coordinates have
/// two decimals. The file appears whole or not at all, and the same drawing gives the same bytes.
/// Throws OutputError.
void write_svg(const std::filesystem::path& file, const LineArt& art);
/// The same, packed by gzip (.svgz), to about a fifth.
void write_svgz(const std::filesystem::path& file, const LineArt& art);

}  // namespace ink
