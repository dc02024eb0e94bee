#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "accel/projection.h"
#include "base/lanes.h"
#include "base/vec3_lanes.h"
#include "scene/scene.h"

namespace ink {

inline constexpr std::uint32_t kNoObject = 0xFFFFFFFFU;

/// Sixteen rays. All values must be finite, directions of unit length.
struct RayPacket {
    Lanes<float> origin_x, origin_y, origin_z;  ///< scene frame
    Lanes<float> dir_x, dir_y, dir_z;
    Lanes<std::int32_t> active = Lanes<std::int32_t>::filled(-1);  ///< -1: trace it; 0: leave it
};

/// What sixteen rays hit first. Inactive rays miss.
struct HitPacket {
    Lanes<float> t;  ///< distance along the ray, scene units; infinity on a miss
    Lanes<float> normal_x, normal_y, normal_z;  ///< geometric, outward, of any length
    Lanes<float> u, v;                          ///< triangle: barycentric, of corners 1 and 2
    Lanes<std::uint32_t> primitive;             ///< index within the object
    Lanes<std::uint32_t> object;                ///< index within the scene; kNoObject on a miss

    static HitPacket miss() {
        HitPacket hits{};
        hits.t.fill(kInfinity);
        hits.object.fill(kNoObject);
        return hits;
    }
};

/// Normals that sixteen points are shaded by, unit, facing the viewer; zero where nothing was hit.
using NormalPacket = Vec3Lanes;
/// Where sixteen rays hit something, scene frame; anywhere on a miss.
using PlacePacket = Vec3Lanes;

/// One of the places where a ray crosses a surface.
struct SurfaceHit {
    float t;       ///< distance along the ray, scene units
    Vec3f normal;  ///< geometric, outward, of any length
    float u, v;    ///< as in HitPacket
    std::uint32_t primitive, object;
};

/// All that the rays of a packet cross, ray by ray, in any order.
using SurfaceHits = std::array<std::vector<SurfaceHit>, kLanes>;

enum class Coherence : std::uint8_t {
    coherent,   ///< the rays of a packet start and go close together
    incoherent  ///< they need not
};

/// Sixteen points of the screen, pixels.
struct PointPacket {
    Lanes<float> x, y;
    Lanes<std::int32_t> active = Lanes<std::int32_t>::filled(-1);  ///< as in RayPacket
};

/// How far sixteen points are from the borders of the triangles that they hit.
struct BorderPacket {
    Lanes<float> distance;  ///< to the nearest side, pixels; infinite where no triangle was hit
    Lanes<float> nx, ny;    ///< unit, across that side
};

/// Two sides of a triangle from a point of the screen. Those of the third follow: what is inside
/// adds up to one, and steps to nothing.
struct TriangleSides {
    /// How far inside the point is, in shares of the triangle's height over that side: on the
    /// screen a barycentric coordinate.
    std::array<float, 2> inside;
    std::array<float, 2> dx, dy;  ///< by how much a pixel's step changes it

    /// No side is anywhere near.
    static TriangleSides none() { return {{1.0F / 3.0F, 1.0F / 3.0F}, {}, {}}; }
};

/// Of the triangles that sixteen points see; where they see none, of none.
using SidesPacket = std::array<TriangleSides, kLanes>;

struct ScreenBox {
    float left, top, right, bottom;  ///< pixels
};

/// Packets of 4 x 4 points of a lattice that are the cells of a raster on the screen.
struct BlockRaster {
    static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

    int x = 0, y = 0;           ///< the first cell's first point, which is number x of its row
    int columns = 0, rows = 0;  ///< of points that are active
    float spacing = 1.0F;       ///< point x of a row is at (x + 1/2) spacing + offset, pixels
    Vec2f offset;
    std::span<const std::uint32_t> packet_at;  ///< a cell, row by row: its packet, or kNone
    std::size_t packets = 0;                   ///< so many, which come first, lie on the raster

    /// Cells.
    int across() const { return (columns + kBlockSide - 1) / kBlockSide; }
    int down() const { return (rows + kBlockSide - 1) / kBlockSide; }
    /// Of the first cell, pixels; points keep off the edges of their cell.
    float left() const { return static_cast<float>(x) * spacing + offset.x; }
    float top() const { return static_cast<float>(y) * spacing + offset.y; }
    float side() const { return kBlockSide * spacing; }
};

/// Traces camera rays of one picture, one thread's share of them.
class TileTracer {
  public:
    virtual ~TileTracer() = default;

    /// What follows lies within `area`, until the next call. All points must.
    virtual void enter(const ScreenBox& area) = 0;

    /// Traces `rays[k]`, which run through `points[k]`, into `hits[k]`; the spans have equal
    /// length.
    virtual void intersect(std::span<const PointPacket> points, std::span<const RayPacket> rays,
                           std::span<HitPacket> hits) = 0;

    /// The same in two steps for packets that lie on a raster, and any others that follow: `find`
    /// looks for all hits, `resolve` tells those of packets `first` and on, of which it is given
    /// the points and rays. So hits can be made use of a few at a time, while they are in the
    /// cache. After `want_shades`, points of packets on the raster need not be filled in.
    virtual void find(const BlockRaster& /*raster*/, std::span<const PointPacket> /*points*/) {}
    virtual void resolve(std::size_t /*first*/, std::span<const PointPacket> points,
                         std::span<const RayPacket> rays, std::span<HitPacket> hits) {
        intersect(points, rays, hits);
    }

