#pragma once

#include <vector>

#include "accel/tracer.h"
#include "base/vec.h"

namespace ink {

/// Openness by rays: of anything, for anything.
class RaySky {
  public:
    /// `rays`: sixteen times a power of two.
    RaySky(const Tracer& tracer, int rays);

    /// At a point of a surface, whose normal faces the side that is asked about. Rays go by the
    /// cosine to it, in a pattern that is turned by `turn` in [0, 1).
    float openness(Vec3f point, Vec3f normal, float turn = 0.0F) const;

  private:
    const Tracer& tracer_;
    std::vector<Lanes<float>> x_, y_;  ///< points spread over the unit disc
};

}  // namespace ink
