#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/lanes.h"
#include "lines/ridge_grid.h"
#include "lines/ridges.h"
#include "sampling/samples.h"

namespace ink {

/// One bit a node of a row, 64 a word.
using NodeBits = std::uint64_t;
inline constexpr int kNodesInWord = 64;
inline constexpr std::size_t words_for(int nodes) {
    return static_cast<std::size_t>((nodes + kNodesInWord - 1) / kNodesInWord);
}

/// Where what the nodes of a row see lies, in the scene's frame; of no meaning on the background.
/// There is room for sixteen more.
struct NodePlaces {
    std::vector<float> x, y, z;
};
void place_nodes(const RidgeGrid& grid, int row, const Viewpoint& viewpoint, NodePlaces& places);

/// Nodes of a grid, as many as there are places from that one on.
struct NodeRow {
    const RidgeGrid& grid;
    std::size_t first;  ///< of the grid
    const NodePlaces& places;
    std::size_t first_place;
};

/// Sets bit i where nodes i of two rows, which lie side by side, are on one smooth surface: normals
/// differ by less than 60 degrees, and the chord is at a right angle to their mean, about. `count`
/// of them; further bits of the last word are cleared.
void link_nodes(const NodeRow& a, const NodeRow& b, int count, NodeBits* links);

/// Points of a neighbourhood that mirror each other, as offsets in a grid's planes, with the
/// weights that the first one has in each derivative. Those of the others are the same, or
/// opposite.
struct MirroredPoints {
    std::array<std::ptrdiff_t, 2> offsets;  ///< of (i, j) and (-i, j); the others are opposite
    std::array<float, RidgeEstimator::kDerivatives> weights;
};

struct MirroredPattern {
    std::vector<MirroredPoints> on_x, on_y;  ///< two on an axis
    std::vector<MirroredPoints> off_axes;    ///< four
};

/// Derivatives of the components of the normals at sixteen nodes.
using DerivativeRows = std::array<std::array<Lanes<float>, 3>, RidgeEstimator::kDerivatives>;

/// At the nodes from `first` on.
void differentiate(const RidgeGrid& grid, std::size_t first, const MirroredPattern& pattern,
                   DerivativeRows& derivatives);

/// What ridges are found by, at the nodes of a row; see RidgeEstimate. Rows have room for sixteen
/// more entries than there are nodes.
struct RidgeRow {
    const float *slope, *bend, *along_x, *along_y, *strength;
};

/// Sets bit i where a ridge runs between entries i of two rows: both have a strength, the slope
/// changes its sign, as the sense of t1 allows, and there is a maximum.
void cross_rows(const RidgeRow& a, const RidgeRow& b, int count, NodeBits* crossed);

}  // namespace ink
