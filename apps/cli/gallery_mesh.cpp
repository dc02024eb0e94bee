#include "gallery_mesh.h"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace inktrace::cli {

void add_knot(Scene& scene) {
    constexpr std::uint32_t kAround = 110;
    constexpr std::uint32_t kSides = 14;
    constexpr double kTurn = 2.0 * std::numbers::pi;
    struct Point {
        double x, y, z;
    };
    const auto knot = [](double s) {
        const double r = 2.0 + std::cos(3.0 * s);
        return Point{r * std::cos(2.0 * s), r * std::sin(2.0 * s), std::sin(3.0 * s)};
    };
    const auto unit = [](Point p) {
        const double size = std::hypot(p.x, p.y, p.z);
        return Point{p.x / size, p.y / size, p.z / size};
    };
    const auto cross = [](Point a, Point b) {
        return Point{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    };
    std::vector<float> vertices;
    std::vector<std::uint32_t> triangles;
    for (std::uint32_t i = 0; i < kAround; ++i) {
        const double s = kTurn * i / kAround;
        const Point at = knot(s);
        const Point ahead = knot(s + 1e-4);
        const Point along = unit({ahead.x - at.x, ahead.y - at.y, ahead.z - at.z});
        const Point side = unit(cross(along, {at.x, at.y, 0.0}));
        const Point up = cross(side, along);
        for (std::uint32_t j = 0; j < kSides; ++j) {
            const double c = 0.42 * std::cos(kTurn * j / kSides);
            const double d = 0.42 * std::sin(kTurn * j / kSides);
            vertices.insert(vertices.end(), {static_cast<float>(at.x + c * side.x + d * up.x),
                                             static_cast<float>(at.y + c * side.y + d * up.y),
                                             static_cast<float>(at.z + c * side.z + d * up.z)});
            const std::uint32_t next = (i + 1) % kAround * kSides;
            const std::uint32_t a = i * kSides + j;
            const std::uint32_t b = i * kSides + (j + 1) % kSides;
            triangles.insert(triangles.end(),
                             {a, next + j, b, b, next + j, next + (j + 1) % kSides});
        }
    }
    scene.add_mesh("knot", vertices, triangles, {154, 182, 216});
}

}  // namespace inktrace::cli
