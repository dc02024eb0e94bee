#pragma once

#include <atomic>
#include <bit>
#include <memory>
#include <thread>
#include <vector>

#include "accel/screen_kernels.h"
#include "accel/screen_packets.h"

namespace ink {

/// Screen bounds of a scene's tree of boxes, sixteen a packet, level by level as in
/// Clusters::levels. A packet is projected when it is first asked for, by whichever thread asks:
/// what is out of the picture or hidden costs nothing.
class BoundsPyramid {
  public:
    BoundsPyramid(const Clusters& clusters, const Basis& basis) : basis_(basis) {
        for (const Clusters::Level& level : clusters.levels) {
            const std::size_t packets = level.boxes.size();
            levels_.push_back({&level, std::make_unique_for_overwrite<BoundsPacket[]>(packets),
                               std::make_unique<std::atomic<State>[]>(packets)});
        }
    }

    /// Levels above the clusters; the last of them has one packet. -1: there are no clusters.
    int top() const { return static_cast<int>(levels_.size()) - 1; }

    const BoundsPacket& at(int level, std::size_t packet) const {
        const Level& own = levels_[static_cast<std::size_t>(level)];
        std::atomic<State>& state = own.states[packet];
        if (state.load(std::memory_order_acquire) != State::ready) make(own, packet, state);
        return own.bounds[packet];
    }

  private:
    enum class State : unsigned char { empty, busy, ready };
    struct Level {
        const Clusters::Level* boxes;
        std::unique_ptr<BoundsPacket[]> bounds;
        std::unique_ptr<std::atomic<State>[]> states;
    };

    void make(const Level& level, std::size_t packet, std::atomic<State>& state) const {
        State expected = State::empty;
        if (!state.compare_exchange_strong(expected, State::busy)) {
            while (state.load(std::memory_order_acquire) != State::ready) {
                std::this_thread::yield();
            }
            return;
        }
        const std::size_t used =
            std::min<std::size_t>(kLanes, level.boxes->count - packet * kLanes);
        prepare(basis_, level.boxes->boxes[packet], used, level.bounds[packet]);
        state.store(State::ready, std::memory_order_release);
    }

    Basis basis_;
    std::vector<Level> levels_;
};

}  // namespace ink
