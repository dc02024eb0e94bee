#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lines/segment.h"

namespace ink {

/// A segment and one of the two ways along it: twice the segment's index, plus one for the way
/// back.
using Way = std::uint32_t;

constexpr Way opposite(Way way) { return way ^ 1U; }

/// Segments joined at their ends: which ways lead on from where one ends. Segments are cut in two
/// where another one of their cell ends on them, and are in an order that does not depend on the
/// one they come in.
class SegmentGraph {
  public:
    static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

    /// `spacing` is the lattice's, in pixels.
    SegmentGraph(std::span<const Segment> segments, float spacing);

    std::size_t size() const { return segments_.size(); }
    /// Ways are 0 to this, without it.
    Way ways() const { return static_cast<Way>(ends_.size()); }

    const Segment& segment(Way way) const { return segments_[way >> 1U]; }
    bool back(Way way) const { return (way & 1U) != 0; }
    /// Vertices, which have equal numbers where points are bitwise equal.
    std::uint32_t start(Way way) const { return ends_[way]; }
    std::uint32_t finish(Way way) const { return ends_[opposite(way)]; }
    Vec2f start_point(Way way) const { return back(way) ? segment(way).b : segment(way).a; }
    GeometryId left(Way way) const { return back(way) ? segment(way).right : segment(way).left; }
    GeometryId right(Way way) const { return back(way) ? segment(way).left : segment(way).right; }
    bool left_in_front(Way way) const { return segment(way).left_in_front != back(way); }

    /// The way on that belongs to the same line between the same sides, where no other line meets
    /// it; or kNone.
    Way only_next(Way way) const;
    /// The same, if it is of the same type, too.
    Way next_of_type(Way way) const;
    /// The way on that the eye takes: past the ends of other lines, and whatever the type is there;
    /// or kNone.
    Way next_for_the_eye(Way way) const;

    void set_type(Way way, LineType type) { segments_[way >> 1U].type = type; }
    /// Moves every vertex to its place and takes out segments that are marked or have no length.
    /// Vertices at one place become one; all are numbered anew.
    void reshape(std::span<const Vec2f> places, std::span<const std::uint8_t> marked);
    /// Where each vertex is.
    std::vector<Vec2f> places() const;

  private:
    void sort(float spacing);
    void split_at_ends_within(float spacing);
    void number_ends();
    /// Ways that leave a vertex.
    std::span<const Way> leaving(std::uint32_t vertex) const {
        return {leaving_.data() + first_leaving_[vertex],
                leaving_.data() + first_leaving_[vertex + 1]};
    }

    std::vector<Segment> segments_;
    std::vector<std::uint32_t> ends_;  ///< vertex at which each way starts
    std::vector<std::uint32_t> first_leaving_;
    std::vector<Way> leaving_;
};

}  // namespace ink