    /// After `find`: how far the points of packets `first` and on are from the borders of the
    /// triangles that they hit. Only if the frame `measures_borders`, and after `want_borders`.
    virtual void want_borders() {}
    virtual void measure(std::size_t /*first*/, std::span<BorderPacket> /*borders*/) {}
    /// Likewise, but without `want_borders`: the triangles that they hit. False if it cannot tell.
    virtual bool find_sides(std::size_t /*first*/, std::span<SidesPacket> /*sides*/) {
        return false;
    }

    /// After `find`, of packets `first` and on, without rays: the hits but for barycentric
    /// coordinates, with normals that are unit and face the viewer; the normals to shade them by,
    /// interpolated where a mesh has normals at its corners; and where they lie, unless `places`
    /// is empty, in which case t of triangles is left out, too. Only if the frame
    /// `sees_without_rays`, and after `want_shades`.
    virtual void want_shades() {}
    /// Takes both wishes back.
    virtual void want_points_only() {}
    virtual void see(std::size_t /*first*/, std::span<HitPacket> /*hits*/,
                     std::span<NormalPacket> /*normals*/, std::span<PlacePacket> /*places*/) {}

    /// Finds t, object and primitive of the hits and no more. Rays may be left out unless
    /// `needs_rays`.
    virtual void identify(std::span<const PointPacket> points, std::span<const RayPacket> rays,
                          std::span<HitPacket> hits) {
        intersect(points, rays, hits);
    }
    virtual bool needs_rays() const { return true; }

    /// Whether hits do not depend on which rays share a packet.
    virtual bool rays_travel_alone() const { return false; }

    /// False only if no ray through a point of the box, which lies within the area, hits anything.
    virtual bool reaches(const ScreenBox& /*box*/) const { return true; }
    /// The same of up to 64 boxes, the first one and others to its right, `step` pixels from each
    /// to the next: a bit each, the lowest for the first.
    virtual std::uint64_t reached(const ScreenBox& first, float step, int count) const {
        std::uint64_t bits = 0;
        for (int k = 0; k < count; ++k) {
            const float right = static_cast<float>(k) * step;
            const ScreenBox box{first.left + right, first.top, first.right + right, first.bottom};
            bits |= std::uint64_t{reaches(box)} << static_cast<unsigned>(k);
        }
        return bits;
    }

    /// True only if every ray through a point of the box, which lies within the area, hits that
    /// primitive first.
    virtual bool covers(std::uint32_t /*object*/, std::uint32_t /*primitive*/,
                        const ScreenBox& /*box*/) {
        return false;
    }
};

/// The scene seen through one camera. Safe to use from many threads.
class FrameTracer {
  public:
    virtual ~FrameTracer() = default;
    virtual std::unique_ptr<TileTracer> tile_tracer() const = 0;
    /// False only if no ray through a point of the box hits anything; true where that would take
    /// long to find out.
    virtual bool may_see(const ScreenBox& /*box*/) const { return true; }
    /// Whether its tile tracers can tell how far points are from the borders of triangles.
    virtual bool measures_borders() const { return false; }
    /// Whether they can tell hits and the normals to shade them by without rays: where there is
    /// nothing but triangles, or none.
    virtual bool sees_without_rays() const { return false; }
};

/// Finds the first surface along rays. Safe to use from many threads.
class Tracer {
  public:
    virtual ~Tracer() = default;

    /// Traces `rays[k]` into `hits[k]`; the spans have equal length.
    virtual void intersect(std::span<const RayPacket> rays, std::span<HitPacket> hits,
                           Coherence coherence) const = 0;

    /// Finds every surface along the rays, not only the first. Unless a tracer does better, by
    /// going on from behind each hit, which loses surfaces that touch.
    virtual void cross(const RayPacket& rays, SurfaceHits& hits) const;

    /// Whether anything lies on `rays[k]` nearer than `reach[k]` (scene units, may be infinite):
    /// `blocked[k]` is -1 where it does, else 0. Inactive rays are not blocked. The spans have
    /// equal length.
    virtual void occluded(std::span<const RayPacket> rays, std::span<const Lanes<float>> reach,
                          std::span<Lanes<std::int32_t>> blocked) const = 0;

    /// Prepares a picture on up to `threads` threads. The frame must not outlive the tracer. What
    /// tells it from `intersect` is speed alone.
    virtual std::unique_ptr<FrameTracer> frame(const Projection& projection, int threads) const;
};

/// How many rays the kernel is handed at once. `widest` picks what the machine runs natively.
enum class PacketWidth : std::uint8_t { widest = 0, four = 4, eight = 8, sixteen = 16 };

using ObjectFilter = std::function<bool(const Object&)>;

/// Embree's bounding volume hierarchy over the scene, or those of its objects that are wanted. The
/// scene must outlive the tracer and keep its arrays in place: they are shared, not copied. Throws
/// Error when memory runs out.
std::unique_ptr<Tracer> make_embree_tracer(const Scene& scene,
                                           PacketWidth width = PacketWidth::widest,
                                           const ObjectFilter& wanted = {});

/// Camera rays by what the screen shows of the scene (accel/screen_tracer.h), where shapes have a
/// form for that, the rest by Embree, whose hierarchy is built when it is first needed. The scene
/// must outlive the tracer.
std::unique_ptr<Tracer> make_tracer(const Scene& scene);

/// Tests every ray against every primitive in double precision: the oracle for the other tracers.
std::unique_ptr<Tracer> make_brute_force_tracer(const Scene& scene);

}  // namespace ink
