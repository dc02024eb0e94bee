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
    // Where many lie close to each other, some are near only once others are one.
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds && merge_near_junctions(graph, lines); ++round) {
        steady_types(graph);
        lines = chain_ways(graph);
    }
    split_at_corners(lines.graph, threads);
    return std::move(lines.graph);
}

}  // namespace ink
