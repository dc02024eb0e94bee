#pragma once

#include <vector>

#include "lines/chain.h"
#include "lines/segment.h"

namespace ink {

/// A broken line: its strokes run from one middle of a round end to the other.
struct Dashes {
    double stroke = 0.0, gap = 0.0;  ///< pixels along the line
    friend bool operator==(const Dashes&, const Dashes&) = default;
};

/// Stretched or shrunk a little, so that a line of this length begins and ends with a whole stroke,
/// or if it is closed, has no seam. A line shorter than two strokes is one, of its full length.
Dashes fit_dashes(const Dashes& usual, double length, bool closed);

/// The chain's strokes as segments, in its order; all of it without dashes. Their ends are not
/// shared as those of found segments are.
void cut_into_strokes(const Chain& chain, const Dashes* dashes, std::vector<Segment>& strokes);

}  // namespace ink
