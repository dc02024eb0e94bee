#pragma once

#include <span>

#include "base/image.h"
#include "vector/line_art.h"

namespace ink {

/// Gives each region the mean of the pixels within it, taken in linear light; one that is too small
/// to have any, that of the pixels whose centres it covers, or else of the nearest.
void color_regions(std::span<Region> regions, const DisplayImage& image, int threads);

}  // namespace ink
