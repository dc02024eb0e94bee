#pragma once

#include <cstddef>
#include <vector>

#include "lines/ridge_grid.h"
#include "lines/ridge_rows.h"

namespace ink {

/// Finds, row by row, the nodes of a grid about which a whole disc lies on one smooth surface: each
/// of its nodes is linked (link_nodes) to its neighbours in it. That is an erosion of the links by
/// the disc, 64 nodes at a time.
class SmoothDiscs {
  public:
    /// A disc reaches `half_widths[d]` nodes to either side in the rows that are d away from its
    /// middle; they must not grow with d, nor exceed 63.
    SmoothDiscs(const RidgeGrid& grid, const Viewpoint& viewpoint, std::vector<int> half_widths);

    int radius() const { return static_cast<int>(half_widths_.size()) - 1; }

    /// Starts with a row; all rows up to `radius` from it must be there.
    void start(int row);
    /// Bit i is set where there is such a disc about node i of the row. Each call goes on to the
    /// next row, beginning with the one that was started with.
    const std::vector<NodeBits>& next();

  private:
    /// Links of a row, eroded across by each half width.
    struct Row {
        std::vector<NodeBits> across;  ///< between nodes of the row that are within reach
        std::vector<NodeBits> down;    ///< from nodes that are within reach to the next row
    };

    Row& row(int j) { return rows_[static_cast<std::size_t>(j) % rows_.size()]; }
    void enter(int j);

    const RidgeGrid& grid_;
    const Viewpoint& viewpoint_;
    std::vector<int> half_widths_;
    std::size_t words_;
    std::vector<Row> rows_;  ///< those that a disc meets
    std::vector<NodeBits> links_, nodes_;
    NodePlaces places_, places_below_;  ///< of the row that is entered, and the next one
    int next_ = 0;
};

}  // namespace ink
