#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lines/ridges.h"
#include "lines/segment.h"
#include "render/pipeline.h"
#include "sampling/sampler.h"
#include "sampling/samples.h"

namespace ink {

/// Thresholds of the settings in radians a pixel.
RidgeSettings ridge_settings(const Settings& settings);

/// What a tile's lattice saw: its samples, and the hits and shading normals of its blocks.
struct LatticeView {
    const SampleGrid& grid;
    std::span<const Block> blocks;
    std::span<const HitPacket> hits;
    std::span<const NormalPacket> normals;
};

/// Finds the apparent ridges of one tile after another. They need the normals of a wide
/// neighbourhood, so what lies around the tile is traced beside what its lattice saw.
class RidgeSearch {
  public:
    /// `per_pixel` lattice points along a pixel's side.
    RidgeSearch(const Pipeline& pipeline, int per_pixel);

    void search(const LatticeView& lattice, std::vector<Segment>& segments);

    std::size_t rays() const { return sampler_.rays(); }

  private:
    void lay_grid(const SampleGrid& lattice);
    void copy(const LatticeView& lattice);
    void trace_around(const SampleGrid& lattice);
    void keep(const Block& block, std::size_t k);

    const Pipeline& pipeline_;
    int radius_;  ///< of a ridge's neighbourhood, lattice points
    int apron_;   ///< the same, up to whole blocks
    RidgePattern pattern_;
    std::vector<bool> balls_;  ///< objects without ridges: each ID is a ball
    bool has_balls_;
    Sampler sampler_;
    SampleGrid grid_;
    std::vector<Block> blocks_;
    std::vector<HitPacket> hits_;
};

}  // namespace ink
