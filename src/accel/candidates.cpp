#include "accel/candidates.h"

#include <algorithm>
#include <bit>

namespace ink {

void Candidates::enter(const Window& window) {
    window_ = window;
    found_.clear();
    bounds_.clear();
    if (bands_ != nullptr) {
        bands_->find(window, places_);
        word_ = 0;
        rest_ = places_[0];
        return;
    }
    heap_.clear();
    coarse_.clear();
    coarse_count_ = 0;
    if (pyramid_.top() < 0) return;
    gather(pyramid_.top(), 0);
    std::ranges::make_heap(heap_, after);
}

bool Candidates::reach(const Window& box) const {
    if (bands_ != nullptr) return bands_->reach(box);
    return std::ranges::any_of(
        coarse_, [&](const BoundsPacket& bounds) { return overlap(bounds, box) != 0; });
}

bool Candidates::find_more(float farthest) {
    if (!(next_depth() < farthest)) return false;
    const std::size_t before = found_.size();
    while (found_.size() < before + kLanes && next()) {
    }
    return found_.size() > before;
}

/// No cluster that is left lies nearer. Infinite if there are none.
float Candidates::next_depth() {
    if (bands_ == nullptr) return heap_.empty() ? kInfinity : heap_.front().depth;
    if (!seek()) return kInfinity;
    const std::size_t at = place();
    return bands_->bounds(at / kLanes).depth[static_cast<int>(at % kLanes)];
}

/// Finds the next cluster.
bool Candidates::next() { return bands_ != nullptr ? next_in_order() : next_of_tree(); }

namespace {

void put(const BoundsPacket& from, int lane, std::size_t count, std::vector<BoundsPacket>& to) {
    const auto place = static_cast<int>(count % kLanes);
    if (place == 0) to.push_back(BoundsPacket::none());
    from.copy(lane, to.back(), place);
}

}  // namespace

void Candidates::keep(const Node& node, const BoundsPacket& bounds, int lane) {
    put(bounds, lane, found_.size(), bounds_);
    found_.push_back(node);
}

// ---- In order ----

namespace {

bool overlaps(const BoundsPacket& bounds, int lane, const Window& window) {
    return bounds.left[lane] <= window.right && bounds.right[lane] >= window.left &&
           bounds.top[lane] <= window.bottom && bounds.bottom[lane] >= window.top;
}

}  // namespace

/// Goes on to the next place whose cluster reaches into the window, if it is not there.
bool Candidates::seek() {
    for (;; rest_ &= rest_ - 1) {
        while (rest_ == 0) {
            if (word_ + 1 >= places_.size()) return false;
            rest_ = places_[++word_];
        }
        const std::size_t at = place();
        if (overlaps(bands_->bounds(at / kLanes), static_cast<int>(at % kLanes), window_)) {
            return true;
        }
    }
}

bool Candidates::next_in_order() {
    if (!seek()) return false;
    const std::size_t at = place();
    rest_ &= rest_ - 1;
    const BoundsPacket& bounds = bands_->bounds(at / kLanes);
    const auto lane = static_cast<int>(at % kLanes);
    keep({bounds.depth[lane], bands_->cluster(at), 0}, bounds, lane);
    return true;
}

// ---- In the tree ----

/// Calls `found(node, bounds, lane)` for what a packet holds and reaches into the window.
template <class Found>
void Candidates::open(int level, std::size_t packet, const Found& found) const {
    const BoundsPacket& bounds = pyramid_.at(level, packet);
    for (LaneBits lanes = overlap(bounds, window_); lanes != 0; lanes &= lanes - 1) {
        const int lane = std::countr_zero(lanes);
        const std::size_t child = packet * kLanes + static_cast<std::size_t>(lane);
        found(Node{bounds.depth[lane], static_cast<std::uint32_t>(child), level}, bounds, lane);
    }
}

/// Begins with boxes that are small on the screen, as long as there are not too many.
void Candidates::gather(int level, std::size_t packet) {
    constexpr float kSmall = 16.0F;  // pixels
    constexpr std::size_t kMany = 512;
    open(level, packet, [&](const Node& node, const BoundsPacket& bounds, int lane) {
        const bool small = bounds.right[lane] - bounds.left[lane] < kSmall &&
                           bounds.bottom[lane] - bounds.top[lane] < kSmall;
        if (level > 0 && !small && heap_.size() < kMany) {
            return gather(level - 1, node.index);
        }
        heap_.push_back(node);
        put(bounds, lane, coarse_count_++, coarse_);
    });
}

bool Candidates::next_of_tree() {
    while (!heap_.empty()) {
        std::ranges::pop_heap(heap_, after);
        const Node node = heap_.back();
        heap_.pop_back();
        if (node.level == 0) {
            keep(node, pyramid_.at(0, node.index / kLanes), static_cast<int>(node.index % kLanes));
            return true;
        }
        open(node.level - 1, node.index, [&](const Node& child, const BoundsPacket&, int) {
            heap_.push_back(child);
            std::ranges::push_heap(heap_, after);
        });
    }
    return false;
}

}  // namespace ink
