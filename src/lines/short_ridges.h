#pragma once

#include <span>
#include <vector>

#include "lines/ridge_field.h"

namespace ink {

/// Drops ridges whose pieces that hang together are shorter in all than the discs across that they
/// were taken from, of `radius` pixels, by the `lengths` that count of each: a bump is as wide as
/// long, and no ridge. Pieces come, and stay, row by row and from left to right, of a grid with
/// rows of `width` nodes.
void drop_short_ridges(std::vector<RidgePiece>& pieces, std::span<const float> lengths, int width,
                       float radius);

}  // namespace ink
