#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/lanes.h"
#include "lines/density.h"
#include "lines/ink.h"
#include "lines/line_planes.h"
#include "render/edges_method.h"
#include "render/face_edges.h"
#include "render/tiles.h"

namespace ink {

/// Draws the lines of one tile after another.
class LineDrawer {
  public:
    /// `faces` is what lines between faces are drawn from; null if there are none.
    LineDrawer(const Edges& edges, const LineThinning& thinning, const FaceMap* faces)
        : edges_(edges), thinning_(thinning), ink_(edges.ink) {
        if (faces == nullptr || edges.pipeline.lines.drawing != nullptr) return;
        face_edges_.emplace(edges.pipeline.camera.projection(), *faces);
        faces_ = faces;
    }

    void draw(const Tile& tile, const std::vector<std::vector<ColoredSegment>>& found);

    RenderStats stats() const { return stats_; }

  private:
    static constexpr float kFixedPoint = 1 << 22;
    static constexpr float kMostChange = 64.0F;

    void gather(const Tile& tile, const std::vector<std::vector<ColoredSegment>>& found);
    void smooth(const Tile& tile, const ColoredSegment& line);
    void write(const Tile& tile);

    void ink(const Segment& segment);
    float width_scale_of(const Segment& segment) const;
    template <class Draw>
    void for_each_face_block(const Tile& tile, Draw draw);
    void ink_faces(const Tile& tile);
    void write_planes(const Tile& tile);
    void add_face_planes(const Tile& tile);

    const Edges& edges_;
    const LineThinning& thinning_;
    InkTile ink_;
    const FaceMap* faces_ = nullptr;
    std::optional<FaceEdges> face_edges_;
    LinePlanes planes_;
    std::vector<const ColoredSegment*> near_;  ///< segments within reach of the tile
    /// What smoothing adds to each pixel's colour: linear, premultiplied R, G, B, A. In fixed
    /// point, for a sum that does not depend on the order of segments, and so not on the tiles.
    std::array<std::vector<std::int32_t>, 4> shift_;
    std::array<Lanes<float>, 4> shift_run_;
    RenderStats stats_;
};

}  // namespace ink
