#pragma once

#include <memory>
#include <vector>

#include "render/edges.h"
#include "render/line_finder.h"

namespace ink {

/// Joins and drops pieces of self-occlusions (mend_folds), and closes gaps of these and of creases
/// (close_gaps), among the lines found in all tiles, which must have kept their segments, with one
/// finder a thread, made where there is none yet. Returns what that took; the finders count their
/// rays.
RenderStats mend_lines(const Edges& edges, std::vector<std::unique_ptr<LineFinder>>& finders,
                       std::vector<TileLines>& found, std::vector<std::vector<Segment>>& toned);

}  // namespace ink
