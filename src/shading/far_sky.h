#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/lanes.h"
#include "scene/spheres.h"
#include "shading/sky_directions.h"

namespace ink {

/// Sixteen balls, relative to some point.
struct BallPacket {
    Lanes<float> x, y, z, radius;
};

/// How far balls reach in every direction of the sky: for each direction, a map of the scene as
/// seen from there, with the height at which the last ball on the way begins.
struct FarSky {
    static constexpr int kTileSide = 8;  ///< texels; a tile is a line of the processor's cache
    struct alignas(64) Tile {
        std::array<std::uint8_t, std::size_t{kTileSide} * kTileSide> heights;  ///< 0: no ball
    };

    /// Uses all threads that parallel_ranges does. Throws Cancelled once `cancel` is true (null:
    /// never).
    FarSky(std::span<const Sphere> balls, const SkyDirections& directions,
           const std::atomic<bool>* cancel = nullptr);

    /// Where the maps of a group's directions lie: texel = middle + texels * (p . right, p . up).
    struct Frame {
        Lanes<float> right_x, right_y, right_z;
        Lanes<float> up_x, up_y, up_z;
        Lanes<float> x, y, z;  ///< the directions
    };

    /// The step that a height belongs to.
    float step_of(float height) const { return 1.0F + (height - lowest) * steps; }
    /// The tile of a direction's map that holds a texel.
    const Tile* tile(std::size_t direction, int column, int row) const {
        return tiles.get() + direction * map_tiles() +
               static_cast<std::size_t>(row / kTileSide) * (side_tiles + 1) +
               static_cast<std::size_t>(column / kTileSide);
    }
    /// Tiles of a map: one more each way than its side says, so that windows need not end in one.
    std::size_t map_tiles() const { return (side_tiles + 1) * (side_tiles + 1); }
    int side() const { return static_cast<int>(side_tiles) * kTileSide; }

    /// Texels from one place of a ball's windows to the next: such that they hold the ball, and
    /// what is blended with.
    float window_stretch(float radius) const { return std::max(radius * texels / 2.5F, 1.0F); }

    std::size_t side_tiles;         ///< along a map's side
    float texels;                   ///< a unit of the scene
    float steps;                    ///< of height a unit
    float lowest;                   ///< height of step 1
    std::vector<Frame> frames;      ///< of each group
    std::unique_ptr<Tile[]> tiles;  ///< row by row, direction after direction
};

/// What points of a ball see of sixteen of the maps: windows of kWindowSide texels squared.
inline constexpr int kWindowSide = 8;
struct FarWindow {
    Lanes<float> x, y;          ///< the ball's centre, in texels from the middle of the first one
    Lanes<std::uint64_t> free;  ///< bit 8 * row + column: nothing begins far away there
};

}  // namespace ink
