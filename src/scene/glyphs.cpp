#include "scene/glyphs.h"

#include <algorithm>
#include <cmath>

namespace ink {

namespace {

/// Two unit vectors at right angles to a unit vector and to each other; the three are right-handed.
std::array<Vec3d, 2> across(Vec3d axis) {
    const Vec3d other = std::abs(axis.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d x = normalize(cross(other, axis));
    return {x, cross(axis, x)};
}

/// The norm that is dual to the p-norm of two numbers, p = 2 / roundness: the q-norm with
/// 1/p + 1/q = 1.
double dual_norm(double u, double v, double roundness) {
    const double most = std::max(std::abs(u), std::abs(v));
    const double p = 2.0 / roundness;
    if (most == 0.0 || p <= 1.0) return most;
    const double q = p / (p - 1.0);
    return most *
           std::pow(std::pow(std::abs(u) / most, q) + std::pow(std::abs(v) / most, q), 1.0 / q);
}

float below(double value) {
    return std::nextafter(static_cast<float>(value), -std::numeric_limits<float>::infinity());
}
float above(double value) {
    return std::nextafter(static_cast<float>(value), std::numeric_limits<float>::infinity());
}

}  // namespace

Placement moved(const Placement& placement, const Motion& motion) {
    const auto turned = [&](Vec3f axis) { return to_float(motion.turn(to_double(axis))); };
    return {turned(placement.x_axis), turned(placement.y_axis), turned(placement.z_axis),
            motion(placement.origin)};
}

bool has_volume(const Placement& placement) {
    constexpr double kThinnest = 3e-6;
    const std::array<Vec3d, 3> axes{to_double(placement.x_axis), to_double(placement.y_axis),
                                    to_double(placement.z_axis)};
    double longest = 0.0;
    double widest = 0.0;  // the largest face of the parallelepiped
    for (std::size_t k = 0; k < 3; ++k) {
        longest = std::max(longest, length(axes[k]));
        widest = std::max(widest, length(cross(axes[k], axes[(k + 1) % 3])));
    }
    // Its height over that face, against the width of the face. A needle is as high as it is wide.
    const double volume = std::abs(dot(axes[0], cross(axes[1], axes[2])));
    return volume * longest > kThinnest * widest * widest;
}

Placement placement_between(Vec3d from, Vec3d to, double radius) {
    const Vec3d half = (to - from) * 0.5;
    const auto [x, y] = across(normalize(half));
    return {to_float(x * radius), to_float(y * radius), to_float(half),
            to_float((from + to) * 0.5)};
}

Placement placement_about(Vec3d centre, Vec3d axis, double size) {
    const Vec3d z = normalize(axis);
    const auto [x, y] = across(z);
    return {to_float(x * size), to_float(y * size), to_float(z * size), to_float(centre)};
}

double support(const UnitShape& shape, Vec3d d) {
    const double about_z = std::hypot(d.x, d.y);
    const double square = std::abs(d.x) + std::abs(d.y);
    switch (shape.kind) {
        case GlyphKind::ellipsoid: return length(d);
        case GlyphKind::box: return square + std::abs(d.z);
        case GlyphKind::frustum: return std::max(about_z - d.z, shape.a * about_z + d.z);
        case GlyphKind::disc: return about_z;
        case GlyphKind::rectangle: return square;
        case GlyphKind::torus: return about_z + shape.a * length(d);
        case GlyphKind::superellipsoid:
            return dual_norm(dual_norm(d.x, d.y, shape.b), d.z, shape.a);
        case GlyphKind::gaussian: return square + std::max(d.z, 0.0);
        case GlyphKind::waves: return square + std::abs(d.z);
    }
    return 0.0;
}

double support(const UnitShape& shape, const Placement& placement, Vec3d d) {
    const Vec3d local{dot(to_double(placement.x_axis), d), dot(to_double(placement.y_axis), d),
                      dot(to_double(placement.z_axis), d)};
    return dot(to_double(placement.origin), d) + support(shape, local);
}

Bounds3f glyph_bounds(const UnitShape& shape, const Placement& placement) {
    const auto reach = [&](Vec3d d) { return support(shape, placement, d); };
    const Vec3d lower{-reach({-1, 0, 0}), -reach({0, -1, 0}), -reach({0, 0, -1})};
    const Vec3d upper{reach({1, 0, 0}), reach({0, 1, 0}), reach({0, 0, 1})};
    Bounds3f box;
    if (!is_finite(lower) || !is_finite(upper)) return box;
    box.lower = {below(lower.x), below(lower.y), below(lower.z)};
    box.upper = {above(upper.x), above(upper.y), above(upper.z)};
    return box;
}

Bounds3f hexahedron_bounds(const Hexahedra::Corners& corners) {
    Bounds3f box;
    for (const Vec3f& corner : corners) {
        if (!is_finite(corner)) return {};
        box.add(corner);
    }
    return box;
}

}  // namespace ink
