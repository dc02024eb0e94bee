#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lines/fold_graph.h"
#include "lines/fold_probe.h"
#include "lines/folds.h"
#include "lines/segment_squares.h"

namespace ink {

/// A self-occlusion that ends on a line, with one of its ends.
struct FoldHang {
    std::uint32_t fold, line;
    bool at_b;
};

/// How self-occlusions end. Each is named by the segment that does.
struct FoldEndings {
    std::vector<FoldHang> hangs;
    std::vector<FoldHang> followers;   ///< those of them that go on as the line does
    std::vector<std::uint32_t> stubs;  ///< on a cell's side, where nothing goes on, near a line
    std::vector<std::uint32_t> loose;  ///< on nothing before bridges were built,
    std::vector<std::uint32_t> free;   ///< and after
};

/// Groups of self-occlusions that are too short and shallow to mean anything.
class FoldCrumbs {
  public:
    /// `squares`: those of `lines`.
    FoldCrumbs(std::span<const Segment> lines, const plane::SegmentSquares& squares,
               FoldGraph& graph, const FoldProbe& probe, const FoldLoop& loop, float spacing,
               float width, const FoldSettings& settings)
        : lines_(lines),
          squares_(squares),
          graph_(graph),
          probe_(probe),
          loop_(loop),
          spacing_(spacing),
          stroke_(width),
          width_(std::max(width, settings.least_width)),
          settings_(settings),
          groups_(lines.size()) {}

    /// Segments to drop, by their indices, ascending. `bridges` start from their `owners` on.
    /// Unites groups that follow each other.
    std::vector<std::size_t> find(const FoldEndings& endings, std::span<const Segment> bridges,
                                  std::span<const std::uint32_t> owners);
    /// Whether a segment is one of those.
    bool has(std::uint32_t fold) const { return groups_[graph_.root(fold)].crumb; }

  private:
    /// What is known of a group, at its root.
    struct Group {
        float length = 0.0F;
        float depth = -1.0F;      ///< the greatest that was measured; less than zero: none was
        std::uint32_t folds = 0;  ///< that were counted on the way to a measurement
        bool measured = false;    ///< as far as it matters
        bool loose = false;       ///< has an end that ends on nothing before bridges were built,
        bool free = false;        ///< or still does
        bool attached = false;    ///< ends on a line
        bool stub = false;        ///< ends on one whose end it does not share
        bool leaves = false;      ///< some of it is not covered by the outlines beside it
        bool crumb = false;
    };

    Group& group_of(std::uint32_t fold) { return groups_[graph_.root(fold)]; }
    void unite_followers(std::span<const FoldHang> followers);
    void attach(std::span<const FoldHang> hangs);
    bool judge();
    bool is_dot(std::uint32_t root) const;
    void find_bumps();
    bool runs_on_outline(Vec2f point) const;
    bool is_short(const Group& group) const;
    float least_length(const Group& group) const;
    bool may_be_shallow(const Group& group) const;
    template <class Asked>
    void measure(Asked asked);
    void measure_all(std::vector<std::uint32_t>& folds);

    std::span<const Segment> lines_;
    const plane::SegmentSquares& squares_;
    FoldGraph& graph_;
    const FoldProbe& probe_;
    const FoldLoop& loop_;
    float spacing_;
    float stroke_;  ///< width of the line, pixels
    float width_;   ///< that lengths are counted in
    const FoldSettings& settings_;
    std::vector<Group> groups_;
    std::vector<std::uint32_t> roots_;  ///< of the groups
};

}  // namespace ink
