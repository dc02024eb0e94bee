#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/lanes.h"
#include "base/vec.h"

namespace ink {

/// A straight piece of a line, ready to be drawn.
struct Band {
    Vec2f a, along;      ///< start and unit direction
    float length, half;  ///< half: of its width, pixels
    float strength, t;
};

/// From the middle of a line to the farthest pixel centre that it inks, less half its width.
inline constexpr float kHalfDiagonal = 0.75F;

/// Blocks of a tile.
struct BlockRange {
    int left, right, top, bottom;  ///< inclusive
};

/// The planes of a tile whose upper left pixel has its centre at (x0, y0), by blocks of 4 x 4.
struct InkPlanes {
    float x0, y0;
    std::size_t across;  ///< blocks
    Lanes<float>* coverage;
    Lanes<float>* t;        ///< null: not wanted
    std::uint8_t* touched;  ///< kTouched or, where no more ink can change anything, kFull
};
inline constexpr std::uint8_t kTouched = 1, kFull = 2;

/// Inks each pixel by its exact area under the band. Round ends fall off as the band does across:
/// exactly so where the line goes on, nearly straight, and by less than 1/16 of a pixel elsewhere;
/// so no end claims more than the band, or it would widen the lines that go on from it.
void draw_solid(const Band& band, const BlockRange& range, const InkPlanes& planes);

/// Inks each pixel by the distance of its centre from the line: `profile` holds strengths for
/// equal steps of distance from 0 to half the width, and a last 0 for all beyond.
void draw_soft(const Band& band, const BlockRange& range, const InkPlanes& planes,
               std::span<const float> profile);

}  // namespace ink
