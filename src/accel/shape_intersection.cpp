#include "accel/shape_intersection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "accel/height_field.h"
#include "accel/polynomial.h"

namespace ink {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// A ray in the coordinates of a unit shape: o + s d with d of unit length and o its point nearest
/// to the origin. `from` is the least s that counts.
struct LocalRay {
    Vec3d o, d;
    double from;

    Vec3d at(double s) const { return o + d * s; }
};

/// A crossing of a unit shape, in its coordinates.
struct Crossing {
    double s;
    Vec3d normal;
};
using MaybeCrossing = std::optional<Crossing>;

/// The part of a ray within |x| <= reach along one axis.
struct Slab {
    double lo, hi;

    Slab(double o, double d, double reach) {
        if (d != 0.0) {
            const double a = (-reach - o) / d;
            const double b = (reach - o) / d;
            lo = std::min(a, b);
            hi = std::max(a, b);
        } else {
            const bool inside = std::abs(o) <= reach;
            lo = inside ? -kInfinite : kInfinite;
            hi = inside ? kInfinite : -kInfinite;
        }
    }
};

/// Entry and exit of a closed convex shape, of which the first that counts is seen.
MaybeCrossing first_of(const LocalRay& ray, const Crossing& entry, const Crossing& exit) {
    if (!(entry.s <= exit.s)) return std::nullopt;
    if (entry.s >= ray.from) return entry;
    if (exit.s >= ray.from) return exit;
    return std::nullopt;
}

MaybeCrossing cross_ball(const LocalRay& ray) {
    const double rest = 1.0 - dot(ray.o, ray.o);
    if (rest < 0.0) return std::nullopt;
    const double half = std::sqrt(rest);
    return first_of(ray, {-half, ray.at(-half)}, {half, ray.at(half)});
}

MaybeCrossing cross_box(const LocalRay& ray) {
    const std::array<double, 3> o{ray.o.x, ray.o.y, ray.o.z};
    const std::array<double, 3> d{ray.d.x, ray.d.y, ray.d.z};
    constexpr std::array<Vec3d, 3> kAxes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    Crossing entry{-kInfinite, {}};
    Crossing exit{kInfinite, {}};
    for (std::size_t k = 0; k < 3; ++k) {
        const Slab slab(o[k], d[k], 1.0);
        const double side = d[k] < 0.0 ? -1.0 : 1.0;
        if (slab.lo > entry.s) entry = {slab.lo, kAxes[k] * -side};
        if (slab.hi < exit.s) exit = {slab.hi, kAxes[k] * side};
    }
    return first_of(ray, entry, exit);
}

/// Between its two planes the lateral surface encloses where x^2 + y^2 - r(z)^2 < 0.
MaybeCrossing cross_frustum(const UnitShape& shape, const LocalRay& ray) {
    const auto& [o, d, from] = ray;
    constexpr double kBeyond = 4.0;  // the shape lies within sqrt(2) of the origin
    const Slab slab(o.z, d.z, 1.0);
    const double lo = std::max(slab.lo, -kBeyond);
    const double hi = std::min(slab.hi, kBeyond);
    if (!(lo < hi)) return std::nullopt;

    const double slope = 0.5 * (shape.a - 1.0);  // r(z) = middle + slope z
    const double middle = 0.5 * (1.0 + shape.a);
    const double r = middle + slope * o.z;
    const double dr = slope * d.z;
    const Polynomial<2> q{o.x * o.x + o.y * o.y - r * r, 2.0 * (o.x * d.x + o.y * d.y - r * dr),
                          d.x * d.x + d.y * d.y - dr * dr};
    const auto lateral = [&](double s) {
        const Vec3d p = ray.at(s);
        return Crossing{s, {p.x, p.y, -slope * (middle + slope * p.z)}};
    };
    const auto cap = [&](double s, double side) {
        return Crossing{s, {0.0, 0.0, d.z < 0.0 ? -side : side}};
    };
    const Roots<2> roots = real_roots<2>(q, lo, hi);
    std::array<Crossing, 4> crossings{};
    std::size_t count = 0;
    if (shape.capped && evaluate(q, lo) < 0.0) crossings[count++] = cap(lo, -1.0);
    for (std::size_t k = 0; k < roots.count; ++k) crossings[count++] = lateral(roots.x[k]);
    if (shape.capped && evaluate(q, hi) < 0.0) crossings[count++] = cap(hi, 1.0);
    for (std::size_t k = 0; k < count; ++k) {
        if (crossings[k].s >= from) return crossings[k];
    }
    return std::nullopt;
}

MaybeCrossing cross_plane(const UnitShape& shape, const LocalRay& ray) {
    if (ray.d.z == 0.0) return std::nullopt;
    const double s = -ray.o.z / ray.d.z;
    const Vec3d p = ray.at(s);
    const bool inside = shape.kind == GlyphKind::disc
                            ? p.x * p.x + p.y * p.y <= 1.0
                            : std::abs(p.x) <= 1.0 && std::abs(p.y) <= 1.0;
    if (!inside || s < ray.from) return std::nullopt;
    return Crossing{s, {0, 0, 1}};
}

/// (|p|^2 + 1 - a^2)^2 = 4 (x^2 + y^2). The linear term of |p|^2 along the ray is zero, because it
/// is counted from the point nearest to the origin.
MaybeCrossing cross_torus(const UnitShape& shape, const LocalRay& ray) {
    const auto& [o, d, from] = ray;
    const double k = dot(o, o) + 1.0 - shape.a * shape.a;
    const double reach2 = (1.0 + shape.a) * (1.0 + shape.a) - dot(o, o);
    const Slab slab(o.z, d.z, shape.a * (1.0 + 1e-9));
    if (!(reach2 > 0.0)) return std::nullopt;
    const double reach = std::sqrt(reach2) * (1.0 + 1e-9);
    const double lo = std::max(slab.lo, -reach);
    const double hi = std::min(slab.hi, reach);
    if (!(lo < hi)) return std::nullopt;
    const Polynomial<4> f{k * k - 4.0 * (o.x * o.x + o.y * o.y), -8.0 * (o.x * d.x + o.y * d.y),
                          2.0 * k - 4.0 * (d.x * d.x + d.y * d.y), 0.0, 1.0};
    const Roots<4> roots = real_roots<4>(f, lo, hi);
    for (std::size_t i = 0; i < roots.count; ++i) {
        if (roots.x[i] < from) continue;
        const Vec3d p = ray.at(roots.x[i]);
        const double w = dot(p, p) + 1.0 - shape.a * shape.a;
        return Crossing{roots.x[i], {p.x * (w - 2.0), p.y * (w - 2.0), p.z * w}};
    }
    return std::nullopt;
}

/// The norm whose unit ball a superellipsoid is, and its gradient.
struct Gauge {
    double value;
    Vec3d gradient;
};

/// The p-norm of two numbers that are not negative, and its derivatives.
struct NormOfTwo {
    double value = 0.0, du = 0.0, dv = 0.0;

