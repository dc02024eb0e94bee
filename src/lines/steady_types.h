#pragma once

#include "lines/segment_graph.h"

namespace ink {

/// Gives the short stretches of one type along a line, from junction to junction, the type of the
/// longer one beside them.
void steady_types(SegmentGraph& graph);

}  // namespace ink
