#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lines/connect.h"
#include "lines/detect.h"
#include "lines/locate.h"
#include "lines/segment.h"
#include "sampling/samples.h"

namespace ink {

/// The light and the shaded part of a geometry, as IDs of their own.
struct Tones {
    static GeometryId id(GeometryId geometry, bool shaded) {
        return geometry == kBackground ? kBackground : 2 * geometry + (shaded ? 1 : 0);
    }
    static GeometryId geometry(GeometryId id) { return id / 2; }
    static bool shaded(GeometryId id) { return id % 2 != 0; }
    /// Takes a segment's geometries for their light parts.
    static void double_ids(Segment& segment) {
        for (GeometryId* one : {&segment.left, &segment.right, &segment.left_at_b,
                                &segment.right_at_b, &segment.owner}) {
            *one = id(*one, false);
        }
    }
};

/// Divides geometries into light and shade along with the lines: the same segments again, whose
/// sides are tones, and between them the borders of tones, which are creases of strength 0. They
/// meet bit by bit as all segments do, so that regions of light and shade share their outlines with
/// each other and with the lines.
class ToneConnector {
  public:
    /// `brightness` is that of the grid's points: shade is below 1/2. Where it passes that between
    /// two points is found by linear interpolation, unless a line runs between them: then light
    /// ends there. Lines between faces of a mesh divide no tones and are left out.
    void connect(const SampleGrid& grid, std::span<const float> brightness,
                 std::span<const SuspectEdge> edges, std::span<const Crossing> crossings,
                 std::vector<Segment>& segments);

  private:
    void take_lines(const SampleGrid& grid, std::span<const float> brightness,
                    std::span<const Crossing> crossings);
    void add_borders(const SampleGrid& grid, std::span<const float> brightness);
    void add_border(const SampleGrid& grid, std::span<const float> brightness, int i, int j,
                    bool down);

    Connector connector_;
    std::vector<SuspectEdge> edges_;
    std::vector<Crossing> crossings_;
    std::vector<std::uint8_t> crossed_;  ///< a point: whether its edges have lines, by direction
};

}  // namespace ink
