#pragma once

#include <memory>

#include "accel/tracer.h"
#include "base/lanes.h"
#include "shading/lighting.h"

namespace ink {

/// How far points of surfaces lie open to a sky all around: the share of directions above the
/// surface, weighted by the cosine to its normal, into which no part of the scene is seen. In
/// [0, 1]. Safe to use from many threads.
class AmbientOcclusion {
  public:
    virtual ~AmbientOcclusion() = default;
    virtual void openness(const SurfacePacket& surface, Lanes<float>& open) const = 0;
};

}  // namespace ink
