#include "accel/screen_packets.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/multiversion.h"

namespace ink {

namespace {

/// Bounds grow by this much, pixels, which is more than positions are rounded by.
constexpr float kSlack = 1e-2F;
/// Likewise for depths; the scene reaches over 2.
constexpr float kDepthSlack = 1e-5F;

/// What the loops below need of a projection. They take it by value, so that nothing they write can
/// change it.
struct Basis {
    double rx, ry, rz, dx, dy, dz, fx, fy, fz;  ///< right, down, forward
    double sx, sy, sz;                          ///< start
    double start_depth, origin_step, slope_step;
    bool orthographic;

    explicit Basis(const Projection& p)
        : rx(p.right.x),
          ry(p.right.y),
          rz(p.right.z),
          dx(p.down.x),
          dy(p.down.y),
          dz(p.down.z),
          fx(p.forward.x),
          fy(p.forward.y),
          fz(p.forward.z),
          sx(p.start.x),
          sy(p.start.y),
          sz(p.start.z),
          start_depth(p.start_depth),
          origin_step(p.origin_step),
          slope_step(p.slope_step),
          orthographic(p.orthographic()) {}
};

/// A form's numbers, each for sixteen lanes: what vectorised loops can write.
template <class Form>
using FormLanes = std::array<Lanes<float>, sizeof(Form) / sizeof(float)>;

template <class Form>
void transpose(const FormLanes<Form>& lanes, std::array<Form, kLanes>& forms) {
    for (int i = 0; i < kLanes; ++i) {
        std::array<float, sizeof(Form) / sizeof(float)> values;
        for (std::size_t k = 0; k < values.size(); ++k) values[k] = lanes[k][i];
        forms[static_cast<std::size_t>(i)] = std::bit_cast<Form>(values);
    }
}

/// Right, down and forward from the start.
INKTRACE_INLINE void to_camera(const Basis& basis, const Points& p, int i, double& x, double& y,
                               double& z) {
    const double px = static_cast<double>(p.x[i]) - basis.sx;
    const double py = static_cast<double>(p.y[i]) - basis.sy;
    const double pz = static_cast<double>(p.z[i]) - basis.sz;
    x = px * basis.rx + py * basis.ry + pz * basis.rz;
    y = px * basis.dx + py * basis.dy + pz * basis.dz;
    z = px * basis.fx + py * basis.fy + pz * basis.fz;
}

/// The outline of a sphere at C (from the eye) with radius r is the conic where
/// (C . D)^2 = (|C|^2 - r^2) |D|^2 for D = (x, y, 1). Taken about its centre,
/// C.z (C.x, C.y) / (C.z^2 - r^2), nothing cancels.
INKTRACE_MULTIVERSION
void prepare_perspective(Basis basis, const Points& centres, const Lanes<float>& radii,
                         BoundsPacket& __restrict bounds, FormLanes<SphereForm>& __restrict form) {
    auto& [form_u, form_v, form_a, form_b, form_c, form_f, form_x, form_y, form_z] = form;
    const double step = basis.slope_step;
    const double pixels = 1.0 / step;
    for (int i = 0; i < kLanes; ++i) {
        double x = 0.0;
        double y = 0.0;
        double z = 0.0;
        to_camera(basis, centres, i, x, y, z);
        const double r = radii[i];
        const double depth = z + basis.start_depth;
        const double ahead = depth * depth - r * r;
        const double tangent = x * x + y * y + ahead;  // squared length of a tangent from the eye
        const double across = depth / ahead * pixels;
        const double u = x * across;
        const double v = y * across;
        const double a = y * y + ahead;
        const double c = x * x + ahead;
        const double width = r * std::sqrt(c) / ahead * pixels;
        const double height = r * std::sqrt(a) / ahead * pixels;
        form_x[i] = static_cast<float>(x);
        form_y[i] = static_cast<float>(y);
        form_z[i] = static_cast<float>(z);
        form_u[i] = static_cast<float>(u);
        form_v[i] = static_cast<float>(v);
        form_a[i] = static_cast<float>(a * step * step);
        form_b[i] = static_cast<float>(-2.0 * x * y * step * step);
        form_c[i] = static_cast<float>(c * step * step);
        form_f[i] = static_cast<float>(r * r * tangent / ahead);
        bounds.left[i] = static_cast<float>(u - width) - kSlack;
        bounds.right[i] = static_cast<float>(u + width) + kSlack;
        bounds.top[i] = static_cast<float>(v - height) - kSlack;
        bounds.bottom[i] = static_cast<float>(v + height) + kSlack;
        bounds.depth[i] = static_cast<float>(z - r) - kDepthSlack;
    }
}

INKTRACE_MULTIVERSION
void prepare_orthographic(Basis basis, const Points& centres, const Lanes<float>& radii,
                          BoundsPacket& __restrict bounds, FormLanes<SphereForm>& __restrict form) {
    auto& [form_u, form_v, form_a, form_b, form_c, form_f, form_x, form_y, form_z] = form;
    const double step = basis.origin_step;
    const double pixels = 1.0 / step;
    for (int i = 0; i < kLanes; ++i) {
        double x = 0.0;
        double y = 0.0;
        double z = 0.0;
        to_camera(basis, centres, i, x, y, z);
        const double r = radii[i];
        const double u = x * pixels;
        const double v = y * pixels;
        const double radius = r * pixels;
        form_x[i] = static_cast<float>(x);
        form_y[i] = static_cast<float>(y);
        form_z[i] = static_cast<float>(z);
        form_u[i] = static_cast<float>(u);
        form_v[i] = static_cast<float>(v);
        form_a[i] = static_cast<float>(step * step);
        form_b[i] = 0.0F;
        form_c[i] = static_cast<float>(step * step);
        form_f[i] = static_cast<float>(r * r);
        bounds.left[i] = static_cast<float>(u - radius) - kSlack;
        bounds.right[i] = static_cast<float>(u + radius) + kSlack;
        bounds.top[i] = static_cast<float>(v - radius) - kSlack;
        bounds.bottom[i] = static_cast<float>(v + radius) + kSlack;
        bounds.depth[i] = static_cast<float>(z - r) - kDepthSlack;
    }
}

/// Corners of triangles: right, down and forward from the start, and on the screen.
struct Corners {
    Lanes<double> x, y, z;
    Lanes<float> u, v;
};

INKTRACE_MULTIVERSION
void project(Basis basis, const Points& points, Corners& __restrict corners) {
    const double parallel = 1.0 / basis.origin_step;
    const double step = basis.orthographic ? 1.0 : 1.0 / basis.slope_step;
    for (int i = 0; i < kLanes; ++i) {
        double x = 0.0;
        double y = 0.0;
        double z = 0.0;
        to_camera(basis, points, i, x, y, z);
        const double scale = basis.orthographic ? parallel : step / (z + basis.start_depth);
        corners.x[i] = x;
        corners.y[i] = y;
        corners.z[i] = z;
        corners.u[i] = static_cast<float>(x * scale);
        corners.v[i] = static_cast<float>(y * scale);
    }
}

/// Edge from corner `a` to corner `b`, its inside on the left if `side` is 1, else -1.
INKTRACE_INLINE void lay_edge(const Corners& a, const Corners& b, const Lanes<float>& side,
                              Lanes<float>* edge) {
    for (int i = 0; i < kLanes; ++i) {
        const bool swap = b.u[i] < a.u[i] || (b.u[i] == a.u[i] && b.v[i] < a.v[i]);
        const float sign = swap ? -side[i] : side[i];
        const float x0 = swap ? b.u[i] : a.u[i];
        const float y0 = swap ? b.v[i] : a.v[i];
        const float x1 = swap ? a.u[i] : b.u[i];
        const float y1 = swap ? a.v[i] : b.v[i];
        edge[0][i] = x0;
        edge[1][i] = y0;
        edge[2][i] = sign * (x1 - x0);
        edge[3][i] = sign * (y1 - y0);
    }
}

INKTRACE_MULTIVERSION
void prepare_triangles(Basis basis, const Corners& a, const Corners& b, const Corners& c,
                       BoundsPacket& __restrict bounds, FormLanes<TriangleForm>& __restrict form) {
    Lanes<float> side;
    auto* depth = &form[12];  // behind the edges: u, v, z, gx, gy, w, wx, wy, near, far
    for (int i = 0; i < kLanes; ++i) {
        // Exact: products of differences of floats.
        const double area =
            (static_cast<double>(b.u[i]) - a.u[i]) * (static_cast<double>(c.v[i]) - a.v[i]) -
            (static_cast<double>(b.v[i]) - a.v[i]) * (static_cast<double>(c.u[i]) - a.u[i]);
        side[i] = area < 0.0 ? -1.0F : 1.0F;
        // Seen edge-on, it shows nothing.
        const float left = std::min(std::min(a.u[i], b.u[i]), c.u[i]) - kSlack;
        bounds.left[i] = area == 0.0 ? kInfinity : left;
        bounds.right[i] = std::max(std::max(a.u[i], b.u[i]), c.u[i]) + kSlack;
        bounds.top[i] = std::min(std::min(a.v[i], b.v[i]), c.v[i]) - kSlack;
        bounds.bottom[i] = std::max(std::max(a.v[i], b.v[i]), c.v[i]) + kSlack;
        const double nearest = std::min(std::min(a.z[i], b.z[i]), c.z[i]);
        const double farthest = std::max(std::max(a.z[i], b.z[i]), c.z[i]);
        bounds.depth[i] = static_cast<float>(nearest) - kDepthSlack;
        depth[8][i] = static_cast<float>(nearest);
        depth[9][i] = static_cast<float>(farthest);
    }
    lay_edge(a, b, side, &form[0]);
    lay_edge(b, c, side, &form[4]);
    lay_edge(c, a, side, &form[8]);
    for (int i = 0; i < kLanes; ++i) {
        const double bx = b.x[i] - a.x[i];
        const double by = b.y[i] - a.y[i];
        const double bz = b.z[i] - a.z[i];
        const double cx = c.x[i] - a.x[i];
        const double cy = c.y[i] - a.y[i];
        const double cz = c.z[i] - a.z[i];
        const double nx = by * cz - bz * cy;
        const double ny = bz * cx - bx * cz;
        const double nz = bx * cy - by * cx;
        // The ray at depth a.z is this far from corner a, a pixel of q.
        const double step = basis.origin_step + a.z[i] * basis.slope_step;
        depth[0][i] = a.u[i];
        depth[1][i] = a.v[i];
        depth[2][i] = static_cast<float>(a.z[i]);
        depth[3][i] = static_cast<float>(-step * nx);
        depth[4][i] = static_cast<float>(-step * ny);
        depth[5][i] = static_cast<float>(nz);
        depth[6][i] = static_cast<float>(nx * basis.slope_step);
        depth[7][i] = static_cast<float>(ny * basis.slope_step);
    }
}

INKTRACE_MULTIVERSION
void extend(const Corners& corners, BoundsPacket& packet) {
    for (int i = 0; i < kLanes; ++i) {
        packet.left[i] = std::min(packet.left[i], corners.u[i] - kSlack);
        packet.right[i] = std::max(packet.right[i], corners.u[i] + kSlack);
        packet.top[i] = std::min(packet.top[i], corners.v[i] - kSlack);
        packet.bottom[i] = std::max(packet.bottom[i], corners.v[i] + kSlack);
        packet.depth[i] = std::min(packet.depth[i], static_cast<float>(corners.z[i]) - kDepthSlack);
    }
}

/// With p = u (b - a) + v (c - a) and n = (b - a) x (c - a): p x (c - a) = u n, (b - a) x p = v n.
INKTRACE_MULTIVERSION
void record_triangles(const TriangleLanes& triangles, HitRecord* records) {
    const auto& [a, b, c] = triangles;
    std::array<Lanes<float>, 9> values;
    for (int i = 0; i < kLanes; ++i) {
        const Vec3f e{b.x[i] - a.x[i], b.y[i] - a.y[i], b.z[i] - a.z[i]};
        const Vec3f f{c.x[i] - a.x[i], c.y[i] - a.y[i], c.z[i] - a.z[i]};
        const Vec3f n = cross(e, f);
        const float squared = dot(n, n);
        const float scale = squared > 0.0F ? 1.0F / squared : 0.0F;
        const Vec3f u = cross(f, n) * scale;
        const Vec3f v = cross(n, e) * scale;
        values[0][i] = n.x;
        values[1][i] = n.y;
        values[2][i] = n.z;
        values[3][i] = u.x;
        values[4][i] = u.y;
        values[5][i] = u.z;
        values[6][i] = v.x;
        values[7][i] = v.y;
        values[8][i] = v.z;
    }
    for (int i = 0; i < kLanes; ++i) {
        records[i].normal = {values[0][i], values[1][i], values[2][i]};
        records[i].u_axis = {values[3][i], values[4][i], values[5][i]};
        records[i].v_axis = {values[6][i], values[7][i], values[8][i]};
    }
}

Vec3f at(const Points& points, int lane) {
    return {points.x[lane], points.y[lane], points.z[lane]};
}

void empty_unused(std::size_t used, BoundsPacket& bounds) {
    for (std::size_t i = used; i < kLanes; ++i) bounds.left[static_cast<int>(i)] = kInfinity;
}

}  // namespace

BoundsPacket BoundsPacket::none() {
    BoundsPacket bounds{};
    bounds.left.fill(kInfinity);
    return bounds;
}

void prepare(const Projection& projection, const SphereLanes& spheres, std::uint32_t object,
             std::span<const std::uint32_t> primitives, SpherePacket& packet, HitRecord* records) {
    const Basis basis(projection);
    FormLanes<SphereForm> form;
    if (basis.orthographic) {
        prepare_orthographic(basis, spheres.centre, spheres.radius, packet.bounds, form);
    } else {
        prepare_perspective(basis, spheres.centre, spheres.radius, packet.bounds, form);
    }
    transpose(form, packet.forms);
    empty_unused(primitives.size(), packet.bounds);
    int lane = 0;
    for (const std::uint32_t primitive : primitives) {
        records[lane].origin = at(spheres.centre, lane);
        records[lane].object = object;
        records[lane].primitive = primitive;
        records[lane].is_sphere = true;
        ++lane;
    }
}

void prepare(const Projection& projection, const TriangleLanes& triangles, std::uint32_t object,
             std::span<const std::uint32_t> primitives, TrianglePacket& packet,
             HitRecord* records) {
    const Basis basis(projection);
    Corners a;
    Corners b;
    Corners c;
    project(basis, triangles.a, a);
    project(basis, triangles.b, b);
    project(basis, triangles.c, c);
    FormLanes<TriangleForm> form;
    prepare_triangles(basis, a, b, c, packet.bounds, form);
    transpose(form, packet.forms);
    empty_unused(primitives.size(), packet.bounds);
    record_triangles(triangles, records);
    int lane = 0;
    for (const std::uint32_t primitive : primitives) {
        records[lane].origin = at(triangles.a, lane);
        records[lane].object = object;
        records[lane].primitive = primitive;
        records[lane].is_sphere = false;
        ++lane;
    }
}

void prepare(const Projection& projection, std::span<const Bounds3f> boxes, BoundsPacket& packet) {
    const Basis basis(projection);
    packet.right.fill(-kInfinity);
    packet.top.fill(kInfinity);
    packet.left = packet.top;
    packet.depth = packet.top;
    packet.bottom = packet.right;
    Points points;
    Corners corners;
    for (int corner = 0; corner < 8; ++corner) {
        for (int i = 0; i < kLanes; ++i) {
            const std::size_t k = std::min(static_cast<std::size_t>(i), boxes.size() - 1);
            const Vec3f p = boxes[k].corner(corner);
            points.x[i] = p.x;
            points.y[i] = p.y;
            points.z[i] = p.z;
        }
        project(basis, points, corners);
        extend(corners, packet);
    }
    empty_unused(boxes.size(), packet);
}

}  // namespace ink
