#pragma once

#include <span>

#include "shading/shading.h"

namespace ink {

/// Colours of a block of pixels with q x q lattice points each, q from 2 to 4: the means over the
/// points, of which `blocks` holds q x q blocks, row by row.
ColorPacket mean_of_blocks(std::span<const ColorPacket* const> blocks, int q);

}  // namespace ink
