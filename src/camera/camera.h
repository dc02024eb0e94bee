#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "accel/tracer.h"
#include "base/image.h"
#include "base/lanes.h"
#include "base/multiversion.h"
#include "base/vec.h"
#include "scene/scene.h"

namespace ink {

/// From where the scene is seen. `automatic` looks at molecules and particles along their shortest
/// principal axis, so that they show their broad side, and at everything else from a little above
/// and to the side.
enum class View : std::uint8_t { automatic, front, back, left, right, top, bottom, iso };

/// Where the camera stands. What is left open is chosen so that the scene fills the picture.
struct ViewSettings {
    View view = View::automatic;
    std::optional<Vec3d> eye;      ///< world
    std::optional<Vec3d> look_at;  ///< world; default: the middle of the scene
    std::optional<Vec3d> up;       ///< world direction
    double fov_deg = 30.0;         ///< vertical field of view, in (0, 170]
    /// Orthographic projection: height of the view in world units; 0: fitted to the scene.
    std::optional<double> orthographic;
    double margin = 0.04;  ///< of the picture's height and width left free on each side, [0, 0.45]
    /// Of the picture's width taken by a legend on either side, which the scene stays clear of where
    /// it is framed automatically; [0, 0.4].
    double left_taken = 0.0, right_taken = 0.0;
};

/// Turns screen points into rays. Rays start on a plane just before the scene, not at the eye: the
/// origins are then small numbers, and a scene seen from very far keeps all its digits.
class Camera {
  public:
    /// Throws UsageError where the settings contradict each other.
    Camera(const Scene& scene, const ViewSettings& settings, Size size);

    /// Rays through sixteen points of the screen, in pixels. Directions have unit length.
    INKTRACE_INLINE void make_rays(const Lanes<float>& x, const Lanes<float>& y,
                                   RayPacket& rays) const;
    /// Distance from the eye (perspective) or the camera plane (orthographic) of a hit at `t` along
    /// the ray through a screen point.
    float distance_from_eye(Vec2f point, float t) const;

    /// The same for hits of a packet of camera rays. Infinite on a miss.
    INKTRACE_INLINE void distances_from_eye(const PointPacket& points, const Lanes<float>& t,
                                            Lanes<float>& distances) const;

    Vec3f right() const { return to_float(right_); }  ///< unit, scene frame
    Vec3f up() const { return to_float(up_); }        ///< unit, scene frame
    Vec3f back() const { return to_float(back_); }    ///< unit, towards the viewer

    /// Distance between the rays of neighbouring pixels where it is least: in orthographic
    /// projection anywhere, else where the scene begins. Scene units.
    float least_footprint() const;
    bool orthographic() const { return orthographic_; }
    Vec3f eye() const { return to_float(eye_); }  ///< scene frame

    /// Rays before their directions are normalised: the one through screen point (x, y) starts at
    /// origin + x origin_dx + y origin_dy; directions likewise.
    struct RayField {
        Vec3f origin, origin_dx, origin_dy;
        Vec3f dir, dir_dx, dir_dy;
    };
    const RayField& ray_field() const { return field_; }

    /// The same rays, for tracers.
    const Projection& projection() const { return projection_; }

    /// The part of the screen outside of which no ray can hit the scene.
    const ScreenBox& scene_box() const { return scene_box_; }

    /// Of the view: the tangent of half the field of view, or orthographic in scene units.
    double half_height() const { return half_height_; }
    Vec3d world_eye() const { return world_eye_; }

  private:
    struct Basis;
    void orient(const Scene& scene, const ViewSettings& settings);
    void place(const Scene& scene, const ViewSettings& settings, Size size);
    void lay_plane(const Scene& scene, Size size);

    Vec3d right_, up_, back_;  ///< right-handed, orthonormal, scene frame
    Vec3d eye_;                ///< scene frame
    bool orthographic_ = false;
    double half_height_ = 0.0;  ///< of the view: tan(fov / 2), or scene units
    double start_depth_ = 0.0;  ///< of the plane that rays start on, along -back

    RayField field_;
    Projection projection_;
    ScreenBox scene_box_{};
    Vec3d world_eye_;
};

void Camera::make_rays(const Lanes<float>& x, const Lanes<float>& y, RayPacket& rays) const {
    const RayField field = field_;  // nothing that the loop writes can change it
    for (int i = 0; i < kLanes; ++i) {
        rays.origin_x[i] = field.origin.x + x[i] * field.origin_dx.x + y[i] * field.origin_dy.x;
        rays.origin_y[i] = field.origin.y + x[i] * field.origin_dx.y + y[i] * field.origin_dy.y;
        rays.origin_z[i] = field.origin.z + x[i] * field.origin_dx.z + y[i] * field.origin_dy.z;
        const float dx = field.dir.x + x[i] * field.dir_dx.x + y[i] * field.dir_dy.x;
        const float dy = field.dir.y + x[i] * field.dir_dx.y + y[i] * field.dir_dy.y;
        const float dz = field.dir.z + x[i] * field.dir_dx.z + y[i] * field.dir_dy.z;
        const float scale = 1.0F / std::sqrt(dx * dx + dy * dy + dz * dz);
        rays.dir_x[i] = dx * scale;
        rays.dir_y[i] = dy * scale;
        rays.dir_z[i] = dz * scale;
    }
}

void Camera::distances_from_eye(const PointPacket& points, const Lanes<float>& t,
                                Lanes<float>& distances) const {
    const auto depth = static_cast<float>(start_depth_);
    const auto step = static_cast<float>(projection_.slope_step);
    const Vec2f centre = projection_.centre;
    for (int i = 0; i < kLanes; ++i) {
        const float x = (points.x[i] - centre.x) * step;
        const float y = (points.y[i] - centre.y) * step;
        distances[i] = t[i] + depth * std::sqrt(1.0F + x * x + y * y);
    }
}

}  // namespace ink
