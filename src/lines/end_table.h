#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "base/vec.h"

namespace ink::plane {

/// Ends of segments by their place, bit for bit.
class EndTable {
  public:
    /// For up to so many ends, most of which meet another one.
    explicit EndTable(std::size_t most)
        : slots_(std::bit_ceil(most + most / 4 + 2)), mask_(slots_.size() - 1) {}

    /// Ends at one place.
    struct Meeting {
        std::uint32_t count = 0;
        std::uint32_t first = 0;  ///< that was added
        std::uint32_t mixed = 0;  ///< all of their numbers, by exclusive or
        /// The end that meets `end`, if these are the only two.
        std::uint32_t other(std::uint32_t end) const { return mixed ^ end; }
    };
    const Meeting& add(Vec2f point, std::uint32_t end) {
        Slot& slot = slots_[find(point)];
        slot.point = point;
        slot.taken = true;
        if (slot.meeting.count == 0) slot.meeting.first = end;
        slot.meeting.mixed ^= end;
        ++slot.meeting.count;
        return slot.meeting;
    }
    /// Takes back what was added.
    void remove(Vec2f point, std::uint32_t end) {
        Meeting& meeting = slots_[find(point)].meeting;
        meeting.mixed ^= end;
        --meeting.count;
    }
    const Meeting& at(Vec2f point) const { return slots_[find(point)].meeting; }
    /// Calls `visit` for each end that meets no other one, in no order that means anything.
    template <class Visit>
    void for_each_alone(Visit visit) const {
        for (const Slot& slot : slots_) {
            if (slot.meeting.count == 1) visit(slot.meeting.mixed);
        }
    }

  private:
    struct Slot {
        Vec2f point;
        bool taken = false;  ///< by ends that may have been removed since
        Meeting meeting;
    };
    std::size_t find(Vec2f point) const {
        const auto x = static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(point.x));
        const auto y = static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(point.y));
        const std::uint64_t mixed = (x << 32U | y) * 0x9E3779B97F4A7C15U;
        std::size_t k = static_cast<std::size_t>(mixed >> 32U) & mask_;
        while (slots_[k].taken && slots_[k].point != point) k = (k + 1) & mask_;
        return k;
    }

    std::vector<Slot> slots_;
    std::size_t mask_;
};

}  // namespace ink::plane
