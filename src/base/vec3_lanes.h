#pragma once

#include "base/lanes.h"

namespace ink {

/// Sixteen vectors.
struct Vec3Lanes {
    Lanes<float> x, y, z;
};

}  // namespace ink
