#pragma once

#include "base/vec.h"

namespace ink {

/// The rays of a camera as numbers. The ray through the screen point p (pixels), with
/// q = p - centre, starts at start + (right q.x + down q.y) * origin_step, on a plane before the
/// scene, and runs along forward + (right q.x + down q.y) * slope_step.
struct Projection {
    Vec3d right, down, forward;  ///< unit, at right angles, scene frame
    Vec3d start;                 ///< where the axis meets that plane, scene frame
    double start_depth = 0.0;    ///< of the plane, from the eye; perspective only
    Vec2f centre;                ///< the axis on the screen, pixels
    double origin_step = 0.0;    ///< scene units a pixel
    double slope_step = 0.0;     ///< a pixel; 0: orthographic

    bool orthographic() const { return slope_step == 0.0; }
    /// Whether the whole scene lies before the eye.
    bool sees_all() const { return orthographic() || start_depth > 0.0; }
};

}  // namespace ink
