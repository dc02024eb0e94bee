#pragma once

#include <array>
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

    struct Meeting {
        std::uint32_t count = 0;
        std::array<std::uint32_t, 2> ends{};  ///< of the first two
    };
    const Meeting& add(Vec2f point, std::uint32_t end) {
        Slot& slot = slots_[find(point)];
        slot.point = point;
        if (slot.meeting.count < 2) slot.meeting.ends.at(slot.meeting.count) = end;
        ++slot.meeting.count;
        return slot.meeting;
    }
    const Meeting& at(Vec2f point) const { return slots_[find(point)].meeting; }

  private:
    struct Slot {
        Vec2f point;
        Meeting meeting;
    };
    std::size_t find(Vec2f point) const {
        const auto x = static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(point.x));
        const auto y = static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(point.y));
        const std::uint64_t mixed = (x << 32U | y) * 0x9E3779B97F4A7C15U;
        std::size_t k = static_cast<std::size_t>(mixed >> 32U) & mask_;
        while (slots_[k].meeting.count > 0 && slots_[k].point != point) k = (k + 1) & mask_;
        return k;
    }

    std::vector<Slot> slots_;
    std::size_t mask_;
};

}  // namespace ink::plane
