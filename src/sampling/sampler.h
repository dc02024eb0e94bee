#pragma once

#include <span>
#include <vector>

#include "accel/tracer.h"
#include "base/lanes.h"
#include "camera/camera.h"

namespace ink {

/// A block of pixels by its upper left one. Blocks are aligned to the whole picture, so that the
/// same rays travel together however the picture is cut into tiles.
struct Block {
    int x = 0, y = 0;
};

/// Traces sample rays for blocks of pixels. Each thread needs one of its own.
class Sampler {
  public:
    Sampler(const Tracer& tracer, const Camera& camera) : tracer_(tracer), camera_(camera) {}

    /// One packet a block: the rays through every pixel's centre plus `offset` (pixels). Normals of
    /// hits come back with unit length and facing the ray's origin.
    void trace_blocks(std::span<const Block> blocks, Vec2f offset, std::span<HitPacket> hits);

    /// The ray stencils of a block's samples at the pixel centres plus `offset`: one packet for each
    /// of the stencil's points. The pixels of a block share the point, which keeps the rays of a
    /// packet as coherent as those of the block itself. Normals likewise if `with_normals`, else as
    /// the tracer gives them.
    void trace_stencils(Block block, Vec2f offset, std::span<const Vec2f> stencil,
                        bool with_normals, std::span<HitPacket> hits);

    std::size_t rays() const { return rays_; }  ///< traced so far

  private:
    void trace(bool with_normals, std::span<HitPacket> hits);

    const Tracer& tracer_;
    const Camera& camera_;
    std::vector<RayPacket> packets_;
    std::size_t rays_ = 0;
};

}  // namespace ink
