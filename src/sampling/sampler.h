#pragma once

#include <memory>
#include <span>
#include <vector>

#include "accel/tracer.h"
#include "base/lanes.h"
#include "camera/camera.h"

namespace ink {

/// A block of 4 x 4 lattice points (pixels, where there is one point a pixel) by its upper left
/// one. Blocks are aligned to the whole picture, so that the same rays travel together however the
/// picture is cut into tiles. Where that makes no difference (`rays_travel_alone`), a block may
/// also be a strip: sixteen points of a row or of a column.
struct Block {
    int x = 0, y = 0;
    int columns = kBlockSide, rows = kBlockSide;  ///< of it that are wanted
    int across = kBlockSide;                      ///< lanes a row: 4, or 16 or 1 of a strip
    bool whole = false;                           ///< what is not wanted is traced all the same

    int column(int lane) const { return lane % across; }
    int row(int lane) const { return lane / across; }
    bool is_strip() const { return across != kBlockSide; }
};

/// Traces sample rays for blocks of a lattice of `per_pixel` points along a pixel's side, point i
/// at (i + 1/2) / per_pixel. Each thread needs one of its own.
class Sampler {
  public:
    Sampler(const FrameTracer& frame, const Camera& camera, int per_pixel = 1)
        : tracer_(frame.tile_tracer()),
          sees_without_rays_(frame.sees_without_rays()),
          camera_(camera),
          spacing_(1.0F / static_cast<float>(per_pixel)) {}

    /// The part of the screen that the next calls are about. Needless, but it saves time to name
    /// it once instead of letting every call find out.
    void enter(const ScreenBox& area);
    /// Within that part: false only if no ray through a point of the box hits anything.
    bool reaches(const ScreenBox& box) const;
    /// The same of a row of boxes, see TileTracer::reached.
    std::uint64_t reached(const ScreenBox& first, float step, int count) const {
        return tracer_->reached(first, step, count);
    }
    /// Whether hits do not depend on which rays travel together.
    bool rays_travel_alone() const { return tracer_->rays_travel_alone(); }

    /// One packet a block: the rays through every point plus `offset` (pixels). Normals of hits
    /// come back with unit length and facing the ray's origin.
    void trace_blocks(std::span<const Block> blocks, Vec2f offset, std::span<HitPacket> hits);

    /// The same in two steps, strips last: `find_blocks` looks for the hits, `take_hits` makes the
    /// rays and hits of blocks `first` and on, as many as `hits` has room for. So all that is done
    /// with a few blocks finds them in the nearest cache.
    void find_blocks(std::span<const Block> blocks, Vec2f offset);
    void take_hits(std::size_t first, std::span<HitPacket> hits);
    /// Likewise without rays, see TileTracer::see. From `want_shades` on, which is false if the
    /// frame cannot tell.
    bool want_shades();
    void take_shades(std::size_t first, std::span<HitPacket> hits, std::span<NormalPacket> normals,
                     std::span<PlacePacket> places = {});
    /// Likewise, from `want_borders` on, how far their points are from the borders of the triangles
    /// that they hit; those of strips are left out. Only if the frame can tell.
    void want_borders();
    void take_borders(std::size_t first, std::span<BorderPacket> borders);
    /// Likewise, the triangles that they hit, without being wanted before. False if it cannot tell.
    bool take_sides(std::size_t first, std::span<SidesPacket> sides);

    /// Takes both wishes back: from now on, points alone are asked for.
    void want_points_only();

    /// The ray stencils of a block's samples at the lattice points plus `offset`: one packet for
    /// each of the stencil's points. The pixels of a block share the point, which keeps the rays of
    /// a packet as coherent as those of the block itself.
    void trace_stencils(Block block, Vec2f offset, std::span<const Vec2f> stencil,
                        std::span<HitPacket> hits);

    /// The same, of which t, object and primitive are found only; `complete` adds the rest to the
    /// hits of packet k.
    void identify_stencils(Block block, Vec2f offset, std::span<const Vec2f> stencil,
                           std::span<HitPacket> hits);
    void complete(std::size_t k, HitPacket& hits);
    /// True only if all stencil rays of the block's samples hit that primitive.
    bool covers(std::uint32_t object, std::uint32_t primitive, Block block, Vec2f offset,
                std::span<const Vec2f> stencil);

    /// Rays through any points of the screen (pixels), sixteen a packet; the last packet is filled
    /// up with inactive ones. Points that are close together travel together: lane n, counted over
    /// all packets, is point order()[n]. Normals as in trace_blocks.
    void trace_points(std::span<const Vec2f> points, std::vector<HitPacket>& hits);
    /// The same, of which t, object and primitive are found only.
    void identify_points(std::span<const Vec2f> points, std::vector<HitPacket>& hits);
    std::span<const std::uint32_t> order() const { return order_; }

    /// The rays of the last call, packet by packet; not after those that identify.
    std::span<const RayPacket> packets() const { return {packets_.data(), placed_}; }
    /// The points of the last call, packet by packet; after `want_shades` not those of blocks.
    std::span<const PointPacket> points() const { return {points_.data(), placed_}; }

    std::size_t rays() const { return rays_; }  ///< traced so far

  private:
    void place_stencils(Block block, Vec2f offset, std::span<const Vec2f> stencil);
    void lay_cells(std::span<const Block> blocks, BlockRaster& raster);
    void place_points(std::span<const Vec2f> points);
    void trace(std::span<HitPacket> hits);
    void identify(std::span<HitPacket> hits);
    std::span<PointPacket> place(std::size_t packets);
    void make_room();
    bool entered(const ScreenBox& box) const;
    void sort_by_place(std::span<const Vec2f> points, const ScreenBox& box);

    std::unique_ptr<TileTracer> tracer_;
    bool sees_without_rays_;
    const Camera& camera_;
    float spacing_;
    ScreenBox area_{kInfinity, kInfinity, -kInfinity, -kInfinity};
    std::vector<PointPacket> points_;  ///< those of the last call, and room for more
    std::size_t placed_ = 0;           ///< in the last call
    std::vector<RayPacket> packets_;   ///< likewise
    bool wants_borders_ = false;
    bool wants_shades_ = false;
    bool found_ = false;                ///< by find_blocks: hits need only be taken
    std::vector<std::uint32_t> cells_;  ///< of a raster of blocks
    std::vector<std::uint32_t> order_;
    std::vector<std::uint32_t> places_, starts_;  ///< of sort_by_place
    std::size_t rays_ = 0;
};

}  // namespace ink
