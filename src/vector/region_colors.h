#pragma once

#include <span>

#include "base/image.h"
#include "vector/line_art.h"

namespace ink {

/// Gives each region the mean of the pixels whose centres it covers, taken in linear light; one
/// that covers none, that of the nearest pixel.
void color_regions(std::span<Region> regions, const DisplayImage& image, int threads);

}  // namespace ink
