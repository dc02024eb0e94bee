#pragma once

#include <cstdint>

#include "accel/tracer.h"
#include "shading/lighting.h"

namespace ink {

enum class ShadowMode : std::uint8_t {
    none,
    hard,  ///< every light as if it were a point
    soft   ///< lights of their own size; those without any get a few degrees
};

/// How much of lights points of surfaces see, by rays.
class Shadows {
  public:
    Shadows(const Tracer& tracer, ShadowMode mode) : tracer_(tracer), mode_(mode) {}

    bool any() const { return mode_ != ShadowMode::none; }
    /// Share of the light that each point sees, in [0, 1]. Of a light with a size a few rays are
    /// traced first; only where they do not agree, in the penumbra, all of them. The pattern is
    /// turned from pixel to pixel, alike in every picture of that size.
    void visible(const LightSource& light, const SurfacePacket& surface,
                 Lanes<float>& visible) const;

  private:
    const Tracer& tracer_;
    ShadowMode mode_;
};

}  // namespace ink
