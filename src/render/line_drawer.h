#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/lanes.h"
#include "lines/density.h"
#include "lines/ink.h"
#include "lines/line_planes.h"
#include "render/border_map.h"
#include "render/edges_plan.h"
#include "render/face_edges.h"
#include "render/face_tiling.h"
#include "render/tiles.h"

namespace ink {

/// Draws the lines of one tile after another.
class LineDrawer {
  public:
    /// `faces` and `vertices`, or `borders`, or `tiling`, are what lines between faces are drawn
    /// from; null if there are none.
    LineDrawer(const EdgesPlan& edges, const LineThinning& thinning, const FaceMap* faces,
               const ScreenVertices* vertices, const BorderMap* borders, const FaceTiling* tiling)
        : edges_(edges),
          thinning_(thinning),
          ink_(edges.ink),
          borders_(borders),
          tiling_(tiling),
          one_pass_(goes_in_one_pass()) {
        if (faces == nullptr) return;
        face_edges_.emplace(edges.pipeline.camera.projection(), *faces, *vertices);
        faces_ = faces;
    }

    void draw(const Tile& tile, const std::vector<TileLines>& found);

    RenderStats stats() const { return stats_; }

  private:
    template <class Visit>
    void for_each_near_tile(const Tile& tile, const std::vector<TileLines>& found, Visit visit);
    void gather(const Tile& tile, const std::vector<TileLines>& found);
    void write(const Tile& tile);
    bool goes_in_one_pass() const;
    template <class Faces>
    void write_with_faces(const Tile& tile, const Faces& faces);
    template <class Faces>
    void prefetch_row(const Tile& tile, int y, const Faces& faces) const;
    void lay(int x, int y, const BlockInk& ink);

    void leave_gap(const InkStroke& stroke);
    float width_scale(const InkStroke& stroke) const;
    float cue_depth(int x, int y, const NearestEdges& nearest, Lanes<float>& strength) const;
    template <class Faces, class Draw>
    void for_each_face_block(const Tile& tile, Faces& faces, Draw draw);
    template <class Faces>
    void ink_faces(const Tile& tile, Faces& faces);
    std::uint32_t object_of(std::uint32_t triangle) const {
        return faces_ != nullptr ? faces_->triangle(triangle).object : triangle;
    }
    template <class Faces>
    void gather_blocks(const Tile& tile, const Faces& faces);
    void ink_borders(const Tile& tile);
    void write_planes(const Tile& tile, const std::vector<TileLines>& found);
    void add_face_planes(const Tile& tile);

    const EdgesPlan& edges_;
    const LineThinning& thinning_;
    InkTile ink_;
    const BorderMap* borders_;
    const FaceTiling* tiling_;
    bool one_pass_;  ///< lines between faces need no layers of ink
    const FaceMap* faces_ = nullptr;
    std::optional<FaceEdges> face_edges_;
    LinePlanes planes_;
    std::vector<const InkStroke*> near_;  ///< those within reach of the tile
    std::vector<Vec2f> middles_;          ///< of what is to be drawn: near strokes, or blocks
    std::vector<std::uint8_t> sees_;      ///< a block of the tile: whether it sees faces
    std::vector<float> scales_;           ///< of their widths, where they are seen directly
    RenderStats stats_;
};

}  // namespace ink
