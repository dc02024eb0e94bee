#pragma once

#include "accel/projection.h"
#include "accel/screen_packets.h"

namespace ink {

/// What a sphere shows of itself in a part of the screen, rounding allowed for.
struct SphereRange {
    bool covers = false;                    ///< all of it, and not only just
    bool reaches = false;                   ///< any of it; if not sure, true
    float nearest = 0.0F, farthest = 0.0F;  ///< depths between which those there lie
};
SphereRange sphere_range(const Projection& projection, const SphereForm& form,
                         const Window& window);

}  // namespace ink
