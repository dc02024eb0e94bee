#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lines/ridge_grid.h"
#include "lines/ridge_rows.h"
#include "lines/ridges.h"
#include "lines/smooth_discs.h"

namespace ink {

/// With which weights the normals of a neighbourhood, a disc, go into the derivatives at its
/// middle: the same at all nodes of a grid.
struct RidgePattern {
    /// `radius` in nodes, `spacing` between these in pixels.
    RidgePattern(int radius, float spacing);

    /// A point with no negative coordinate; those that mirror it in the axes go with it.
    struct Point {
        int i, j;  ///< not both zero
        std::array<float, RidgeEstimator::kDerivatives> weights;
    };
    std::vector<Point> points;

    /// How far the neighbourhood reaches to either side in the rows so many from its middle.
    std::vector<int> half_widths() const;
};

/// A piece of a ridge in a cell of the grid.
struct RidgePiece {
    Vec2f a, b;  ///< ends, pixels
    float strength;
    std::size_t node;  ///< of the grid, that sees what the ridge is on
    /// The edges between nodes on which it begins and ends, which pieces that go on from it share:
    /// twice the index of the left or upper node, and one more if the other lies below.
    std::array<std::size_t, 2> edges;
};

/// Finds ridges in bands of rows of a grid, one band after another.
class RidgeField {
  public:
    /// Keeps references.
    RidgeField(const RidgeGrid& grid, const Viewpoint& viewpoint, const RidgePattern& pattern,
               const RidgeSettings& settings);

    /// Rows and columns at the rim of the grid in which there are no estimates.
    int apron() const { return discs_.radius(); }

    /// Adds the pieces in the cells between rows `first` and `last`, both at least an apron from
    /// the grid's rim, row by row.
    void find(int first, int last, std::vector<RidgePiece>& pieces);

  private:
    /// Estimates along a row, from the apron on.
    struct Row {
        std::vector<float> slope, bend, along_x, along_y, strength;
        std::vector<NodeBits> crossed;  ///< between a node and the next one

        RidgeRow from(int i) const {
            const auto n = static_cast<std::size_t>(i);
            return {slope.data() + n, bend.data() + n, along_x.data() + n, along_y.data() + n,
                    strength.data() + n};
        }
    };
    struct Node {
        const Row& row;
        int i, j;  ///< column after the apron, row of the grid
    };
    struct Crossing {
        Vec2f point;
        float strength = 0.0F;
        std::size_t edge = 0;
    };

    void estimate_row(int j, Row& row);
    void estimate_some(std::size_t first, std::uint32_t wanted, Row& row, std::size_t to);
    void connect_rows(int j, std::vector<RidgePiece>& pieces);
    Crossing cross(const Node& a, const Node& b) const;
    Crossing cross_side(int i, int j, int side) const;
    void connect_cell(int i, int j, std::uint32_t sides, std::vector<RidgePiece>& pieces);

    const RidgeGrid& grid_;
    RidgeSettings settings_;
    SmoothDiscs discs_;
    MirroredPattern pattern_;
    int columns_;  ///< of nodes with estimates
    Row upper_, lower_;
    std::vector<NodeBits> crossed_down_;  ///< between a node of the upper row and that below
};

}  // namespace ink
