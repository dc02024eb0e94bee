#include "camera/camera.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <variant>

#include "base/error.h"
#include "base/parallel.h"
#include "camera/principal_axes.h"
#include "camera/supports.h"
#include "camera/views.h"

namespace ink {

namespace {

struct Axes {
    Vec3d back, up;
};

Axes standard_axes(View view) {
    switch (view) {
        case View::back: return {{0, 0, -1}, {0, 1, 0}};
        case View::left: return {{-1, 0, 0}, {0, 1, 0}};
        case View::right: return {{1, 0, 0}, {0, 1, 0}};
        case View::top: return {{0, 1, 0}, {0, 0, -1}};
        case View::bottom: return {{0, -1, 0}, {0, 0, 1}};
        case View::iso: return {{1, 1, 1}, {0, 1, 0}};
        default: return {{0, 0, 1}, {0, 1, 0}};
    }
}

Axes automatic_axes(const Scene& scene) {
    const bool has_mesh = std::ranges::any_of(scene.objects(), [](const Object& object) {
        // Wires of a mesh without area would be seen end on.
        return std::holds_alternative<Mesh>(object.shape) || object.kind == ObjectKind::shape;
    });
    // 30 degrees to the side, 20 above: three faces of a box show, each with an area of its own.
    constexpr Axes kOblique{{0.46985, 0.34202, 0.81380}, {0, 1, 0}};
    if (has_mesh) return kOblique;
    const PrincipalAxes axes = principal_axes(scene);
    // Many particles that fill a block often lie in rows along its edges, and one who looks along
    // the rows sees nothing but their pattern.
    // From a million on rows are finer than pixels, and a corner takes ten times as long to trace.
    constexpr std::size_t kMany = 1000;
    constexpr std::size_t kDust = 1'000'000;
    const std::size_t count = scene.primitive_count();
    const bool is_block = axes.bulky && count >= kMany && count < kDust &&
                          std::ranges::all_of(scene.objects(), [](const Object& object) {
                              return object.kind == ObjectKind::particles;
                          });
    if (is_block) return kOblique;
    return {axes.shortest, axes.middle};
}

/// A vector at a right angle to `back`, near `up` where that is possible.
Vec3d upright(Vec3d back, Vec3d up) {
    Vec3d side = cross(up, back);
    if (dot(side, side) < 1e-12 * dot(up, up)) {
        side = cross(std::abs(back.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{0, 0, -1}, back);
    }
    return normalize(cross(back, normalize(side)));
}

}  // namespace

Camera::Camera(const Scene& scene, const ViewSettings& settings, Size size)
    : orthographic_(settings.orthographic.has_value()) {
    orient(scene, settings);
    place(scene, settings, size);
    lay_plane(scene, size);
    world_eye_ = scene.frame().origin + eye_ * scene.frame().unit;
}

void Camera::orient(const Scene& scene, const ViewSettings& settings) {
    Axes axes = settings.view == View::automatic && !settings.eye ? automatic_axes(scene)
                                                                  : standard_axes(settings.view);
    const Vec3d look_at = settings.look_at.value_or(scene.frame().origin);
    if (settings.eye) {
        axes = {*settings.eye - look_at, {0, 1, 0}};
        if (!(length(axes.back) > 0.0)) {
            throw UsageError("--eye and --look-at are the same point; move one of them");
        }
    }
    if (settings.up) axes.up = *settings.up;
    if (!(length(axes.up) > 0.0)) throw UsageError("--up has no length; use for example 0,1,0");
    back_ = normalize(axes.back);
    up_ = upright(back_, axes.up);
    right_ = cross(up_, back_);
}

void Camera::place(const Scene& scene, const ViewSettings& settings, Size size) {
    const double aspect = static_cast<double>(size.width) / size.height;
    const double fit = 1.0 - 2.0 * settings.margin;
    const double tan_y = std::tan(settings.fov_deg * std::numbers::pi / 360.0);
    half_height_ = orthographic_ ? *settings.orthographic * 0.5 / scene.frame().unit : tan_y;

    const auto to_scene = [&](Vec3d world) {
        return (world - scene.frame().origin) / scene.frame().unit;
    };
    if (settings.eye && (!orthographic_ || half_height_ > 0.0)) {
        eye_ = to_scene(*settings.eye);
        return;
    }

    // The four planes through the eye that bound the picture less its margin must have the whole
    // scene on their inner side; `reach` says how near each can come. In orthographic projection
    // the planes are parallel in pairs.
    const double fit_left = fit_beside(settings.left_taken, settings.margin);
    const double fit_right = fit_beside(settings.right_taken, settings.margin);
    const double slope = orthographic_ ? 0.0 : tan_y;
    const double slope_left = slope * aspect * fit_left;
    const double slope_right = slope * aspect * fit_right;
    const double slope_y = slope * fit;
    const double norm_left = std::hypot(1.0, slope_left);
    const double norm_right = std::hypot(1.0, slope_right);
    const double norm_y = std::hypot(1.0, slope_y);
    const std::array<Vec3f, 4> normals{to_float((right_ - back_ * slope_left) / norm_left),
                                       to_float((-right_ - back_ * slope_right) / norm_right),
                                       to_float((up_ - back_ * slope_y) / norm_y),
                                       to_float((-up_ - back_ * slope_y) / norm_y)};
    const std::array<double, 4> reach = supports(scene, normals);
    const double left = reach[0] * norm_left;
    const double right = reach[1] * norm_right;
    double x = (left - right) * 0.5;
    const double y = (reach[2] - reach[3]) * norm_y * 0.5;
    double z = 0.0;
    if (orthographic_) {
        const double needed = std::max(-(reach[2] + reach[3]) * 0.5 / fit,
                                       -(left + right) / (fit_left + fit_right) / aspect);
        if (!(half_height_ > 0.0)) half_height_ = needed > 0.0 ? needed : 1.0;
        x += (fit_left - fit_right) * 0.5 * half_height_ * aspect;
        z = 2.0;
    } else {
        z = std::max(-(left + right) / (slope_left + slope_right),
                     -(reach[2] + reach[3]) * norm_y / (2.0 * slope_y));
        x += (slope_left - slope_right) * 0.5 * z;
    }
    eye_ = right_ * x + up_ * y + back_ * z;
    if (settings.look_at) {
        const Vec3d target = to_scene(*settings.look_at);
        eye_ = target + back_ * std::max(dot(eye_ - target, back_), 1e-3);
    }
    if (settings.eye) eye_ = to_scene(*settings.eye);
}

void Camera::lay_plane(const Scene& scene, Size size) {
    const double pixel = 2.0 * half_height_ / size.height;
    const Vec3d step_x = right_ * pixel;
    const Vec3d step_y = up_ * -pixel;
    const Vec3d to_corner = step_x * (-0.5 * size.width) + step_y * (-0.5 * size.height);

    double nearest = std::numeric_limits<double>::max();
    for (int k = 0; k < 8; ++k) {
        nearest = std::min(nearest, -dot(to_double(scene.bounds().corner(k)) - eye_, back_));
    }
    // A hair before the scene, so that no surface starts behind its ray.
    start_depth_ = nearest - 1e-3;
    if (!orthographic_) start_depth_ = std::max(start_depth_, 0.0);

    const Vec3d ahead = eye_ - back_ * start_depth_;
    if (orthographic_) {
        field_.origin = to_float(ahead + to_corner);
        field_.origin_dx = to_float(step_x);
        field_.origin_dy = to_float(step_y);
        field_.dir = to_float(-back_);
    } else {
        field_.origin = to_float(ahead + to_corner * start_depth_);
        field_.origin_dx = to_float(step_x * start_depth_);
        field_.origin_dy = to_float(step_y * start_depth_);
        field_.dir = to_float(to_corner - back_);
        field_.dir_dx = to_float(step_x);
        field_.dir_dy = to_float(step_y);
    }

    projection_ = {
        .right = right_,
        .down = -up_,
        .forward = -back_,
        .start = ahead,
        .start_depth = orthographic_ ? 0.0 : start_depth_,
        .centre = {0.5F * static_cast<float>(size.width), 0.5F * static_cast<float>(size.height)},
        .origin_step = orthographic_ ? pixel : pixel * start_depth_,
        .slope_step = orthographic_ ? 0.0 : pixel};

    constexpr float kMax = std::numeric_limits<float>::max();
    scene_box_ = {kMax, kMax, -kMax, -kMax};
    for (int k = 0; k < 8; ++k) {
        const Vec3d p = to_double(scene.bounds().corner(k)) - eye_;
        const double depth = -dot(p, back_);
        if (!orthographic_ && depth < 1e-6) {  // beside or behind the eye: anywhere on the screen
            scene_box_ = {-kMax, -kMax, kMax, kMax};
            return;
        }
        const double scale = 1.0 / (orthographic_ ? pixel : pixel * depth);
        const auto x = static_cast<float>(0.5 * size.width + dot(p, right_) * scale);
        const auto y = static_cast<float>(0.5 * size.height - dot(p, up_) * scale);
        scene_box_ = {std::min(scene_box_.left, x - 1), std::min(scene_box_.top, y - 1),
                      std::max(scene_box_.right, x + 1), std::max(scene_box_.bottom, y + 1)};
    }
}

float Camera::least_footprint() const {
    return length(orthographic_ ? field_.origin_dx
                                : field_.dir_dx * static_cast<float>(start_depth_));
}

float Camera::distance_from_eye(Vec2f point, float t) const {
    const Vec3f d = field_.dir + field_.dir_dx * point.x + field_.dir_dy * point.y;
    return t + static_cast<float>(start_depth_) * length(d);
}

}  // namespace ink
