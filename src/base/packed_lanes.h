#pragma once

#include <array>
#include <cstdint>

namespace ink {

/// For each set of up to eight lanes, as bits: the lanes of the set, then all others, each
/// ascending. Four bits a lane, the first lowest.
inline constexpr auto kPackedLanes = [] {
    std::array<std::uint32_t, 256> orders{};
    for (std::uint32_t set = 0; set < orders.size(); ++set) {
        unsigned shift = 0;
        for (const std::uint32_t wanted : {1U, 0U}) {
            for (std::uint32_t lane = 0; lane < 8; ++lane) {
                if ((set >> lane & 1U) != wanted) continue;
                orders[set] |= lane << shift;
                shift += 4;
            }
        }
    }
    return orders;
}();

}  // namespace ink
