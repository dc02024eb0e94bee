#pragma once

#include "base/color.h"

namespace ink {

/// How a surface answers light. Shares are in [0, 1].
struct Material {
    Rgb8 color{204, 204, 204};  ///< diffuse, where primitives bring no colour of their own
    float specular = 0.0F;      ///< strength of highlights: 1 is as bright as the light itself
    float roughness = 0.35F;    ///< width of highlights; [0.02, 1]
    float metal = 0.0F;         ///< share that reflects in its own colour instead of scattering
    float mirror = 0.0F;        ///< share that is reflected as by a mirror, [0, 1]
    float transparency = 0.0F;  ///< share of the rest that goes through, [0, 1]
    float ior = 1.0F;           ///< index of refraction; 1: light goes through unbent, [1, 4]

    /// Whether rays go on where they meet it.
    bool is_specular() const { return mirror > 0.0F || transparency > 0.0F; }
    friend bool operator==(const Material&, const Material&) = default;
};

inline constexpr double kLeastRoughness = 0.02;  ///< a highlight of a few pixels

}  // namespace ink
