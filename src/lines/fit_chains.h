#pragma once

#include <vector>

#include "lines/chain.h"
#include "lines/fit.h"

namespace ink {

/// A curve for each chain, in their order, from its first point to its last. Curves that meet share
/// the point exactly, and along a path the tangent. Uses up to `threads` threads (0: all); the
/// result does not depend on it.
std::vector<Curve> fit_chains(const ChainGraph& graph, const FitSettings& settings,
                              int threads = 0);

}  // namespace ink
