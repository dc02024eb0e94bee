#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "accel/tracer.h"
#include "lines/density.h"
#include "sampling/sampler.h"

namespace ink {

/// How long the lines between faces are in a block of 4 x 4 points, pixels, from how often two
/// neighbours see different ones: a line of any direction crosses lattice edges 4 / pi times a
/// spacing, on average.
float face_length(int changes, float spacing);

/// Adds the lines between faces, where they all have one width, to a density: block by block of a
/// tile, whose squares are looked up once.
class FaceDensity {
  public:
    FaceDensity(LineDensity& density, float spacing, float width);

    /// Points [x0, x0 + width) x [y0, y0 + height) of the lattice.
    void enter(int x0, int y0, int width, int height);
    /// One of their blocks.
    void add(const Block& block, const HitPacket& hits);

  private:
    static constexpr int kMostChanges = 24;  ///< edges between 4 x 4 points

    LineDensity& density_;
    float spacing_;
    std::array<LineDensity::Amount, kMostChanges + 1> amounts_{};  ///< by changes
    int x0_ = 0, y0_ = 0;
    std::vector<int> columns_, rows_;  ///< of the density's squares, by blocks
};

}  // namespace ink
