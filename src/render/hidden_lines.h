#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "lines/segment.h"
#include "render/edges_plan.h"
#include "render/line_finder.h"
#include "render/tiles.h"

namespace ink {

/// Finds the lines on surfaces behind others, one tile after another.
class HiddenLineFinder {
  public:
    explicit HiddenLineFinder(const EdgesPlan& edges);

    /// Searches, layer by layer, the tile that `front` has just searched. Leaves out what lies
    /// under lines of the layers before: what an outline uncovers changes every layer behind it.
    std::vector<Segment> search(const Tile& tile, const LineFinder& front);

    RenderStats stats() const;

  private:
    /// An edge of the lattice, and where along it a line crosses, in [0, 1].
    using Place = std::pair<std::uint64_t, float>;

    void mark_known(const LineFinder& layer);
    void keep_places(const LineFinder& layer);
    bool is_known(Vec2f point) const;

    const EdgesPlan& edges_;
    std::vector<std::unique_ptr<LineFinder>> layers_;  ///< behind the first one
    std::vector<Place> places_;                        ///< of the layers before, in order
    std::vector<std::uint64_t> known_;                 ///< crossings at such places, by their bits
};

/// The strokes in which hidden lines are drawn on pixels.
std::vector<Segment> hidden_strokes(const EdgesPlan& edges, std::span<const Segment> lines);

}  // namespace ink
