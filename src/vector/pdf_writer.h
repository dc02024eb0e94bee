#pragma once

#include <filesystem>

#include "vector/line_art.h"

namespace ink {

/// Writes one page of PDF of the picture's size on paper. Lines and regions are paths; there is no
/// text. The file appears whole or not at all, and the same drawing gives the same bytes. Throws
/// OutputError.
void write_pdf(const std::filesystem::path& file, const LineArt& art);

}  // namespace ink
