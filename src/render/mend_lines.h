#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "lines/folds.h"
#include "lines/segment_squares.h"
#include "render/edges.h"
#include "render/line_finder.h"

namespace ink {

/// Joins and drops pieces of self-occlusions, and closes gaps of these and of creases, among the
/// lines found in all tiles, which must have kept their segments. In two steps: the first one needs
/// rays.
class LineMender {
  public:
    /// One finder a thread, made where there is none yet; they count their rays.
    LineMender(const Edges& edges, std::vector<std::unique_ptr<LineFinder>>& finders,
               std::vector<TileLines>& found, std::vector<std::vector<Segment>>& toned)
        : edges_(edges), finders_(finders), found_(found), toned_(toned) {}

    /// See ink::mend_folds. From then on the finders see nothing but points.
    void mend_folds();
    /// Closes what gaps are left, eases joints, and changes the lines.
    void join();

    const RenderStats& stats() const { return stats_; }

  private:
    /// Where a line was found.
    struct Place {
        std::uint32_t tile, index;
    };

    bool has_breaks() const;
    void gather();
    float spacing() const { return 1.0F / static_cast<float>(edges_.q); }
    float width() const;
    void close_gaps();
    void ease_joints();
    void repair_toned();
    void change();

    const Edges& edges_;
    std::vector<std::unique_ptr<LineFinder>>& finders_;
    std::vector<TileLines>& found_;
    std::vector<std::vector<Segment>>& toned_;
    std::vector<Segment> lines_;  ///< seen directly, but not between faces; then what joins them
    std::vector<Place> places_;   ///< of the first ones
    std::optional<plane::SegmentSquares> squares_;  ///< likewise
    FoldRepairs repairs_;
    RenderStats stats_;
};

}  // namespace ink
