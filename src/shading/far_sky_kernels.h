#pragma once

#include <cstdint>
#include <span>

#include "shading/far_sky.h"

namespace ink::far_kernels {

/// Raises a map, row by row, to the balls that cover the middles of its texels. Each texel has two
/// heights of 16 bits: that of the last ball to begin on the way to `towards`, and, above it, on
/// the way in the opposite direction. Five more rows may be
/// read.
void raise(const FarSky& sky, std::span<const BallPacket> balls, Vec3f towards,
           std::span<std::uint32_t> map);

/// What a ball sees of the maps of a group of directions; what begins farther than `reach` from its
/// centre is far.
void look_out(const FarSky& sky, std::size_t group, const Sphere& ball, float reach,
              FarWindow& window);

}  // namespace ink::far_kernels
