#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "base/team.h"
#include "lines/folds.h"
#include "lines/segment_squares.h"
#include "render/edges_plan.h"
#include "render/line_finder.h"

namespace ink {

/// Joins and drops pieces of self-occlusions, and closes gaps of these and of creases, among the
/// lines found in all tiles, which must have kept their segments.
class LineMender {
  public:
    /// One finder a thread, which have ended their search, for rays; they count these.
    LineMender(const EdgesPlan& edges, const std::vector<std::unique_ptr<LineFinder>>& finders,
               std::vector<TileLines>& found, std::vector<std::vector<Segment>>& toned, Team& team);

    /// For the team's leader.
    void mend();

    const RenderStats& stats() const { return stats_; }

  private:
    /// Where a line was found.
    struct Place {
        std::uint32_t tile, index;
    };

    bool has_breaks() const;
    /// Whether a line is a self-occlusion that may be broken.
    bool is_fold(const Segment& segment) const;
    void gather();
    void mend_folds();
    float spacing() const { return 1.0F / static_cast<float>(edges_.q); }
    float width() const;
    float least_width() const;
    float judged() const { return std::max(width(), least_width()); }
    void close_gaps();
    void ease_joints();
    void repair_toned();
    void change();

    const EdgesPlan& edges_;
    const std::vector<std::unique_ptr<LineFinder>>& finders_;
    std::vector<TileLines>& found_;
    std::vector<std::vector<Segment>>& toned_;
    Team& team_;
    std::vector<bool> convex_;    ///< objects that have no folds, by their numbers
    std::vector<Segment> lines_;  ///< seen directly, but not between faces; then what joins them
    std::vector<Place> places_;   ///< of the first ones
    std::optional<plane::SegmentSquares> squares_;  ///< likewise
    FoldRepairs repairs_;
    RenderStats stats_;
};

}  // namespace ink
