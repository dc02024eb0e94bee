#pragma once

#include "lines/chain.h"
#include "lines/segment_graph.h"

namespace ink {

/// Makes junctions one where a line leads from one to the other within a pixel: what lies between
/// is smaller than a pixel, and whether a lattice comes upon it is chance, so that a finer lattice
/// would find ever more lines. For the same reason takes out the rims of holes narrower than that,
/// and one of two lines that such a slit lies between.
/// `lines` are the chains of the graph, with their junctions in place.
/// Returns whether the graph has changed, whose junctions are then at their places as well.
bool merge_near_junctions(SegmentGraph& graph, const ChainedWays& lines);

}  // namespace ink
