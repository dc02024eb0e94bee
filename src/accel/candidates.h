#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "accel/bounds_pyramid.h"
#include "accel/cluster_bands.h"
#include "accel/screen_kernels.h"

namespace ink {

/// The clusters that reach into a part of the screen, nearest first. They are found as far back as
/// they are asked for: what lies behind all that is seen is never looked at.
class Candidates {
  public:
    /// `bands`: null where there are too many clusters; then the tree of boxes is searched.
    Candidates(const BoundsPyramid& pyramid, const ClusterBands* bands)
        : pyramid_(pyramid), bands_(bands) {}

    void enter(const Window& window);

    /// Sixteen of them, of which only the last packet may have fewer.
    std::size_t packets() const { return bounds_.size(); }
    std::size_t count() const { return found_.size(); }
    /// Finds another packet, if there is one that begins nearer than `farthest`.
    bool find_more(float farthest);

    const BoundsPacket& bounds(std::size_t packet) const { return bounds_[packet]; }
    BoundsPacket& bounds(std::size_t packet) { return bounds_[packet]; }
    float depth(std::size_t i) const { return found_[i].depth; }
    std::uint32_t cluster(std::size_t i) const { return found_[i].index; }

    /// False only if nothing reaches into a box of the window.
    bool reach(const Window& box) const;

  private:
    /// A cluster (level 0), or a packet of the level below.
    struct Node {
        float depth;
        std::uint32_t index;
        int level;

        /// Boxes before what is in them, so that the order of clusters is always the same.
        bool comes_after(const Node& other) const {
            if (depth != other.depth) return depth > other.depth;
            if (level != other.level) return level < other.level;
            return index > other.index;
        }
    };
    static bool after(const Node& a, const Node& b) { return a.comes_after(b); }

    float next_depth();
    bool next();
    bool seek();
    bool next_in_order();
    bool next_of_tree();
    void keep(const Node& node, const BoundsPacket& bounds, int lane);
    template <class Found>
    void open(int level, std::size_t packet, const Found& found) const;
    void gather(int level, std::size_t packet);

    const BoundsPyramid& pyramid_;
    const ClusterBands* bands_;
    Window window_{};
    std::vector<Node> found_;           ///< clusters
    std::vector<BoundsPacket> bounds_;  ///< of the clusters

    // With bands:
    std::vector<std::uint64_t> places_;  ///< of clusters in their order, a bit each
    std::size_t word_ = 0;               ///< of `places_`, the one that the search has come to
    std::uint64_t rest_ = 0;             ///< of it
    std::size_t place() const {
        return word_ * 64 + static_cast<std::size_t>(std::countr_zero(rest_));
    }
    // In the tree:
    std::vector<Node> heap_;            ///< not opened yet
    std::vector<BoundsPacket> coarse_;  ///< of what the search began with
    std::size_t coarse_count_ = 0;
};

}  // namespace ink
