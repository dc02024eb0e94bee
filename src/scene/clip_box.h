#pragma once

#include <limits>

#include "base/vec.h"

namespace ink {

/// A box in the units of the file: what has its centre outside is not drawn.
struct ClipBox {
    Vec3d lower{-kFar, -kFar, -kFar};
    Vec3d upper{kFar, kFar, kFar};
    static constexpr double kFar = std::numeric_limits<double>::infinity();

    bool everything() const {
        return lower == Vec3d{-kFar, -kFar, -kFar} && upper == Vec3d{kFar, kFar, kFar};
    }
    bool holds(Vec3d p) const {
        return p.x >= lower.x && p.x <= upper.x && p.y >= lower.y && p.y <= upper.y &&
               p.z >= lower.z && p.z <= upper.z;
    }
};

}  // namespace ink
