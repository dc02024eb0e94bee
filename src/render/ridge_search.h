#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "lines/ridge_field.h"
#include "lines/ridge_grid.h"
#include "lines/ridges.h"
#include "lines/segment.h"
#include "render/line_mask.h"
#include "render/pipeline.h"
#include "render/tiles.h"
#include "sampling/sampler.h"

namespace ink {

/// Thresholds of the settings in radians a pixel.
RidgeSettings ridge_settings(const Settings& settings);

/// What a tile's lattice saw: hits and shading normals of its blocks.
struct LatticeView {
    std::span<const Block> blocks;
    std::span<const HitPacket> hits;
    std::span<const NormalPacket> normals;
    bool saw_anything;  ///< whether any ray hit
};

/// Finds the apparent ridges of a picture. They need the normals of a wide neighbourhood, so the
/// tiles keep what their lattices saw at the nodes of a grid that is as fine as the neighbourhood
/// asks for; once all are done, ridges are found in it. Only nodes around the picture need rays of
/// their own.
class RidgeSearch {
  public:
    /// `per_pixel` lattice points along a pixel's side; `area` is what all tiles together cover.
    /// What is found does not depend on the number of threads.
    RidgeSearch(const Pipeline& pipeline, const Viewpoint& viewpoint, int per_pixel,
                const Tile& area, int threads);
    ~RidgeSearch();

    /// Threads may keep different tiles at the same time.
    void keep(const Tile& tile, const LatticeView& lattice);

    /// Items of work: the rim in so many strips, beside the tiles or after them, then the grid in
    /// bands. Threads may do different ones at the same time.
    std::size_t strips() const { return strips_.size(); }
    void trace_strip(std::size_t strip, std::size_t thread);
    std::size_t bands() const { return found_.size(); }
    void search_band(std::size_t band, std::size_t thread);

    /// Of a ridge's neighbourhood, pixels.
    float radius_px() const { return static_cast<float>(radius_) / static_cast<float>(per_pixel_); }

    /// Calls `visit` with what was found, but for pieces so near to other lines that they would
    /// touch them (`touching`), and for what is shorter in all than the neighbourhood's radius:
    /// more often than not it is noise of a mesh. What other lines are as near to as that (`near`)
    /// does not count: the normals there turn because of the edge that the other line runs along.
    template <class Visit>
    void take(const LineMask& touching, const LineMask& near, const Visit& visit) {
        for (const RidgePiece& piece : pieces_beside(touching, near)) {
            Segment segment = segment_of(piece);
            visit(segment);
        }
    }

    /// Of all threads.
    RenderStats stats() const;

  private:
    /// What a thread works with.
    struct Worker;
    /// Nodes [x0, x1) x [y0, y1) of the grid.
    using Nodes = Tile;

    std::vector<RidgePiece> pieces_beside(const LineMask& touching, const LineMask& near);
    Segment segment_of(const RidgePiece& piece) const;
    Nodes nodes_of(const Tile& pixels) const;
    int rows_of_cells() const;
    void cut_rim();
    Worker& worker_of(std::size_t thread);
    void trace(const Nodes& strip, Sampler& sampler);
    void put_block(const HitPacket& hits, const NormalPacket& normals, const Block& block);
    void put(const HitPacket& hits, const NormalPacket& normals, int lane, std::size_t node);

    const Pipeline& pipeline_;
    const Viewpoint& viewpoint_;
    int per_pixel_;
    int radius_;  ///< of a ridge's neighbourhood, lattice points
    int step_;    ///< lattice points from node to node
    RidgePattern pattern_;
    int apron_;    ///< nodes
    int x0_, y0_;  ///< lattice point of node (0, 0), in steps
    RidgeGrid grid_;
    int band_rows_;                                 ///< of cells that are searched at a time
    Nodes kept_;                                    ///< by tiles
    std::vector<Nodes> strips_;                     ///< the others
    std::vector<std::uint8_t> balls_;               ///< objects without ridges: each ID is a ball
    bool has_balls_ = false;                        ///< any of them
    std::vector<std::vector<RidgePiece>> found_;    ///< band by band
    std::vector<std::unique_ptr<Worker>> workers_;  ///< a thread
};

}  // namespace ink
