#pragma once

#include <span>

#include "lines/chain.h"

namespace ink {

/// All that it takes to make lines for vector output of segments of one level: chains, junctions at
/// their places and none too near to another, sharp corners split. Threads: 0 for all of the
/// machine's.
ChainGraph chain_lines(std::span<const Segment> segments, float spacing, int threads);

}  // namespace ink
