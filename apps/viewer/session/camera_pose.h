#pragma once

#include "base/image.h"
#include "base/vec.h"
#include "inktrace/settings.h"

namespace inktrace::viewer {

/// A camera that a hand moves: what the settings eye, look-at, up, fov and orthographic say. The
/// point that it looks at is what it turns about. Every move returns the pose after it.
struct CameraPose {
    ink::Vec3d eye{0, 0, 1}, look_at, up{0, 1, 0};  ///< in the units of the file
    double fov_deg = 30.0;                          ///< vertical
    double height = 0.0;                            ///< of an orthographic view; 0: perspective

    /// Of settings in which all of it is written out, as by `Renderer::with_camera`.
    static CameraPose of(const Settings& settings);
    /// Writes every digit, so that the same camera is read again.
    void write(Settings& settings) const;

    bool orthographic() const { return height > 0.0; }
    ink::Vec3d back() const;   ///< unit, towards the viewer
    ink::Vec3d right() const;  ///< unit
    ink::Vec3d above() const;  ///< unit, up in the picture
    double distance() const;   ///< from the eye to the point it looks at
    /// Height of what the picture shows at the distance of the point it looks at.
    double visible_height() const;

    /// Round the point: the scene turns to the right and towards the viewer as a ball would.
    CameraPose turned(double right_deg, double down_deg) const;
    /// The picture turns clockwise.
    CameraPose rolled(double degrees) const;
    /// The scene at the distance of the point follows a hand that moves by so many pixels.
    CameraPose panned(double right_px, double down_px, int picture_height) const;
    /// Nearer (factor below 1) or farther; `fixed` stays where it is in the picture.
    CameraPose zoomed(double factor, ink::Vec3d fixed) const;
    /// Moved sideways and ahead, so that the point comes to the middle and is turned about.
    CameraPose focused(ink::Vec3d point) const;
    /// The other projection; what is at the distance of the point keeps its size.
    CameraPose with_projection(bool parallel) const;
    /// From the same direction, with all of a box in the picture, as large as there is room for.
    CameraPose framing(ink::Vec3d lower, ink::Vec3d upper, ink::Size picture) const;

    /// The point under a pixel at the distance of the point it looks at.
    ink::Vec3d under(double x, double y, ink::Size picture) const;
};

}  // namespace inktrace::viewer
