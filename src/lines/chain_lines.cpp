#include "lines/chain_lines.h"

#include "lines/corners.h"
#include "lines/junctions.h"
#include "lines/near_junctions.h"
#include "lines/steady_types.h"

namespace ink {

ChainGraph chain_lines(std::span<const Segment> segments, float spacing, int threads) {
    SegmentGraph graph(segments, spacing);
    steady_types(graph);
    ChainedWays lines = chain_ways(graph);
    place_junctions(lines.graph, spacing);
    if (merge_near_junctions(graph, lines)) {
        steady_types(graph);
        lines = chain_ways(graph);
    }
    split_at_corners(lines.graph, threads);
    return std::move(lines.graph);
}

}  // namespace ink
