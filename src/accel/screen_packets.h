#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "accel/clusters.h"
#include "accel/projection.h"
#include "base/lanes.h"

namespace ink {

// Screen positions here are relative to the projection's centre: q = p - centre, pixels. Depth is
// along the axis from the plane where rays start.

/// A part of the screen and of the depth before it.
struct Window {
    float left, right, top, bottom;
    float farthest;
};

/// Screen bounds of sixteen things. Unused lanes are empty (left > right).
struct BoundsPacket {
    Lanes<float> left, right, top, bottom;
    Lanes<float> depth;  ///< nothing of it lies nearer

    static BoundsPacket none();
    /// One of them to a place in another packet.
    void copy(int lane, BoundsPacket& to, int to_lane) const {
        to.left[to_lane] = left[lane];
        to.right[to_lane] = right[lane];
        to.top[to_lane] = top[lane];
        to.bottom[to_lane] = bottom[lane];
        to.depth[to_lane] = depth[lane];
    }
};

/// A sphere as a camera sees it. With d = q - (u, v), it covers h = f - (a dx^2 + b dx dy + c dy^2)
/// > 0, and its depth is (m - sqrt(h)) / (1 + slope^2), where m = z + slope . ((x, y) - origin) is
/// the depth of the centre's foot on the ray.
struct SphereForm {
    float u, v;        ///< centre of its outline
    float a, b, c, f;  ///< of its outline
    float x, y, z;     ///< its centre, right, down and forward from the projection's start
};

/// A triangle as a camera sees it. With e_k = dx_k (q.y - y_k) - dy_k (q.x - x_k), its three edges
/// are e_k >= 0 on the inside. Every edge starts at that of its ends which comes first on the
/// screen, so that the triangles on its two sides compute the same number, up to its sign. Its
/// depth is z + e_3 / (w + wx q.x + wy q.y), within [near, far].
struct TriangleForm {
    std::array<float, 4> x, y, dx, dy;
    float z, w, wx, wy, near, far;
};

/// A glyph as a camera sees it: in the coordinates of its unit shape, with d = q - (u, v), the ray
/// through q is p + s (ahead + turn p), where p = right d.x + down d.y lies on the plane through
/// the glyph's middle that faces the camera, and s is the depth beyond that plane, at z.
struct GlyphForm {
    float u, v, z;
    std::array<float, 3> right, down, ahead;
    float turn;
};

/// The numbers of SphereForm, TriangleForm or GlyphForm in order, and room to move them by fours.
/// Each form lies in a place of its own: few of a cluster's primitives are asked for at a time.
using FormNumbers = std::array<float, 24>;
static_assert(sizeof(TriangleForm) <= sizeof(FormNumbers));

/// What a hit needs of its primitive; see ScreenPacket.
using HitNumbers = std::array<float, 12>;

/// The primitives of a cluster as a camera sees them.
struct ScreenPacket {
    ScreenPacket() {}  // NOLINT: clearing numbers that are all written anyway takes time

    BoundsPacket bounds;
    std::array<FormNumbers, kLanes> forms;
    /// What a hit needs of its primitive. Of a sphere its centre. Of a triangle its first corner,
    /// normal, u and v axes: with p the hit less the corner, the barycentric coordinates are u . p
    /// and v . p. Of a glyph the rows of the inverse of its placement's map.
    /// What is told by shades needs none of it, so that those of triangles may be left out.
    std::array<HitNumbers, kLanes> hit;
    bool has_hit_numbers = true;
    Lanes<std::uint32_t> primitive;
    std::uint32_t object = 0;
    ClusterKind kind = ClusterKind::spheres;
    UnitShape shape{};  ///< of glyphs
};

/// What shading needs of a triangle, on one cache line. Its normal at q is n + right (q.x - u) +
/// down (q.y - v), up to its length: what is linear on a surface seen in perspective is linear on
/// the screen once it is divided by depth, which leaves the direction. Zero if it is flat.
struct ShadeNumbers {
    static constexpr std::size_t kNormal = 0, kRight = 3, kDown = 6, kU = 9, kV = 10;
    static constexpr std::size_t kFacet = 11;  ///< geometric normal, unit, facing the viewer
    static constexpr std::size_t kPrimitive = 14, kObject = 15;  ///< their bits
    static constexpr std::size_t kCount = 16;
};

/// Those of a packet of triangles.
struct PacketShades {
    PacketShades() {}  // NOLINT: as ScreenPacket
    alignas(64) std::array<std::array<float, ShadeNumbers::kCount>, kLanes> numbers;
};

/// The corners of sixteen triangles on the screen, and twice their areas: negative where the
/// corners run round anticlockwise, as those of triangles that face the viewer do.
struct ScreenCorners {
    struct Corner {
        Lanes<float> u, v, depth;
    };
    Corner a, b, c;
    Lanes<float> area;
};

/// A projection's numbers by value, so that nothing that a loop writes can change them.
struct Basis {
    double rx, ry, rz, dx, dy, dz, fx, fy, fz;  ///< right, down, forward
    double sx, sy, sz;                          ///< start
    double start_depth, origin_step, slope_step;
    bool orthographic;

    explicit Basis(const Projection& projection);
};

/// The primitives of a packet whose object, kind and shape are set: bounds, forms and what hits
/// need.
void prepare(const Basis& basis, const SphereLanes& spheres, ScreenPacket& packet);
/// Of triangles, what hits need comes after.
void prepare(const Basis& basis, const TriangleLanes& triangles, ScreenPacket& packet,
             ScreenCorners& corners);
void record_hits(const TriangleLanes& triangles, ScreenPacket& packet);
void prepare(const Basis& basis, const SolidLanes& faces, ScreenPacket& packet);
void prepare(const Basis& basis, const GlyphLanes& glyphs, ScreenPacket& packet);

/// What shading needs of triangles. `normals`: null if the mesh is flat.
void prepare_shades(const Basis& basis, const TriangleLanes& triangles,
                    const ScreenCorners& corners, const CornerNormals* normals,
                    const ScreenPacket& packet, PacketShades& shades);

/// What the camera sees of a cluster; `shades`: null, or what is to be told if it is of triangles,
/// of which hits' numbers are then left out.
void prepare(const Basis& basis, const Clusters& clusters, const Cluster& cluster,
             ScreenPacket& packet, PacketShades* shades = nullptr);

/// Asks the cache for what `prepare` will read of a cluster, with `shades` or without.
void prefetch(const Clusters& clusters, std::uint32_t cluster, bool shades);

/// Screen bounds of the first `used` of sixteen boxes.
void prepare(const Basis& basis, const BoxLanes& boxes, std::size_t used, BoundsPacket& packet);

}  // namespace ink
