#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "accel/bounds_pyramid.h"
#include "accel/screen_kernels.h"
#include "base/multiversion.h"

namespace ink {

/// How a direction of the screen is cut into bands. What lies beyond belongs to the outermost.
struct BandAxis {
    float from = 0.0F, scale = 0.0F;
    int count = 1;
    INKTRACE_INLINE int band(float at) const {
        const float place = (at - from) * scale;
        const float last = static_cast<float>(count - 1);
        const float positive = place > 0.0F ? place : 0.0F;  // of no number, zero
        return static_cast<int>(positive < last ? positive : last);
    }
};

/// The first and the last band that each of sixteen clusters reaches into.
struct BandSpans {
    Lanes<int> left, right, top, bottom;
};

/// All clusters of a picture, nearest first, and which of them reach into each of a few bands of
/// columns and of rows: a bit a cluster. So those that reach into a part of the screen are found
/// in order by a few words of bits, without sorting them for each part anew.
class ClusterBands {
  public:
    /// More clusters than this are looked for in the tree of boxes: to project and sort all of them
    /// would take longer than to find those that are seen.
    static constexpr std::size_t kMost = 16384;

    /// Of `count` clusters, whose bounds are level 0 of the pyramid. The picture reaches from
    /// `-centre` to `centre`.
    ClusterBands(const BoundsPyramid& pyramid, std::size_t count, Vec2f centre);

    /// Sets a bit for each place in the order, 64 a word, whose cluster may reach into the window.
    void find(const Window& window, std::vector<std::uint64_t>& places) const;
    /// False only if no cluster reaches into the window.
    bool reach(const Window& window) const { return cover_.meets(window); }
    /// The same of windows side by side, see TileTracer::reached.
    std::uint64_t reached(const Window& first, float step, int count) const {
        return cover_.met(first, step, count);
    }

    std::uint32_t cluster(std::size_t place) const { return order_[place]; }
    /// Sixteen places a packet.
    const BoundsPacket& bounds(std::size_t packet) const { return bounds_[packet]; }

  private:
    static constexpr int kBands = 64;

    /// Which of the picture's cells anything reaches into, a bit a cell.
    class Cover {
      public:
        explicit Cover(Vec2f centre);
        void add(const BoundsPacket& bounds, int count);
        bool meets(const Window& box) const {
            const int left = columns_.band(box.left);
            const int right = columns_.band(box.right - kInside);
            const int top = rows_.band(box.top);
            const int bottom = rows_.band(box.bottom - kInside);
            if (((left ^ right) | (top ^ bottom)) != 0) return any(left, right, top, bottom);
            // A block of pixels.
            const auto column = static_cast<std::size_t>(left);
            const std::uint64_t word = cells_[static_cast<std::size_t>(top) * words_ + column / 64];
            return (word >> column % 64 & 1U) != 0;
        }

        std::uint64_t met(const Window& first, float step, int count) const;

      private:
        /// Bounds are wider than what they bound, so that what only touches a box from outside
        /// does not count.
        static constexpr float kInside = 1e-3F;

        bool any(int left, int right, int top, int bottom) const;

        BandAxis columns_, rows_;
        std::size_t words_;  ///< a row
        std::vector<std::uint64_t> cells_;
    };

    void sort(const BoundsPyramid& pyramid);
    void cover(const BoundsPyramid& pyramid);
    void lay_axes(const BoundsPacket& top, Vec2f centre);
    int used(std::size_t packet) const;
    void mark_bands(std::size_t word);

    std::vector<std::uint32_t> order_;
    std::vector<BoundsPacket> bounds_;
    BandAxis columns_, rows_;
    std::size_t words_;                     ///< a band
    std::vector<std::uint64_t> of_column_;  ///< a bit a place, band by band
    std::vector<std::uint64_t> of_row_;
    Cover cover_;
};

}  // namespace ink
