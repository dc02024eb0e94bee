#pragma once

#include "lines/chain.h"

namespace ink {

/// Splits chains at sharp corners (kCornerDeg), each of which becomes a vertex where the line's two
/// sides meet (PathStep::at_corner). Corners near an end of a chain or near another one are left. A
/// closed chain stays closed, and starts at its corner, if it has just one. Threads: 0 for all of
/// the machine's.
void split_at_corners(ChainGraph& graph, int threads);

}  // namespace ink
