#pragma once

#include <cstdint>
#include <optional>

#include "sampling/samples.h"

namespace ink {

/// Where the line between two surfaces crosses a lattice edge, computed from their shapes.
struct Prediction {
    enum class Kind : std::uint8_t {
        first_contour,   ///< the first surface ends there
        second_contour,  ///< the second surface ends there
        seam,            ///< they meet there
        gap              ///< neither is there: the first has ended, the second has not begun
    };
    Kind kind;
    float at;              ///< along the edge, in [0, 1]
    float t;               ///< of the line, distance along the ray as in Sample
    float squared_radius;  ///< of the smaller ball of the two, in lengths of the edge
};

/// What lies between screen points `a` and `b`, where rays see one surface each: spheres, or on one
/// of the sides the background. Nothing if other shapes are involved. That no third surface hides
/// the crossing is for the caller to check.
std::optional<Prediction> predict_crossing(const Viewpoint& viewpoint, Vec2f a, const Sample& at_a,
                                           Vec2f b, const Sample& at_b);

/// Angle between the normals of two balls that meet at distance t along the ray through `point`,
/// radians.
float seam_angle(const Viewpoint& viewpoint, Vec2f point, float t, const Ball& a, const Ball& b);

}  // namespace ink
