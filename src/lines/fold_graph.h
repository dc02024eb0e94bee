#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "lines/end_table.h"
#include "lines/segment.h"

namespace ink {

/// An end of a self-occlusion: a segment, and which of its ends.
struct FoldEnd {
    std::uint32_t fold;
    bool at_b;
};

/// How self-occlusions hang together: which go on from each other at their ends, and which are of
/// one group. Segments are named by their indices among all lines of the picture.
class FoldGraph {
  public:
    explicit FoldGraph(std::span<const Segment> lines);

    bool is_fold(std::uint32_t k) const { return lines_[k].type == LineType::self_occlusion; }
    std::span<const std::uint32_t> folds() const { return folds_; }
    Vec2f point(FoldEnd end) const { return end.at_b ? lines_[end.fold].b : lines_[end.fold].a; }

    /// The group of a line: the least index in it. One that is no fold is a group of its own.
    std::uint32_t root(std::uint32_t k) const {
        while (parents_[k] != k) k = parents_[k] = parents_[parents_[k]];
        return k;
    }
    void unite(std::uint32_t a, std::uint32_t b);
    /// The groups of all lines as they are now.
    std::vector<std::uint32_t> roots() const;

    bool ends_at(Vec2f point) const { return table_.at(point).count == 1; }
    /// From which nothing goes on, by place.
    std::vector<FoldEnd> loose_ends() const;
    /// The end of another segment at which the line goes on; nothing if there is not just one.
    std::optional<FoldEnd> next(FoldEnd end) const;
    /// A point on the line some pixels before its end, `enough` if it is that long.
    Vec2f back_from(FoldEnd end, float enough) const;

    /// End 2 k is a of fold k, 2 k + 1 is b.
    static std::uint32_t number(FoldEnd end) { return 2 * end.fold + (end.at_b ? 1 : 0); }

    /// An end of a piece, and how far it is away along the piece.
    struct NearEnd {
        std::uint32_t end = std::numeric_limits<std::uint32_t>::max();
        float away = std::numeric_limits<float>::infinity();
    };
    /// That which a fold comes to soon, from a point beside it on, towards one of its ends.
    NearEnd end_near(FoldEnd towards, Vec2f from) const;

  private:
    static FoldEnd end_of(std::uint32_t number) { return {number / 2, number % 2 != 0}; }

    std::span<const Segment> lines_;
    std::vector<std::uint32_t> folds_;
    plane::EndTable table_;
    mutable std::vector<std::uint32_t> parents_;  ///< a forest; paths get shorter when walked
};

}  // namespace ink
