#pragma once

#include <cstdint>
#include <span>

#include "accel/projection.h"
#include "base/bounds.h"
#include "base/lanes.h"
#include "scene/mesh.h"
#include "scene/spheres.h"

namespace ink {

// Screen positions here are relative to the projection's centre: q = p - centre, pixels. Depth is
// along the axis from the plane where rays start.

/// Screen bounds of sixteen things. Unused lanes are empty (left > right).
struct BoundsPacket {
    Lanes<float> left, right, top, bottom;
    Lanes<float> depth;  ///< nothing of it lies nearer

    static BoundsPacket none();
};

/// Sixteen spheres as a camera sees them. With d = q - (u, v), the sphere covers
/// h = f - (a dx^2 + b dx dy + c dy^2) > 0, and its depth is (m - sqrt(h)) / (1 + slope^2), where
/// m = z + slope . ((x, y) - origin) is the depth of the centre's foot on the ray.
struct SpherePacket {
    BoundsPacket bounds;
    Lanes<float> u, v;        ///< centre of its outline
    Lanes<float> a, b, c, f;  ///< of its outline
    Lanes<float> x, y, z;     ///< its centre, right, down and forward from the projection's start
};

/// Sixteen triangles as a camera sees them. Edge k is dx (q.y - y) - dy (q.x - x) >= 0 on the
/// inside. Every edge starts at that of its ends which comes first on the screen, so that the
/// triangles on its two sides compute the same number, up to its sign.
struct TrianglePacket {
    BoundsPacket bounds;
    struct Edge {
        Lanes<float> x, y, dx, dy;
    };
    Edge edges[3];
    /// depth = z + (gx (q.x - u) + gy (q.y - v)) / (w + wx q.x + wy q.y), within [depth, far]
    Lanes<float> u, v, z, gx, gy, w, wx, wy, far;
};

/// What a hit needs of its primitive. With p the hit less `origin`, the normal is p (sphere) or
/// `normal`, and the barycentric coordinates are p . u_axis and p . v_axis.
struct alignas(64) HitRecord {
    Vec3f origin;  ///< centre or first corner, scene frame
    Vec3f normal{};
    Vec3f u_axis{}, v_axis{};
    std::uint32_t object = 0, primitive = 0;
    bool is_sphere = false;
};

/// `primitives` has up to kLanes indices into the shape; `records` has kLanes entries, whose object
/// is left to the caller.
void prepare(const Projection& projection, const Spheres& shape,
             std::span<const std::uint32_t> primitives, SpherePacket& packet, HitRecord* records);
void prepare(const Projection& projection, const Mesh& shape,
             std::span<const std::uint32_t> primitives, TrianglePacket& packet, HitRecord* records);

/// Screen bounds of sixteen boxes.
void prepare(const Projection& projection, std::span<const Bounds3f> boxes, BoundsPacket& packet);

}  // namespace ink
