#pragma once

#include <array>

#include "base/vec.h"

namespace ink {

/// A rigid motion: row-major rotation, then translation.
struct Motion {
    std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};
    Vec3d shift;

    Vec3d turn(Vec3d v) const {
        const auto& m = rotation;
        return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[3] * v.x + m[4] * v.y + m[5] * v.z,
                m[6] * v.x + m[7] * v.y + m[8] * v.z};
    }
    Vec3d operator()(Vec3d p) const { return turn(p) + shift; }
    Vec3f operator()(Vec3f p) const { return to_float((*this)(to_double(p))); }
    Vec3d turn_back(Vec3d v) const {
        const auto& m = rotation;
        return {m[0] * v.x + m[3] * v.y + m[6] * v.z, m[1] * v.x + m[4] * v.y + m[7] * v.z,
                m[2] * v.x + m[5] * v.y + m[8] * v.z};
    }
    /// Where `p` comes from.
    Vec3d back(Vec3d p) const { return turn_back(p - shift); }
    friend bool operator==(const Motion&, const Motion&) = default;
};

}  // namespace ink
