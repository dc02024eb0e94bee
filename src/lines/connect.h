#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lines/detect.h"
#include "lines/locate.h"
#include "lines/segment.h"
#include "sampling/samples.h"

namespace ink {

/// `nearer` of a crossing that is in front of nothing: it ends on any line that it meets.
inline constexpr GeometryId kNobody = 0xFFFFFFFFU;

/// Joins the crossings on the sides of each lattice cell into segments. Two crossings make one
/// segment. Where more meet, lines that bound one geometry on both ends go through; a line behind
/// ends on the one in front, and lines that meet as equals end at a junction in the middle.
class Connector {
  public:
    void connect(const SampleGrid& grid, std::span<const SuspectEdge> edges,
                 std::span<const Crossing> crossings, std::vector<Segment>& segments);

  private:
    /// A crossing on the way round a cell, clockwise from its upper left corner.
    struct Port {
        float way;  ///< along the perimeter, in sides: [0, 4)
        const Crossing* crossing;
        GeometryId before, after;  ///< IDs on the way round
        std::uint32_t before_sample, after_sample;
        bool before_in_front;  ///< of the two sides
    };

    void add_port(const SampleGrid& grid, int i, int j, int side, const SuspectEdge& edge,
                  const Crossing& crossing);
    void join_ports(std::vector<Segment>& segments);
    bool join_best_pair(std::vector<Segment>& segments);
    void join_junction(std::vector<Segment>& segments);
    void end_last_on_others(std::vector<Segment>& segments);
    static Segment make_segment(const Port& from, const Port& to);
    static Segment make_segment(const Port& from, Vec2f to);

    std::vector<std::uint64_t> members_;  ///< cell << 32 | side << 30 | crossing, to be sorted
    std::vector<Port> ports_;
    std::size_t first_segment_ = 0;  ///< of the cell at hand
};

}  // namespace ink
