#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "accel/projection.h"
#include "accel/tracer.h"
#include "base/image.h"
#include "base/lanes.h"
#include "render/enlarge.h"
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
    void put(int x, int y, const HitPacket& hits, const SidesPacket* sides);

    /// Pixel (x, y) of the large picture, which is in a cell of the lattice through which a line
    /// runs, sees the same surface as that corner of the cell, and not as the nearest one.
    void look_at(int x, int y, int column, int row);

    /// The length of lines about such a point, in pixels of the small picture, by the share that
    /// its area has of the triangle that it sees.
    float length_at(int x, int y, int lane) const;

    /// Whether the 4 x 4 pixels at (x, y) of the large picture see any face.
    bool sees(int x, int y) const;
    /// Their nearest lines; instead of triangles it names objects. False if none is within reach.
    bool measure(int x, int y, float reach, NearestEdges& nearest) const;

  private:
    static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

    /// A triangle and how a point lies in it: of two of its sides as in TriangleSides, those of the
    /// third follow.
    struct Spot {
        std::array<float, 2> inside, dx, dy;
        float t;
        std::uint32_t object;  ///< and in its lowest three bits which sides have no line; or kNone
    };
    /// Of four columns or rows of the large picture, the nearest point of the small one of each,
    /// and from it to the pixel's centre, pixels.
    struct Places {
        std::array<int, kBlockSide> nearest;
        Lanes<float> off;  ///< of each pixel of a block
    };

    const Spot& spot(int x, int y) const {
        return spots_[block(x, y) * kLanes +
                      static_cast<std::size_t>(y % kBlockSide * kBlockSide + x % kBlockSide)];
    }
    std::size_t block(int x, int y) const {
        return static_cast<std::size_t>(y / kBlockSide) * static_cast<std::size_t>(blocks_across_) +
               static_cast<std::size_t>(x / kBlockSide);
    }
    TriangleSides project_sides(const Mesh& mesh, std::uint32_t triangle, Vec2f point) const;
    bool is_plain(const std::uint8_t* aside, const Places& columns, const Places& rows) const;
    void measure_points(const std::uint8_t* aside, const Places& columns, const Places& rows,
                        NearestEdges& nearest) const;
    TilingLines lines_of(const Spot& spot) const;

    std::vector<const Mesh*> meshes_;  ///< of the scene's objects; null for other shapes
    Projection projection_;
    Size small_, large_;
    float factor_;
    int blocks_across_;
    std::vector<Places> columns_, rows_;  ///< by blocks of the large picture
    std::vector<std::uint8_t> seen_;      ///< a block of the small picture: it sees a mesh
    std::vector<Spot, UninitializedAllocator<Spot>> spots_;
    /// By blocks of the large picture, a pixel: 0, or where the point that it sees the surface of
    /// lies from the nearest one, see look_at.
    std::vector<std::uint8_t> aside_;
};

}  // namespace ink
