#pragma once

#include <cstddef>
#include <vector>

#include "lines/ridges.h"
#include "lines/segment.h"
#include "render/pipeline.h"
#include "render/tiles.h"
#include "sampling/sampler.h"
#include "sampling/samples.h"

namespace ink {

/// Thresholds of the settings in radians a pixel.
RidgeSettings ridge_settings(const Settings& settings);

/// Finds the apparent ridges of one tile after another, on a lattice of its own: ridges need the
/// normals of a wide neighbourhood, which the lattice of other lines does not have at a tile's rim.
class RidgeSearch {
  public:
    /// `per_pixel` lattice points along a pixel's side.
    RidgeSearch(const Pipeline& pipeline, int per_pixel);

    void search(const Tile& tile, std::vector<Segment>& segments);

    std::size_t rays() const { return sampler_.rays(); }

  private:
    void trace(const Tile& tile);
    void keep(const Block& block, std::size_t k);

    const Pipeline& pipeline_;
    int per_pixel_;
    int radius_;  ///< of a ridge's neighbourhood, lattice points
    int apron_;   ///< the same, up to whole blocks
    RidgePattern pattern_;
    std::vector<bool> balls_;  ///< objects without ridges: each ID is a ball
    Sampler sampler_;
    SampleGrid grid_;
    std::vector<Block> blocks_;
    std::vector<HitPacket> hits_;
};

}  // namespace ink
