#pragma once

#include <cstdint>
#include <span>

#include "shading/ball_sky.h"

namespace ink::ball_kernels {

/// Bit i is set for lane i of sixteen.
using LaneBits = std::uint32_t;

/// Which balls of a packet come nearer than `reach` to a point.
LaneBits within(const BallPacket& balls, Vec3f point, float reach);

/// Raises maps of FarSky, in steps of height, to the balls that cover the middles of their texels:
/// `front` as seen from `towards`, `back` from the opposite direction.
void raise(const FarSky& sky, std::span<const Sphere> balls, Vec3f towards, std::span<float> front,
           std::span<float> back);

/// BallSky::openness; what begins farther than `reach` from the ball's centre is far.
float openness(const SkyDirections& directions, const FarSky& far, const Surroundings& surroundings,
               const Sphere& ball, float reach, Vec3f n);

/// BallSky::contact_openness.
float contact_openness(const BallPacket& contacts, float radius, Vec3f n);

}  // namespace ink::ball_kernels
