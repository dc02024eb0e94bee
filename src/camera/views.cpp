#include "camera/views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "camera/supports.h"

namespace ink {

namespace {

/// The cylinder about an axis through the scene's middle that holds the scene.
struct Drum {
    double radius = 0.0;
    double half_height = 0.0;
};

Drum drum_about(const Scene& scene, Vec3d right, Vec3d up, Vec3d back) {
    // The farthest point from the axis is as far as the scene reaches in some direction; of 64, one
    // is within 3 degrees of it.
    constexpr int kDirections = 64;
    constexpr double kMissed = 1.0012;  // 1 / cos(180 / 64 degrees)
    Drum drum;
    for (int k = 0; k < kDirections; k += 4) {
        std::array<Vec3f, 4> normals;
        for (int j = 0; j < 4; ++j) {
            const double angle = 2.0 * std::numbers::pi * (k + j) / kDirections;
            normals[static_cast<std::size_t>(j)] =
                to_float(right * std::cos(angle) + back * std::sin(angle));
        }
        for (const double least : supports(scene, normals)) {
            drum.radius = std::max(drum.radius, -least * kMissed);
        }
    }
    const Vec3f u = to_float(up);
    const std::array<double, 4> ends = supports(scene, {u, -u, u, -u});
    drum.half_height = std::max(-ends[0], -ends[1]);
    return drum;
}

}  // namespace

double fit_beside(double taken, double margin) {
    constexpr double kLeast = 0.05;
    return std::max(1.0 - 2.0 * (taken + margin), kLeast);
}

ViewSettings explicit_view(const Camera& camera, const Scene& scene, const ViewSettings& settings) {
    ViewSettings view = settings;
    const Vec3d back = to_double(camera.back());
    // Where the line of sight passes the middle of the scene, or a little ahead of the eye.
    const double depth = dot(camera.world_eye() - scene.frame().origin, back);
    view.eye = camera.world_eye();
    view.look_at = camera.world_eye() - back * (depth > 0.0 ? depth : scene.frame().unit);
    view.up = to_double(camera.up());
    if (camera.orthographic()) view.orthographic = 2.0 * camera.half_height() * scene.frame().unit;
    return view;
}

ViewSettings turntable_view(const Scene& scene, const ViewSettings& settings, Size size,
                            double turn_deg) {
    const Camera camera(scene, settings, size);
    const Vec3d right = to_double(camera.right());
    const Vec3d up = to_double(camera.up());
    const Vec3d back = to_double(camera.back());
    const Drum drum = drum_about(scene, right, up, back);
    const double aspect = static_cast<double>(size.width) / size.height;
    const double fit = 1.0 - 2.0 * settings.margin;
    const double fit_left = fit_beside(settings.left_taken, settings.margin);
    const double fit_right = fit_beside(settings.right_taken, settings.margin);

    ViewSettings view = settings;
    double distance = 2.0;
    double aside = 0.0;  // of the eye, to the right: what a legend leaves may lie off the middle
    if (camera.orthographic()) {
        const double fit_across = 0.5 * (fit_left + fit_right);
        double half = camera.half_height();
        if (!(*settings.orthographic > 0.0)) {
            half = std::max(drum.half_height / fit, drum.radius / (aspect * fit_across));
            view.orthographic = 2.0 * half * scene.frame().unit;
        }
        aside = 0.5 * (fit_left - fit_right) * half * aspect;
    } else {
        // The drum between the four planes through the eye that bound its part of the picture.
        const double slope_y = camera.half_height() * fit;
        const double slope_left = camera.half_height() * aspect * fit_left;
        const double slope_right = camera.half_height() * aspect * fit_right;
        const double reach_left = drum.radius * std::hypot(1.0, slope_left);
        const double reach_right = drum.radius * std::hypot(1.0, slope_right);
        const double by_width = (reach_left + reach_right) / (slope_left + slope_right);
        const double by_height = drum.radius + drum.half_height / slope_y;
        distance = std::max(by_width, by_height);
        aside = 0.5 * ((slope_left - slope_right) * distance - (reach_left - reach_right));
    }
    const double turn = turn_deg * std::numbers::pi / 180.0;
    const Vec3d towards = back * std::cos(turn) + right * std::sin(turn);
    const Vec3d across = right * std::cos(turn) - back * std::sin(turn);
    const Vec3d middle = scene.frame().origin + across * (aside * scene.frame().unit);
    view.look_at = middle;
    view.eye = middle + towards * (distance * scene.frame().unit);
    view.up = up;
    return view;
}

}  // namespace ink
