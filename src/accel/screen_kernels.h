#pragma once

#include <cstdint>

#include "accel/screen_packets.h"
#include "accel/tracer.h"

namespace ink {

/// A part of the screen and of the depth before it.
struct Window {
    float left, right, top, bottom;
    float farthest;
};

/// The nearest hits so far of the rays through sixteen points.
struct Front {
    Lanes<float> x, y;            ///< the points, q
    Lanes<float> foreshortening;  ///< 1 / (1 + slope^2) of their rays
    Lanes<float> depth;           ///< infinity: no hit; minus infinity: inactive
    Lanes<std::uint32_t> winner;  ///< what was given with the primitive that was hit
    Window window;                ///< bounds of the active points, largest depth of the hits

    /// Starts with no hits.
    void start(const Projection& projection, const PointPacket& points);
};

/// Bit i is set for lane i of sixteen.
using LaneBits = std::uint32_t;

/// Which of sixteen bounds lie partly in the window.
LaneBits overlap(const BoundsPacket& bounds, const Window& window);

/// Tests the front's rays against those primitives of a packet that lie in its window. Lane i wins
/// as `first + i`.
void intersect(const Projection& projection, const SpherePacket& packet, std::uint32_t first,
               Front& front);
void intersect(const Projection& projection, const TrianglePacket& packet, std::uint32_t first,
               Front& front);

/// The front as hits; `records` is indexed by winners.
void resolve(const Front& front, const RayPacket& rays, const HitRecord* records, HitPacket& hits);
/// The same without normals and barycentric coordinates, which are left as they are.
void identify(const Front& front, const HitRecord* records, HitPacket& hits);

}  // namespace ink
