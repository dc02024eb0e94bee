#pragma once

#include <span>
#include <vector>

#include "base/image.h"
#include "lines/chain.h"
#include "lines/curve.h"
#include "vector/line_art.h"

namespace ink {

/// One region for each geometry that lines go round, in the order of IDs. Its outlines are the
/// curves of those lines, and stretches of the border of the searched rectangle where it is cut off
/// there. Neighbours therefore share their curves exactly. Colours are left open.
std::vector<Region> make_regions(const ChainGraph& graph, std::span<const Curve> curves,
                                 Vec2f lower, Vec2f upper);

}  // namespace ink
