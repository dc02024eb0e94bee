#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/lanes.h"
#include "scene/spheres.h"
#include "shading/sky_directions.h"

namespace ink {

/// How far balls reach in every direction of the sky: for each direction, a map of the scene as
/// seen from there, with the height of what comes first.
struct FarSky {
    static constexpr int kSide = 256;  ///< texels

    /// `radius`: of a ball about the origin that holds all the others. Uses all threads that
    /// parallel_ranges does.
    FarSky(std::span<const Sphere> balls, float radius, const SkyDirections& directions);

    /// Where the maps of a group's directions lie: texel = middle + texels * (p . right, p . up).
    struct Frame {
        Lanes<float> right_x, right_y, right_z;
        Lanes<float> up_x, up_y, up_z;
    };
    float texels;               ///< a unit of the scene
    float heights;              ///< steps of height a unit
    float lowest;               ///< height of step 0
    std::vector<Frame> frames;  ///< of each group
    /// Row by row, direction after direction, and a few more, which kernels may read.
    std::vector<std::uint16_t> maps;
};

}  // namespace ink
