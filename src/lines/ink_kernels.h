#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/lanes.h"

namespace ink {

/// Sixteen strokes to be drawn.
struct StrokeLanes {
    Lanes<float> ax, ay, bx, by;  ///< ends, pixels
    Lanes<float> width;           ///< pixels
    Lanes<float> strength, t;
};

/// The planes of a tile whose upper left pixel has its centre at (x0, y0), by blocks of 4 x 4.
struct InkPlanes {
    float x0, y0;
    std::size_t across;  ///< blocks
    Lanes<float>* coverage;
    Lanes<float>* t;        ///< null: not wanted
    std::uint8_t* touched;  ///< kTouched or, where no more ink can change anything, kFull
    /// What narrow strokes ink, pixel by pixel and row by row, as many more to the right and below
    /// as a window may reach beyond the blocks: the ink of a pixel is the greater of both, its t
    /// the lesser.
    float* narrow;
    float* narrow_t;     ///< null: not wanted
    std::size_t stride;  ///< pixels
    /// Of soft strokes in full strength, from which all ink follows in the end: the least square of
    /// a pixel's distance over half the width. Null where strokes are solid; then narrow is not.
    Lanes<float>* squared;
};
inline constexpr std::uint8_t kTouched = 1, kFull = 2;
/// The widest and the highest window of pixels that is inked at a time.
inline constexpr std::size_t kInkWindowAcross = 8, kInkWindowDown = 2;

/// The first `count` of the strokes, each onto planes of its own, all of a tile of `width` x
/// `height` pixels.
struct InkBatch {
    StrokeLanes strokes;
    std::array<const InkPlanes*, kLanes> planes;
    int count = 0;
    int width = 0, height = 0;
};

/// Inks each pixel by its exact area under the band. Round ends fall off as the band does across:
/// exactly so where the line goes on, nearly straight, and by less than 1/16 of a pixel elsewhere;
/// so no end claims more than the band, or it would widen the lines that go on from it.
void draw_solid(const InkBatch& batch);

/// After all strokes: brings together what narrow ones and all else ink.
void finish_solid(const InkPlanes& planes, std::size_t blocks);

/// Inks 4 x 4 pixels with the bands along the borders of what they see, each by its area under the
/// nearest one. `codes` are BorderCodes of distances up to `reach`. Where there is ink, `nearest`
/// becomes at most `depths` plus `behind`. False if there is none.
bool draw_borders(const Lanes<std::uint32_t>& codes, float reach, float half,
                  const Lanes<float>& depths, float behind, Lanes<float>& coverage,
                  Lanes<float>& nearest);
/// The same where all lines have one ink: `alpha`, that of other lines, becomes at least that of
/// the bands. False if it stays as it is.
bool ink_borders(const Lanes<std::uint32_t>& codes, float reach, float half, float opacity,
                 Lanes<float>& alpha);

/// Inks each pixel by the distance of its centre from the line: `profile` holds strengths at equal
/// steps of distance from 0 to half the width, between which they are straight, and one 0 more.
void draw_soft(const InkBatch& batch, std::span<const float> profile);
/// After all strokes.
void finish_soft(const InkPlanes& planes, std::size_t blocks, std::span<const float> profile);

}  // namespace ink