    NormOfTwo(double u, double v, double p) {
        const double most = std::max(u, v);
        if (most == 0.0) return;
        const double ratio = std::min(u, v) / most;
        const double power = std::pow(ratio, p);
        const double root = std::pow(1.0 + power, 1.0 / p);
        value = most * root;
        const double d_most = root / (1.0 + power);
        const double d_least = ratio > 0.0 ? d_most * power / ratio : p == 1.0 ? 1.0 : 0.0;
        du = u >= v ? d_most : d_least;
        dv = u >= v ? d_least : d_most;
    }
};

Gauge superellipsoid_gauge(const UnitShape& shape, Vec3d p) {
    const NormOfTwo xy(std::abs(p.x), std::abs(p.y), 2.0 / shape.b);
    const NormOfTwo all(xy.value, std::abs(p.z), 2.0 / shape.a);
    return {all.value,
            {std::copysign(all.du * xy.du, p.x), std::copysign(all.du * xy.dv, p.y),
             std::copysign(all.dv, p.z)}};
}

/// A norm is convex along the ray: from outside, Newton's steps come to the crossing without ever
/// passing it, and where the norm begins to grow before it is one, there is none.
MaybeCrossing approach(const UnitShape& shape, const LocalRay& ray, double s, double end) {
    const double ahead = end > s ? 1.0 : -1.0;
    for (int k = 0; k < 200; ++k) {
        const Gauge gauge = superellipsoid_gauge(shape, ray.at(s));
        const double slope = dot(gauge.gradient, ray.d) * ahead;
        const double rest = gauge.value - 1.0;
        constexpr double kOnSurface = 1e-14;
        if (rest <= kOnSurface) return Crossing{s, gauge.gradient};
        if (slope >= 0.0) return std::nullopt;
        const double step = -rest / slope;
        if (!(step > 1e-16)) return Crossing{s, gauge.gradient};
        s += step * ahead;
        if ((end - s) * ahead < 0.0) return std::nullopt;
    }
    return std::nullopt;
}

MaybeCrossing cross_superellipsoid(const UnitShape& shape, const LocalRay& ray) {
    constexpr double kReach = 1.0 + 1e-9;
    const Slab x(ray.o.x, ray.d.x, kReach);
    const Slab y(ray.o.y, ray.d.y, kReach);
    const Slab z(ray.o.z, ray.d.z, kReach);
    const double lo = std::max({x.lo, y.lo, z.lo});
    const double hi = std::min({x.hi, y.hi, z.hi});
    if (!(lo < hi) || hi < ray.from) return std::nullopt;
    const double start = std::max(lo, ray.from);
    const bool outside = superellipsoid_gauge(shape, ray.at(start)).value > 1.0;
    return outside ? approach(shape, ray, start, hi) : approach(shape, ray, hi, start);
}

MaybeCrossing cross_height_field(const UnitShape& shape, const LocalRay& ray) {
    const Slab x(ray.o.x, ray.d.x, 1.0);
    const Slab y(ray.o.y, ray.d.y, 1.0);
    const Slab z(ray.o.z, ray.d.z, 1.0 + 1e-9);
    const double lo = std::max({x.lo, y.lo, z.lo, ray.from});
    const double hi = std::min({x.hi, y.hi, z.hi});
    if (!(lo < hi)) return std::nullopt;
    const auto s = first_on_height_field(shape, ray.o, ray.d, lo, hi);
    if (!s) return std::nullopt;
    const Vec3d p = ray.at(*s);
    const Slopes slopes = height_field_slopes(shape, p.x, p.y);
    return Crossing{*s, {-slopes.x, -slopes.y, 1.0}};
}

MaybeCrossing cross_unit_shape(const UnitShape& shape, const LocalRay& ray) {
    switch (shape.kind) {
        case GlyphKind::ellipsoid: return cross_ball(ray);
        case GlyphKind::box: return cross_box(ray);
        case GlyphKind::frustum: return cross_frustum(shape, ray);
        case GlyphKind::disc:
        case GlyphKind::rectangle: return cross_plane(shape, ray);
        case GlyphKind::torus: return cross_torus(shape, ray);
        case GlyphKind::superellipsoid: return cross_superellipsoid(shape, ray);
        case GlyphKind::gaussian:
        case GlyphKind::waves: return cross_height_field(shape, ray);
    }
    return std::nullopt;
}

}  // namespace

