#include "sampling/stencil.h"

#include <cmath>
#include <numbers>

namespace ink {

std::vector<Vec2f> ring_stencil(float radius, int rings) {
    std::vector<Vec2f> offsets;
    for (int ring = 1; ring <= rings; ++ring) {
        const double ring_radius = static_cast<double>(radius) * ring / rings;
        for (int k = 0; k < 8 * ring; ++k) {
            const double angle = 2.0 * std::numbers::pi * k / (8.0 * ring);
            offsets.push_back({static_cast<float>(ring_radius * std::cos(angle)),
                               static_cast<float>(ring_radius * std::sin(angle))});
        }
    }
    return offsets;
}

StencilAxes stencil_axes(int rings) {
    const auto n = static_cast<std::size_t>(rings);
    const std::size_t outer = 4 * n * (n - 1);  // rays of the rings inside
    return {outer, outer + 2 * n, outer + 4 * n, outer + 6 * n};
}

std::vector<Vec2f> multisample_offsets(int samples) {
    std::vector<Vec2f> offsets;
    const int side = static_cast<int>(std::lround(std::sqrt(samples)));
    if (side * side == samples) {
        for (int j = 0; j < side; ++j) {
            for (int i = 0; i < side; ++i) {
                offsets.push_back(
                    {(static_cast<float>(i) + 0.5F) / static_cast<float>(side) - 0.5F,
                     (static_cast<float>(j) + 0.5F) / static_cast<float>(side) - 0.5F});
            }
        }
        return offsets;
    }
    constexpr double kPlastic = 1.32471795724474602596;  // the real root of x^3 = x + 1
    for (int k = 1; k <= samples; ++k) {
        const double x = std::fmod(0.5 + k / kPlastic, 1.0);
        const double y = std::fmod(0.5 + k / (kPlastic * kPlastic), 1.0);
        offsets.push_back({static_cast<float>(x - 0.5), static_cast<float>(y - 0.5)});
    }
    return offsets;
}

}  // namespace ink
