#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "lines_world.h"

/// Worlds with known lines.
namespace ink::test {

/// Two spheres that overlap, and the curves that can be seen of them.
struct TwoSpheres {
    Vec3d c, d;
    double r, s;

    World world(double unit = 1.0 / 64) const { return {{sphere(1, c, r), sphere(2, d, s)}, unit}; }
    /// Distance on screen from the projection of the circle in which the spheres meet, to first
    /// order; for centres at different depths.
    double to_seam(Vec2f p) const {
        const Vec3d a{2 * (d.x - c.x), 2 * (d.y - c.y), 2 * (d.z - c.z)};
        const double rhs = dot(d, d) - dot(c, c) - s * s + r * r;
        const double z = (rhs - a.x * p.x - a.y * p.y) / a.z;
        const Vec3d v{p.x - c.x, p.y - c.y, z - c.z};
        const double f = dot(v, v) - r * r;
        return f / std::hypot(2 * v.x - 2 * v.z * a.x / a.z, 2 * v.y - 2 * v.z * a.y / a.z);
    }
    double to_contour(Vec2f p) const {
        return std::min(std::abs(std::hypot(p.x - c.x, p.y - c.y) - r),
                        std::abs(std::hypot(p.x - d.x, p.y - d.y) - s));
    }
};

inline std::vector<TwoSpheres> overlapping_spheres() {
    std::vector<TwoSpheres> all;
    for (const double r : {5.0, 9.0, 16.0, 40.0}) {
        for (const double ratio : {0.6, 1.0}) {
            for (const double lean_deg : {10.0, 30.0, 50.0, 70.0, 80.0}) {
                const double s = r * ratio;
                const double apart = 0.75 * (r + s);
                const Vec3d c{r + 2.137, r + 2.711, 0};
                const double turned = lean_deg * 3.7 * kDegrees;
                const double aside = apart * std::sin(lean_deg * kDegrees);
                const Vec3d d{c.x + aside * std::abs(std::cos(turned)),
                              c.y + aside * std::abs(std::sin(turned)),
                              apart * std::cos(lean_deg * kDegrees)};
                all.push_back({c, d, r, s});
            }
        }
    }
    return all;
}

struct Wedge {
    World world;
    Vec3d first, second;  ///< normals
};

/// Two faces of one surface whose normals are `angle_deg` apart, in any orientation in which both
/// are seen.
inline Wedge random_wedge(double angle_deg, std::mt19937& random, double unit) {
    const auto uniform = [&] { return static_cast<double>(random() >> 8U) * 0x1p-23 - 1.0; };
    for (;;) {
        const Vec3d a = normalize(Vec3d{uniform(), uniform(), uniform()});
        const Vec3d side = normalize(cross(a, Vec3d{uniform(), uniform(), uniform()}));
        const Vec3d b = a * std::cos(angle_deg * kDegrees) + side * std::sin(angle_deg * kDegrees);
        if (a.z < 0.2 || b.z < 0.2) continue;
        const Vec3d c{24.137 + uniform(), 23.711 + uniform(), 0};
        return {{{lower(plane(1, c, a), plane(1, c, b))}, unit}, a, b};
    }
}

inline World random_spheres(unsigned seed, int spheres, double least, double most) {
    std::mt19937 random(seed);
    const auto uniform = [&] { return static_cast<double>(random() >> 8U) * 0x1p-24; };
    World world;
    for (int k = 1; k <= spheres; ++k) {
        const double x = kSide * uniform();
        const double y = kSide * uniform();
        const double z = 20 * uniform();
        world.surfaces.push_back(
            sphere(static_cast<GeometryId>(k), {x, y, z}, least + (most - least) * uniform()));
    }
    return world;
}

}  // namespace ink::test
