#pragma once

#include <array>

#include "accel/screen_kernels.h"
#include "accel/screen_packets.h"
#include "accel/tracer.h"

namespace ink {

/// Inward unit normals of a triangle's sides on the screen, in the order of TriangleForm.
struct SideNormals {
    std::array<float, 4> x, y;  ///< the fourth is nothing
};

/// Of the triangles of a screen packet.
using PacketSides = std::array<SideNormals, kLanes>;

void find_sides(const ScreenPacket& packet, PacketSides& sides);

/// How far the front's points are from the nearest side of the triangles that they hit: since these
/// are convex, the nearest of the lines along its sides. Sides are those of each packet.
void measure(const Front& front, const ScreenPacket* packets, const PacketSides* sides,
             BorderPacket& borders);

/// The triangles that the front's points hit.
void find_sides(const Front& front, const ScreenPacket* packets, SidesPacket& sides);

}  // namespace ink
