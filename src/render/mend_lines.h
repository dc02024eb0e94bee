#pragma once

#include <vector>

#include "render/edges.h"

namespace ink {

/// Joins and drops pieces of self-occlusions (mend_folds) among the lines found in all tiles, which
/// must have kept their segments. Returns what that took.
RenderStats mend_lines(const Edges& edges, std::vector<TileLines>& found,
                       std::vector<std::vector<Segment>>& toned);

}  // namespace ink
