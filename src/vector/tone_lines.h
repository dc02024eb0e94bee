#pragma once

#include <vector>

#include "lines/chain.h"
#include "lines/curve.h"
#include "vector/line_art.h"

namespace ink {

/// Lines that were joined, and a curve for each chain.
struct CurveGraph {
    ChainGraph graph;
    std::vector<Curve> curves;
};

/// Takes the curves from small spots of light or shade, so that no region has them.
void drop_spots(CurveGraph& lines);

/// Turns tones on the sides of regions and lines into geometries again (Tones), drops the borders
/// of tones from the lines, and joins the lines that these have cut. Paths are empty afterwards.
void name_tones(std::vector<Region>& regions);
void name_tones(CurveGraph& lines);

}  // namespace ink
