#pragma once

#include <algorithm>
#include <limits>

#include "base/vec.h"

namespace ink {

/// An axis-aligned box; empty (lower > upper) until something is added.
template <class T>
struct Bounds3 {
    Vec3<T> lower{kMax, kMax, kMax};
    Vec3<T> upper{-kMax, -kMax, -kMax};

    static constexpr T kMax = std::numeric_limits<T>::max();

    constexpr bool empty() const { return lower.x > upper.x; }

    /// Extends the box to hold the ball of `radius` about `centre`.
    constexpr void add(Vec3<T> centre, T radius = T(0)) {
        lower = {std::min(lower.x, centre.x - radius), std::min(lower.y, centre.y - radius),
                 std::min(lower.z, centre.z - radius)};
        upper = {std::max(upper.x, centre.x + radius), std::max(upper.y, centre.y + radius),
                 std::max(upper.z, centre.z + radius)};
    }
    constexpr void add(const Bounds3& other) {
        if (other.empty()) return;
        add(other.lower);
        add(other.upper);
    }

    constexpr Vec3<T> centre() const { return (lower + upper) * T(0.5); }
    constexpr Vec3<T> extent() const { return upper - lower; }

    /// Corner k of 8: bit 0 picks x, bit 1 y, bit 2 z.
    constexpr Vec3<T> corner(int k) const {
        return {(k & 1) != 0 ? upper.x : lower.x, (k & 2) != 0 ? upper.y : lower.y,
                (k & 4) != 0 ? upper.z : lower.z};
    }
};

using Bounds3f = Bounds3<float>;
using Bounds3d = Bounds3<double>;

}  // namespace ink
