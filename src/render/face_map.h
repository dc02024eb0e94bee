#pragma once

#include <cstdint>
#include <vector>

#include "accel/tracer.h"
#include "base/image.h"
#include "base/lanes.h"
#include "scene/scene.h"

namespace ink {

/// What the pixels of a picture see of meshes, as far as the lines between their faces depend on
/// it. Filled tile by tile by the pass that finds lines, for the pass that draws them; threads
/// write disjoint blocks of 4 x 4 pixels.
class FaceMap {
  public:
    static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

    /// For `lattice` points along a pixel's side.
    FaceMap(const Scene& scene, Size size, int lattice);

    const Mesh* mesh(std::uint32_t object) const {
        return meshes_[object];
    }  ///< null: another shape

    /// What 4 x 4 pixels see; blocks beyond the picture are dropped.
    void put(int x, int y, const HitPacket& hits);
    /// What pixel (x, y) sees.
    void put(int x, int y, const HitPacket& hits, int lane);
    /// No pixel of a block sees anything. Every block must be put, by one way or another.
    void put_nothing(int x, int y);

    /// Marks a cell of the lattice, the one with point (i, j) as its upper left corner: another
    /// line runs through it, and the lines between faces in it were found as crossings.
    void mark(int i, int j);
    bool marked(Vec2f at) const;
    /// Whether any cell is marked within so many pixels of the 4 x 4 pixels at (x, y).
    bool any_marked(int x, int y, float reach) const;

    /// What the 4 x 4 pixels at (x, y) see: triangles, counted over all meshes, or kNone.
    const Lanes<std::uint32_t>& triangles(int x, int y) const { return triangles_[block(x, y)]; }
    /// Says that block (x, y) will be asked for soon.
    void prefetch(int x, int y) const {
        if (has(x, y)) __builtin_prefetch(&triangles_[block(x, y)]);
    }
    struct Triangle {
        std::uint32_t object, primitive;
    };
    Triangle triangle(std::uint32_t number) const;

  private:
    template <class T>
    using Plane = std::vector<T, UninitializedAllocator<T>>;

    std::uint32_t number(const HitPacket& hits, int lane) const {
        const std::uint32_t object = hits.object[lane];
        return object == kNoObject || meshes_[object] == nullptr
                   ? kNone
                   : first_[object] + hits.primitive[lane];
    }
    std::size_t block(int x, int y) const {
        return static_cast<std::size_t>(y / kBlockSide) * static_cast<std::size_t>(blocks_across_) +
               static_cast<std::size_t>(x / kBlockSide);
    }
    static int lane(int x, int y) { return y % kBlockSide * kBlockSide + x % kBlockSide; }
    void clear_beyond(int x, int y);
    bool has(int x, int y) const { return x >= 0 && y >= 0 && x < size_.width && y < size_.height; }

    std::vector<const Mesh*> meshes_;   ///< of the scene's objects; null for other shapes
    std::vector<std::uint32_t> first_;  ///< an object: number of its first triangle
    Size size_;
    int lattice_;
    int blocks_across_, blocks_down_;
    Plane<Lanes<std::uint32_t>> triangles_;  ///< by blocks, so that each is one cache line
    std::vector<std::uint8_t> cells_;        ///< 1: marked; empty, as blocks_: none can be
    std::vector<std::uint8_t> blocks_;       ///< 1: one of their cells is
};

}  // namespace ink
