#pragma once

#include <cstdint>
#include <span>

#include "accel/screen_packets.h"
#include "accel/tracer.h"

namespace ink {

/// The nearest hits so far of the rays through sixteen points.
struct Front {
    Lanes<float> x, y;            ///< the points, q
    Lanes<float> foreshortening;  ///< 1 / (1 + slope^2) of their rays
    Lanes<float> depth;           ///< infinity: no hit; minus infinity: inactive
    Lanes<std::uint32_t> winner;  ///< what was hit: packet * kLanes + lane
    Window window;                ///< bounds of the active points, largest depth of the hits

    /// Starts with no hits.
    void start(const Projection& projection, const PointPacket& points);
};

/// Starts the fronts of a raster's packets, whose windows are not needed; nor is their
/// foreshortening, which takes a division, if they are `flat`: of triangles that will be seen (see
/// `see`).
void start_cells(const Projection& projection, const BlockRaster& raster, bool flat, Front* fronts);

/// Fronts in the cells of a raster, row by row. Four by four cells are asked together whether a
/// primitive matters to them; such a window may begin at any cell, so rows of cells end in kBeyond
/// cells without fronts, and as many such rows follow the last one.
struct FrontRaster {
    static constexpr int kBeyond = kBlockSide - 1;

    float left, top;                ///< of the first cell's points, q
    float side;                     ///< from one cell to the next
    float extent;                   ///< of a cell's points, along its side
    int across, down;               ///< cells
    const std::uint32_t* front_at;  ///< a cell: its front
    float* farthest;  ///< a cell: its farthest depth; minus infinity where there is no front
    Front* fronts;
    std::uint8_t* dirty;  ///< a cell: 1 while its farthest depth is out of date

    /// What the cells of a window are from its first one: right, down and in these arrays.
    struct WindowCells {
        Lanes<float> right, down;
        Lanes<std::uint32_t> offset;
    };
    WindowCells window;

    void lay_window();
    int stride() const { return across + kBeyond; }
    int cells() const { return stride() * (down + kBeyond); }
};

/// Which of sixteen bounds lie partly in the window.
LaneBits overlap(const BoundsPacket& bounds, const Window& window);
/// Bounds of all sixteen.
void set_union(const BoundsPacket& of, BoundsPacket& packet, int lane);

// Where two surfaces coincide, rounding would choose between them anew at every point. So of
// surfaces within kCoincident of each other the one of the lower object, then of the lower
// primitive, counts as the nearer one.

/// Scene units, in a scene of size 1: more than the depths of flat surfaces are rounded by.
inline constexpr float kCoincident = 5e-7F;

/// Tests the front's rays against those primitives of packet `index` that may lie before what they
/// see. `points`: those that the packet's bounds reach, see below.
void intersect(const Basis& basis, const ScreenPacket* packets, std::uint32_t index,
               LaneBits points, Front& front);

/// The same for all fronts of a raster.
void intersect(const Basis& basis, const ScreenPacket* packets, std::uint32_t index,
               const FrontRaster& raster);

/// Largest of the cells' farthest depths.
float farthest_of(const FrontRaster& raster);
/// Which points of a front bounds hold, before what these see.
LaneBits reached(const BoundsPacket& bounds, int lane, const Front& front);
/// Whether they reach into a cell, before all that it sees.
bool matters(const BoundsPacket& bounds, int lane, const FrontRaster& raster);

/// The front as hits.
void resolve(const Front& front, const RayPacket& rays, const ScreenPacket* packets,
             HitPacket& hits);
/// Fronts whose hits are all triangles, see TileTracer::see; as many hits and normals, and places
/// unless these are null.
void see(const Basis& basis, std::span<const Front> fronts, const PacketShades* shades,
         HitPacket* hits, NormalPacket* normals, PlacePacket* places);
/// The same of fronts whose hits are anything else, of which t is told in any case.
void see(const Basis& basis, std::span<const Front> fronts, const ScreenPacket* packets,
         HitPacket* hits, NormalPacket* normals, PlacePacket* places);
/// The front as hits without normals and barycentric coordinates, which are left as they are.
void identify(const Front& front, const ScreenPacket* packets, HitPacket& hits);

}  // namespace ink
