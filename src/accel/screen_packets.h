#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "accel/clusters.h"
#include "accel/projection.h"
#include "base/bounds.h"
#include "base/lanes.h"

namespace ink {

// Screen positions here are relative to the projection's centre: q = p - centre, pixels. Depth is
// along the axis from the plane where rays start.

/// Screen bounds of sixteen things. Unused lanes are empty (left > right).
struct BoundsPacket {
    Lanes<float> left, right, top, bottom;
    Lanes<float> depth;  ///< nothing of it lies nearer

    static BoundsPacket none();
};

/// A sphere as a camera sees it. With d = q - (u, v), it covers h = f - (a dx^2 + b dx dy + c dy^2)
/// > 0, and its depth is (m - sqrt(h)) / (1 + slope^2), where m = z + slope . ((x, y) - origin) is
/// the depth of the centre's foot on the ray.
struct SphereForm {
    float u, v;        ///< centre of its outline
    float a, b, c, f;  ///< of its outline
    float x, y, z;     ///< its centre, right, down and forward from the projection's start
};

/// A triangle as a camera sees it. Edge k is dx (q.y - y) - dy (q.x - x) >= 0 on the inside. Every
/// edge starts at that of its ends which comes first on the screen, so that the triangles on its
/// two sides compute the same number, up to its sign.
struct TriangleForm {
    struct Edge {
        float x, y, dx, dy;
    };
    std::array<Edge, 3> edges;
    /// depth = z + (gx (q.x - u) + gy (q.y - v)) / (w + wx q.x + wy q.y), within [near, far]
    float u, v, z, gx, gy, w, wx, wy, near, far;
};

/// Sixteen of them. Bounds are asked for all lanes at once, forms one by one.
template <class Form>
struct FormPacket {
    BoundsPacket bounds;
    std::array<Form, kLanes> forms;
};
using SpherePacket = FormPacket<SphereForm>;
using TrianglePacket = FormPacket<TriangleForm>;

/// What a hit needs of its primitive. With p the hit less `origin`, the normal is p (sphere) or
/// `normal`, and the barycentric coordinates are p . u_axis and p . v_axis.
struct alignas(64) HitRecord {
    Vec3f origin;  ///< centre or first corner, scene frame
    Vec3f normal{};
    Vec3f u_axis{}, v_axis{};
    std::uint32_t object = 0, primitive = 0;
    bool is_sphere = false;
};

/// `primitives` has an entry for each lane that is used, up to kLanes; `records` has kLanes.
void prepare(const Projection& projection, const SphereLanes& spheres, std::uint32_t object,
             std::span<const std::uint32_t> primitives, SpherePacket& packet, HitRecord* records);
void prepare(const Projection& projection, const TriangleLanes& triangles, std::uint32_t object,
             std::span<const std::uint32_t> primitives, TrianglePacket& packet, HitRecord* records);

/// Screen bounds of sixteen boxes.
void prepare(const Projection& projection, std::span<const Bounds3f> boxes, BoundsPacket& packet);

}  // namespace ink
