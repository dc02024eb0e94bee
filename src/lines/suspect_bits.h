#pragma once

#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "lines/detect.h"

namespace ink {

/// Which edges are suspect that hang on sixteen points of a lattice, all to the right or all down:
/// bit i is set for the edge of point i.
struct SuspectBits {
    std::uint32_t id, depth, normal;
    std::uint32_t any() const { return id | depth | normal; }

    /// Lists `those` of them; `point(bit)` says where the edge of a bit begins.
    template <class Point>
    void list(std::uint32_t those, bool down, const Point& point,
              std::vector<SuspectEdge>& edges) const {
        for (std::uint32_t rest = any() & those; rest != 0; rest &= rest - 1) {
            const std::uint32_t bit = rest & (0U - rest);
            const Suspicion suspicion = (id & bit) != 0      ? Suspicion::id
                                        : (depth & bit) != 0 ? Suspicion::depth
                                                             : Suspicion::normal;
            const auto [i, j] = point(std::countr_zero(rest));
            edges.push_back(
                {static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j), down, suspicion});
        }
    }
};

}  // namespace ink
