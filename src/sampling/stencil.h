#pragma once

#include <cstddef>
#include <vector>

#include "base/vec.h"

namespace ink {

/// The offsets of a ray stencil D_h^N about a sample, in pixels: N concentric rings, ring r of
/// radius h r / N with 8 r points from the +x axis on; M = 4 N (N + 1) in all, the sample itself
/// not counted. Choudhury and Parker 2009, section 3.1 and figure 4(a).
/// `radius` > 0 in pixels, `rings` >= 1.
std::vector<Vec2f> ring_stencil(float radius, int rings);

/// Where in a ring stencil the four rays of the outer ring along the axes are: the finite
/// differences of figure 4(a).
struct StencilAxes {
    std::size_t right, down, left, up;
};
StencilAxes stencil_axes(int rings);

/// Sub-pixel offsets from the pixel's centre for S samples a pixel, S >= 1: a regular grid where S
/// is a square (the paper's nine), else the R2 sequence (Roberts 2018), which is even for any S.
std::vector<Vec2f> multisample_offsets(int samples);

}  // namespace ink
