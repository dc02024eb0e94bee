#pragma once

#include <cstdint>

#include "shading/ball_sky.h"

namespace ink::ball_kernels {

/// Which balls of a packet come nearer than `reach` to a point.
LaneBits within(const BallPacket& balls, Vec3f point, float reach);

/// The sky above a ball; what begins farther than `reach` from its centre is far.
struct SkyView {
    const SkyDirections& directions;
    const FarSky& far;
    const Sphere& ball;
    float reach;
};

/// BallSky::openness.
float openness(const SkyView& view, Surroundings& surroundings, Vec3f point, Vec3f n);

/// BallSky::contact_openness.
float contact_openness(const BallPacket& contacts, float radius, Vec3f n);
void contact_openness(const BallPacket& contacts, float radius, const NormalPacket& normals,
                      Lanes<float>& open);

}  // namespace ink::ball_kernels
