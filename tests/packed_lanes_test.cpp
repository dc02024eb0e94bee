#include "base/packed_lanes.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace ink {
namespace {

TEST(PackedLanes, PutsTheLanesOfASetFirst) {
    for (std::uint32_t set = 0; set < kPackedLanes.size(); ++set) {
        std::vector<std::uint32_t> expected;
        for (const bool wanted : {true, false}) {
            for (std::uint32_t lane = 0; lane < 8; ++lane) {
                if (((set >> lane & 1U) != 0) == wanted) expected.push_back(lane);
            }
        }
        std::vector<std::uint32_t> order;
        for (unsigned k = 0; k < 8; ++k) order.push_back(kPackedLanes[set] >> 4 * k & 15U);
        EXPECT_EQ(order, expected) << set;
    }
}

}  // namespace
}  // namespace ink
