#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
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
    /// `face_cells`, by upper left point: in which cells lines between faces are joined; empty: in
    /// all. Others that touch such a cell have crossings of these lines on some of their sides
    /// only.
    void connect(const SampleGrid& grid, std::span<const SuspectEdge> edges,
                 std::span<const Crossing> crossings, std::vector<Segment>& segments,
                 std::span<const std::uint8_t> face_cells = {});

  private:
    /// A crossing on the way round a cell, clockwise from its upper left corner.
    struct Port {
        float way;  ///< along the perimeter, in sides: [0, 4)
        const Crossing* crossing;
        GeometryId before, after;  ///< IDs on the way round
        std::uint32_t before_sample, after_sample;
        bool before_in_front;  ///< of the two sides
    };

    void count_members(const SampleGrid& grid, std::span<const SuspectEdge> edges,
                       std::span<const Crossing> crossings,
                       std::span<const std::uint8_t> face_cells);
    void connect_cell(const SampleGrid& grid, std::span<const Crossing> crossings, int i, int j,
                      std::vector<Segment>& segments);
    using Corners = std::array<std::uint32_t, 4>;
    static Port make_port(const Corners& corners, Vec2f corner, float per_spacing, int side,
                          const Crossing& crossing);
    static bool one_line(const Port& p, const Port& q);
    void join_ports(std::vector<Segment>& segments);
    bool join_best_pair(std::vector<Segment>& segments);
    void join_junction(std::vector<Segment>& segments);
    void end_last_on_others(std::vector<Segment>& segments);
    static void add_segment(const Port& from, const Port& to, std::vector<Segment>& segments);
    static Segment& add_segment(const Port& from, Vec2f to, std::vector<Segment>& segments);

    /// A crossing on a side of a cell: side << 30 | crossing.
    using Member = std::uint32_t;
    std::size_t stride_ = 0;            ///< cells of a row, and some more to make whole eights
    std::vector<std::uint8_t> counts_;  ///< of a cell's members: up to 2, or 3 for more
    std::vector<std::array<Member, 2>> members_;        ///< a cell's first two
    std::vector<std::pair<std::size_t, Member>> more_;  ///< the others, by cell
    std::vector<Member> cell_members_;
    std::vector<Port> ports_;
    std::size_t first_segment_ = 0;  ///< of the cell at hand
};

}  // namespace ink
