#pragma once

#include <optional>
#include <vector>

#include "lines/density.h"
#include "lines/segment.h"
#include "render/border_map.h"
#include "render/edges.h"
#include "render/face_map.h"
#include "render/face_tiling.h"
#include "render/pipeline.h"

namespace ink {

/// What the pass that finds lines leaves to the pass that draws them.
struct FoundLines {
    std::vector<TileLines> tiles;              ///< of each of the tiles that were searched
    std::vector<std::vector<Segment>> toned;   ///< likewise, see LineFinder::take_toned
    std::vector<std::vector<Segment>> hidden;  ///< likewise, on surfaces behind
    LineThinning thinning;                     ///< where they are dense
    std::optional<FaceMap> faces;              ///< for lines between faces
    std::optional<BorderMap> borders;          ///< likewise, instead
    std::optional<FaceTiling> tiling;          ///< likewise, on a larger picture
};

/// Shades the film and finds its lines.
FoundLines find_lines(const Edges& edges, WorkLoop& loop, RenderStats& stats);
/// Joins the hidden lines of the whole picture, so that dashes do not start anew in every tile, and
/// puts their strokes among the others.
void add_hidden_strokes(const Edges& edges, FoundLines& found);
/// Draws what `find_lines` found on the film.
void draw_lines(const Edges& edges, const FoundLines& found, WorkLoop& loop, RenderStats& stats);

}  // namespace ink
