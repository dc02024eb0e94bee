#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "accel/projection.h"
#include "accel/tracer.h"
#include "base/image.h"
#include "base/lanes.h"
#include "render/enlarge.h"
#include "render/face_band.h"
#include "render/nearest_edges.h"
#include "render/tiling_lines.h"
#include "scene/scene.h"

namespace ink {

/// The triangles that the points of a small picture see, for the lines between faces of a large
/// one. What lies beside such a triangle is taken to go on like it: a triangle, turned about the
/// middle of each of its sides again and again, covers the plane, and the sides of all these are
/// three families of parallel lines, whose distances from a pixel are there in closed form. So
/// lines run on where triangles are too small for each to be seen by a point, and are as dense as
/// in the picture in full.
class FaceTiling {
  public:
    FaceTiling(const Scene& scene, const Projection& projection, const Enlargement& enlargement);

    /// What 4 x 4 points of the small picture see; blocks beyond it are dropped. Threads may put
    /// different blocks at the same time. `sides` as far as they are known, else null.
    /// False if it is not kept, as it lies beyond the picture or sees no mesh.
    bool put(int x, int y, const HitPacket& hits, const SidesPacket* sides);

    /// To be called for all rows of the large picture, before any of them looks aside. Bands of
    /// rows begin with a row of blocks; threads may take different ones.
    void look_nowhere(int first_row, int last_row);
    /// Pixel (x, y) of the large picture, which is in a cell of the lattice through which a line
    /// runs, sees the same surface as that corner of the cell, and not as the nearest one.
    void look_at(int x, int y, int column, int row);

    /// The length of lines about such a point, in pixels of the small picture, by the share that
    /// its area has of the triangle that it sees.
    float length_at(int x, int y, int lane) const;

    /// Whether the 4 x 4 pixels at (x, y) of the large picture see any face.
    bool sees(int x, int y) const {
        const std::int32_t column = one_column_[static_cast<std::size_t>(x / kBlockSide)];
        const std::int32_t row = one_row_[static_cast<std::size_t>(y / kBlockSide)];
        if (column == kSeveral || row == kSeveral) return several_see(x, y);
        return near_[static_cast<std::size_t>(column + row) / kLanes] != 0;
    }
    /// Their nearest lines; instead of triangles it names objects. False if none is within reach.
    bool measure(int x, int y, float reach, NearestEdges& nearest) const;
    /// What the lines between faces leave on those of sixteen blocks side by side, from pixel
    /// (x, y) on, that see any, where all lines have one ink: that of others, which `alphas` hold,
    /// where it is more. Returns those that have such lines.
    LaneBits ink(int x, int y, LaneBits seeing, const RowBands& bands,
                 std::span<Lanes<float>> alphas) const;
    /// Nothing: to find out where a block's spots are takes as long as to wait for them.
    void prefetch(int /*x*/, int /*y*/) const {}

  private:
    static constexpr std::uint8_t kSeesMesh = 1;
    static constexpr std::uint8_t kLooksAside = 2;  ///< pixels about it do
    static constexpr std::int32_t kSeveral = -1;

    /// Of four columns or rows of the large picture, the nearest point of the small one of each,
    /// and from it to the pixel's centre, pixels.
    struct Places {
        std::array<int, kBlockSide> nearest;
        Lanes<float> off;  ///< of each pixel of a block
    };

    std::size_t block(int x, int y) const {
        return static_cast<std::size_t>(y / kBlockSide) * static_cast<std::size_t>(blocks_across_) +
               static_cast<std::size_t>(x / kBlockSide);
    }
    /// Of a point's index, what its column gives, and its row.
    std::int32_t index_of_column(int column) const {
        return column / kBlockSide * kLanes + column % kBlockSide;
    }
    std::int32_t index_of_row(int row) const {
        return row / kBlockSide * blocks_across_ * kLanes + row % kBlockSide * kBlockSide;
    }
    bool several_see(int x, int y) const;
    bool ink_about_several(int x, int y, const RowBands& band, Lanes<float>& alpha) const;
    std::optional<std::int32_t> one_spot(int x, int y) const;
    TriangleSides project_sides(const Mesh& mesh, std::uint32_t triangle, Vec2f point) const;
    const std::uint8_t* aside_of(int x, int y) const {
        return aside_.data() + (static_cast<std::size_t>(y / kBlockSide) * columns_.size() +
                                static_cast<std::size_t>(x / kBlockSide)) *
                                   kLanes;
    }
    static bool looks_aside(const std::uint8_t* aside);
    const TilingSpot* spot_at(int column, int row) const;
    template <class Visit>
    void for_each_spot(int x, int y, const Visit& visit) const;

    std::vector<const Mesh*> meshes_;  ///< of the scene's objects; null for other shapes
    Projection projection_;
    Size small_, large_;
    float factor_;
    int blocks_across_;
    std::vector<Places> columns_, rows_;  ///< by blocks of the large picture
    /// What the columns and rows of their one nearest point add to its index, or kSeveral.
    std::vector<std::int32_t> one_column_, one_row_;
    std::vector<std::uint8_t> near_;  ///< by blocks of the small picture: the bits above
    std::vector<TilingSpot, UninitializedAllocator<TilingSpot>> spots_;
    /// By blocks of the large picture, a pixel: 0, or where the point that it sees the surface of
    /// lies from the nearest one, see look_at.
    std::vector<std::uint8_t, UninitializedAllocator<std::uint8_t>> aside_;
};

}  // namespace ink
