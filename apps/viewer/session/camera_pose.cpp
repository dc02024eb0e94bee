#include "session/camera_pose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/text.h"

namespace inktrace::viewer {

using ink::Vec3d;

namespace {

Vec3d read_vector(const std::string& text) {
    const auto parts = ink::split(text, ',');
    if (parts.size() != 3) return {};
    return {ink::parse_double(parts[0]).value_or(0.0), ink::parse_double(parts[1]).value_or(0.0),
            ink::parse_double(parts[2]).value_or(0.0)};
}

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

/// Rodrigues' rotation about a unit axis.
Vec3d rotated(Vec3d v, Vec3d axis, double angle) {
    const double c = std::cos(angle);
    return v * c + cross(axis, v) * std::sin(angle) + axis * (dot(axis, v) * (1.0 - c));
}

}  // namespace

CameraPose CameraPose::of(const Settings& settings) {
    CameraPose pose;
    pose.eye = read_vector(settings.get("eye"));
    pose.look_at = read_vector(settings.get("look-at"));
    pose.up = read_vector(settings.get("up"));
    pose.fov_deg = ink::parse_double(settings.get("fov")).value_or(30.0);
    pose.height = ink::parse_double(settings.get("orthographic")).value_or(0.0);
    return pose;
}

void CameraPose::write(Settings& settings) const {
    const auto text = [](Vec3d v) { return fmt::format("{},{},{}", v.x, v.y, v.z); };
    settings.set("eye", text(eye)).set("look-at", text(look_at)).set("up", text(up));
    settings.set("orthographic", orthographic() ? fmt::format("{}", height) : "");
}

Vec3d CameraPose::back() const { return normalize(eye - look_at); }

Vec3d CameraPose::right() const {
    const Vec3d axis = cross(up, back());
    if (length(axis) > 1e-9 * length(up)) return normalize(axis);
    // Up runs along the line of sight: any direction will do.
    const Vec3d other = std::abs(back().x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    return normalize(cross(other, back()));
}

Vec3d CameraPose::above() const { return cross(back(), right()); }

double CameraPose::distance() const { return length(eye - look_at); }

double CameraPose::visible_height() const {
    return orthographic() ? height : 2.0 * distance() * std::tan(radians(fov_deg) / 2.0);
}

CameraPose CameraPose::turned(double right_deg, double down_deg) const {
    const Vec3d vertical = above();
    const Vec3d horizontal = right();
    const auto turn = [&](Vec3d v) {
        return rotated(rotated(v, vertical, -radians(right_deg)), horizontal, -radians(down_deg));
    };
    CameraPose pose = *this;
    pose.eye = look_at + turn(eye - look_at);
    pose.up = turn(vertical);
    return pose;
}

CameraPose CameraPose::rolled(double degrees) const {
    CameraPose pose = *this;
    pose.up = rotated(above(), back(), radians(degrees));
    return pose;
}

CameraPose CameraPose::panned(double right_px, double down_px, int picture_height) const {
    const double pixel = visible_height() / std::max(picture_height, 1);
    const Vec3d shift = right() * (-right_px * pixel) + above() * (down_px * pixel);
    CameraPose pose = *this;
    pose.eye = eye + shift;
    pose.look_at = look_at + shift;
    return pose;
}

CameraPose CameraPose::zoomed(double factor, Vec3d fixed) const {
    CameraPose pose = *this;
    pose.eye = fixed + (eye - fixed) * factor;
    pose.look_at = fixed + (look_at - fixed) * factor;
    pose.height = height * factor;
    return pose;
}

CameraPose CameraPose::focused(Vec3d point) const {
    CameraPose pose = *this;
    pose.eye = eye + (point - look_at);
    pose.look_at = point;
    return pose;
}

CameraPose CameraPose::with_projection(bool parallel) const {
    CameraPose pose = *this;
    if (parallel == orthographic()) return pose;
    if (parallel) {
        pose.height = visible_height();
        return pose;
    }
    pose.height = 0.0;
    pose.eye = look_at + back() * (height / (2.0 * std::tan(radians(fov_deg) / 2.0)));
    return pose;
}

CameraPose CameraPose::framing(Vec3d lower, Vec3d upper, ink::Size picture) const {
    constexpr double kMargin = 1.02;
    const double aspect = static_cast<double>(picture.width) / picture.height;
    const double slope = std::tan(radians(fov_deg) / 2.0) / kMargin;
    CameraPose pose = *this;
    pose.look_at = (lower + upper) * 0.5;
    const Vec3d half = (upper - lower) * 0.5;
    double away = 0.0;
    double half_height = 0.0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const Vec3d p{(corner & 1U) != 0 ? half.x : -half.x, (corner & 2U) != 0 ? half.y : -half.y,
                      (corner & 4U) != 0 ? half.z : -half.z};
        const double reach =
            std::max(std::abs(dot(p, above())), std::abs(dot(p, right())) / aspect);
        half_height = std::max(half_height, reach);
        away = std::max(away, dot(p, back()) + reach / slope);
    }
    if (half_height <= 0.0) return focused(pose.look_at);
    if (orthographic()) {
        pose.height = 2.0 * kMargin * half_height;
        away = std::max(distance(), 2.0 * length(half));
    }
    pose.eye = pose.look_at + back() * away;
    return pose;
}

Vec3d CameraPose::under(double x, double y, ink::Size picture) const {
    const double pixel = visible_height() / std::max(picture.height, 1);
    return look_at + right() * ((x - 0.5 * picture.width) * pixel) +
           above() * ((0.5 * picture.height - y) * pixel);
}

}  // namespace inktrace::viewer
