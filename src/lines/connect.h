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

    /// A crossing on a side of a cell: side << 30 | crossing.
    using Member = std::uint32_t;
    /// Which edges of 64 points in a row have a crossing, and which have several.
    struct EdgeBits {
        std::uint64_t right, down, several_right, several_down;
    };

    void place(const SampleGrid& grid, std::span<const SuspectEdge> edges,
               std::span<const Crossing> crossings);
    bool connect_two(const SampleGrid& grid, std::span<const Crossing> crossings, int i, int j,
                     std::uint32_t sides, std::vector<Segment>& segments) const;
    void connect_cell(const SampleGrid& grid, std::span<const Crossing> crossings, int i, int j,
                      std::uint32_t sides, bool with_faces, std::vector<Segment>& segments);
    using Corners = std::array<std::uint32_t, 4>;
    static Corners corners_of(const SampleGrid& grid, int i, int j);
    static Port make_port(const Corners& corners, int side, const Crossing& crossing);
    static bool one_line(const Port& p, const Port& q);
    void join_ports(std::vector<Segment>& segments);
    bool join_best_pair(std::vector<Segment>& segments);
    void join_junction(std::vector<Segment>& segments);
    void end_last_on_others(std::vector<Segment>& segments);
    static void add_segment(const Port& from, const Port& to, std::vector<Segment>& segments);
    static Segment& add_segment(const Port& from, Vec2f to, std::vector<Segment>& segments);

    std::size_t words_ = 0;             ///< a row of points
    std::vector<EdgeBits> edge_bits_;   ///< row by row
    std::vector<std::uint32_t> first_;  ///< crossing of an edge, by 2 * point + (1 if down)
    std::vector<std::pair<std::size_t, std::uint32_t>> more_;  ///< the others, by edge
    std::vector<Member> cell_members_;
    std::vector<Port> ports_;
    std::size_t first_segment_ = 0;  ///< of the cell at hand
};

}  // namespace ink