PlacedShape::PlacedShape(const UnitShape& shape, const Placement& placement)
    : shape_(shape), origin_(to_double(placement.origin)) {
    const Vec3d x = to_double(placement.x_axis);
    const Vec3d y = to_double(placement.y_axis);
    const Vec3d z = to_double(placement.z_axis);
    const Vec3d yz = cross(y, z);
    const double volume = dot(x, yz);
    row_x_ = yz / volume;
    row_y_ = cross(z, x) / volume;
    row_z_ = cross(x, y) / volume;
    visible_ = is_finite(row_x_) && is_finite(row_y_) && is_finite(row_z_);
}

std::optional<ShapeHit> PlacedShape::intersect(const ShapeRay& ray, double t_near,
                                               double t_far) const {
    if (!visible_) return std::nullopt;
    const auto to_local = [&](Vec3d v) {
        return Vec3d{dot(row_x_, v), dot(row_y_, v), dot(row_z_, v)};
    };
    const Vec3d from = to_local(ray.origin - origin_);
    const Vec3d along = to_local(ray.dir);
    const double rate = length(along);  // of s per t
    const Vec3d d = along / rate;
    const double s_origin = dot(from, d);  // s = s_origin + rate t
    const LocalRay local{from - d * s_origin, d, s_origin + rate * t_near};
    const MaybeCrossing crossing = cross_unit_shape(shape_, local);
    if (!crossing) return std::nullopt;
    const double t = (crossing->s - s_origin) / rate;
    if (!(t < t_far)) return std::nullopt;
    const Vec3d n = crossing->normal;
    return ShapeHit{t, row_x_ * n.x + row_y_ * n.y + row_z_ * n.z};
}

namespace {

/// Where a ray through the origin meets a triangle, in lengths of `dir`. The signs of the three
/// edges are the same from both triangles that share one (Woop et al. 2013).
std::optional<double> meet_triangle(Vec3d a, Vec3d b, Vec3d c, Vec3d dir) {
    const double u = dot(cross(b, c), dir);
    const double v = dot(cross(c, a), dir);
    const double w = dot(cross(a, b), dir);
    if (std::min({u, v, w}) < 0.0 && std::max({u, v, w}) > 0.0) return std::nullopt;
    const Vec3d normal = cross(b - a, c - a);
    const double along = dot(normal, dir);
    if (along == 0.0) return std::nullopt;
    return dot(normal, a) / along;
}

}  // namespace

std::optional<ShapeHit> intersect(const Hexahedra::Corners& corners, const ShapeRay& ray,
                                  double t_near, double t_far) {
    std::array<Vec3d, 8> p;
    for (std::size_t k = 0; k < 8; ++k) p[k] = to_double(corners[k]) - ray.origin;
    std::optional<ShapeHit> best;
    for (const auto& [a, b, c, d] : Hexahedra::kFaces) {
        for (const auto& t :
             {meet_triangle(p[a], p[b], p[c], ray.dir), meet_triangle(p[a], p[c], p[d], ray.dir)}) {
            if (!t || *t < t_near || !(*t < t_far)) continue;
            t_far = *t;
            best = ShapeHit{*t, cross(p[c] - p[a], p[d] - p[b])};
        }
    }
    return best;
}

}  // namespace ink
