#include "shading/sky_directions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ink {

namespace {

/// Half of the spherical Fibonacci lattice (Gonzalez 2010), and the points opposite to it.
std::vector<Vec3f> spread(int count) {
    std::vector<Vec3f> points;
    for (int k = 0; 2 * k < count; ++k) {
        const double z = 1.0 - (2.0 * k + 1.0) / count;
        const double turn = 2.0 * std::numbers::pi * k / std::numbers::phi;
        const double radius = std::sqrt(1.0 - z * z);
        points.push_back(to_float(Vec3d{radius * std::cos(turn), radius * std::sin(turn), z}));
        points.push_back(-points.back());
    }
    return points;
}

SkyDirections::Group make_group(std::span<const Vec3f> points, float spacing) {
    SkyDirections::Group group{};
    Vec3f sum;
    for (int i = 0; i < kLanes; ++i) {
        const Vec3f p = points[static_cast<std::size_t>(i)];
        group.x[i] = p.x;
        group.y[i] = p.y;
        group.z[i] = p.z;
        sum = sum + p;
    }
    group.axis = normalize(sum);
    float least = 1.0F;
    for (const Vec3f p : points) least = std::min(least, dot(p, group.axis));
    const float angle = std::acos(least) + 1e-3F;
    group.cos = std::cos(angle);
    group.sin = std::sin(angle);
    group.wide_cos = std::cos(angle + 0.5F * spacing);
    group.wide_sin = std::sin(angle + 0.5F * spacing);
    return group;
}

}  // namespace

SkyDirections::SkyDirections(int count)
    : spacing(std::sqrt(4.0F * std::numbers::pi_v<float> / static_cast<float>(count * kLanes))) {
    std::vector<Vec3f> points = spread(count * kLanes);
    sort_into_groups(points);
    for (std::size_t k = 0; k < points.size(); k += kLanes) {
        groups.push_back(make_group(std::span(points).subspan(k, kLanes), spacing));
    }
    for (std::size_t k = 0; k < groups.size(); k += kLanes) {
        Axes& packet = axes.emplace_back();
        for (int i = 0; i < kLanes; ++i) {
            const std::size_t g = std::min(k + static_cast<std::size_t>(i), groups.size() - 1);
            packet.x[i] = groups[g].axis.x;
            packet.y[i] = groups[g].axis.y;
            packet.z[i] = groups[g].axis.z;
            packet.sin[i] = groups[g].sin;
            packet.wide_cos[i] = groups[g].wide_cos;
            packet.wide_sin[i] = groups[g].wide_sin;
        }
    }
}

// Halves the groups along the axis on which they reach farthest, again and again.
void sort_into_groups(std::span<Vec3f> points) {
    if (points.size() <= kLanes) return;
    float Vec3f::*widest = &Vec3f::x;
    float most = -1.0F;
    for (float Vec3f::*axis : {&Vec3f::x, &Vec3f::y, &Vec3f::z}) {
        const auto [low, high] = std::ranges::minmax(points, {}, axis);
        if (high.*axis - low.*axis <= most) continue;
        most = high.*axis - low.*axis;
        widest = axis;
    }
    std::ranges::sort(points, {}, widest);
    const std::size_t half = points.size() / kLanes / 2 * kLanes;
    sort_into_groups(points.first(half));
    sort_into_groups(points.subspan(half));
}

void make_basis(Vec3f n, Vec3f& tangent, Vec3f& bitangent) {
    const float sign = std::copysign(1.0F, n.z);
    const float a = -1.0F / (sign + n.z);
    const float b = n.x * n.y * a;
    tangent = {1.0F + sign * n.x * n.x * a, sign * b, -sign * n.x};
    bitangent = {b, sign + n.y * n.y * a, -n.y};
}

}  // namespace ink
