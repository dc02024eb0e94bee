#pragma once

#include <optional>
#include <span>

#include "lines/chain.h"
#include "lines/parabola.h"

namespace ink {

/// An end of a chain as it would go on, at s = 0, from the few points before it; nothing if it has
/// hardly any.
std::optional<Parabola> approach(const Chain& chain, bool last);

/// The point nearest to lines, at their s = 0, in the least-squares sense; `start` decides on
/// directions that they leave open.
Vec2d meeting_point(std::span<const Parabola> lines, Vec2d start);

/// Moves each junction, which is known only to lie in its lattice cell, to where the lines that
/// meet there point: the place nearest to all of them as they go on from the points before it. It
/// stays in its cell, and chains keep ending on it exactly.
void place_junctions(ChainGraph& graph, float spacing);

}  // namespace ink
