#include "lines/parabola.h"

#include <array>

namespace ink {

double Parabola::curvature() const {
    const double speed = length(tangent);
    return speed > 0.0 ? 2.0 * cross(tangent, bend) / (speed * speed * speed) : 0.0;
}

Parabola fit_parabola(std::span<const LinePoint> points) {
    if (points.size() == 2) {
        const auto [s1, p1] = points[0];
        const auto [s2, p2] = points[1];
        const Vec2d tangent = (p2 - p1) * (1.0 / (s2 - s1));
        return {p1 - tangent * s1, tangent, {}};
    }
    // Normal equations in the moments of s, solved by Cramer's rule.
    std::array<double, 5> moment{};
    std::array<Vec2d, 3> sum{};
    for (const auto& [s, point] : points) {
        double power = 1.0;
        for (std::size_t k = 0; k < 5; ++k, power *= s) {
            moment[k] += power;
            if (k < 3) sum[k] = sum[k] + point * power;
        }
    }
    const auto [m0, m1, m2, m3, m4] = moment;
    const double c00 = m2 * m4 - m3 * m3;
    const double c01 = m2 * m3 - m1 * m4;
    const double c02 = m1 * m3 - m2 * m2;
    const double c11 = m0 * m4 - m2 * m2;
    const double c12 = m1 * m2 - m0 * m3;
    const double c22 = m0 * m2 - m1 * m1;
    const double scale = 1.0 / (m0 * c00 + m1 * c01 + m2 * c02);
    return {(sum[0] * c00 + sum[1] * c01 + sum[2] * c02) * scale,
            (sum[0] * c01 + sum[1] * c11 + sum[2] * c12) * scale,
            (sum[0] * c02 + sum[1] * c12 + sum[2] * c22) * scale};
}

}  // namespace ink
