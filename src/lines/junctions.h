#pragma once

#include "lines/chain.h"

namespace ink {

/// Moves each junction, which is known only to lie in its lattice cell, to where the lines that
/// meet there point: the place nearest to all of them as they go on from the points before it. It
/// stays in its cell, and chains keep ending on it exactly.
void place_junctions(ChainGraph& graph, float spacing);

}  // namespace ink
