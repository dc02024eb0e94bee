#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "lines/density.h"
#include "lines/segment.h"
#include "render/border_map.h"
#include "render/edges_plan.h"
#include "render/face_map.h"
#include "render/face_tiling.h"
#include "render/hidden_lines.h"
#include "render/line_finder.h"
#include "render/pipeline.h"
#include "render/ridge_search.h"
#include "render/work_loop.h"

namespace ink {

/// What the pass that finds lines leaves to the pass that draws them.
struct FoundLines {
    std::vector<TileLines> tiles;              ///< of each of the tiles that were searched
    std::vector<std::vector<Segment>> toned;   ///< likewise, see LineFinder::take_toned
    std::vector<std::vector<Segment>> hidden;  ///< likewise, on surfaces behind
    /// Of a draft's small picture: ridges and hidden lines, as these are found in all tiles at
    /// once.
    std::vector<Segment> of_no_tile;
    LineThinning thinning;             ///< where they are dense
    std::optional<FaceMap> faces;      ///< for lines between faces
    std::optional<BorderMap> borders;  ///< likewise, instead
    std::optional<FaceTiling> tiling;  ///< likewise, on a larger picture
};

/// Items of work that may be done while lines are mended.
struct SideWork {
    std::size_t items = 0;
    std::function<void(std::size_t item)> body;
};

/// Shades the film and finds its lines. In stages, since much of what follows the first one is for
/// one thread: a draft has work for the others.
class LineSearch {
  public:
    /// Keeps references. The loop learns how many items of work to expect.
    LineSearch(const EdgesPlan& edges, WorkLoop& loop);

    /// Tile by tile. After it, a draft's pixels are what they will be unless their shading is
    /// smoothed along lines.
    void search_tiles();
    /// Mends lines and finds ridges.
    void mend(const SideWork& beside = {});
    /// On one thread: takes those ridges that no other line is near, and tells where lines are
    /// dense. In a draft, others may read the tiles' segments meanwhile. The last stage.
    void finish();

    FoundLines& found() { return found_; }
    RenderStats stats() const;

  private:
    std::size_t items() const;
    LineFinder& finder(std::size_t worker);
    void search(std::size_t tile, std::size_t worker);
    void end_search();
    void fill_empty(std::size_t tile, std::size_t worker);
    void finish_fringe(std::size_t tile) const;
    LineDensity take_ridges();

    const EdgesPlan& edges_;
    WorkLoop& loop_;
    FoundLines found_;
    /// Tiles that may see anything, and others, which are put off until one thread mends lines.
    std::vector<std::size_t> seeing_, empty_;
    std::vector<const Fringe*> fringes_;  ///< of all tiles; none unless shading is smoothed
    std::optional<RidgeSearch> ridges_;
    std::vector<std::unique_ptr<LineFinder>> finders_;       ///< a thread
    std::vector<std::unique_ptr<HiddenLineFinder>> behind_;  ///< likewise
    RenderStats serial_;  ///< of what one thread does for all; once it is over, of all
};

/// Joins the hidden lines of the whole picture, so that dashes do not start anew in every tile, and
/// puts their strokes among the others.
void add_hidden_strokes(const EdgesPlan& edges, FoundLines& found);

}  // namespace ink
