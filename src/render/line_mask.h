#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/vec.h"
#include "render/tiles.h"

namespace ink {

/// Pixels that lie near lines.
class LineMask {
  public:
    explicit LineMask(const Tile& area)
        : area_(area),
          words_across_(static_cast<std::size_t>(area.x1 - area.x0) / kBits + 1),
          words_(words_across_ * static_cast<std::size_t>(area.y1 - area.y0)) {}

    /// Marks the pixels whose middles are within `reach` pixels of a point.
    void mark(Vec2f point, float reach);
    /// Whether the pixel at a point is marked.
    bool covers(Vec2f point) const;

  private:
    static constexpr std::size_t kBits = 64;

    std::uint64_t* row(int y) {
        return words_.data() + static_cast<std::size_t>(y - area_.y0) * words_across_;
    }

    Tile area_;
    std::size_t words_across_;
    std::vector<std::uint64_t> words_;  ///< a bit a pixel
};

}  // namespace ink
