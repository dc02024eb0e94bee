#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <variant>

#include "accel/tracer.h"

namespace ink {

namespace {

struct Hit {
    double t = std::numeric_limits<double>::infinity();
    Vec3d normal;
    double u = 0.0, v = 0.0;
    std::uint32_t primitive = kNoObject;
    std::uint32_t object = kNoObject;
};

struct Ray {
    Vec3d origin, dir;
};

/// The nearer root in front of the origin; the farther one when the origin is inside.
std::optional<double> intersect(const Ray& ray, const Sphere& sphere) {
    const Vec3d to_centre = to_double(sphere.centre) - ray.origin;
    const double a = dot(ray.dir, ray.dir);
    const double closest = dot(to_centre, ray.dir) / a;
    const Vec3d perpendicular = to_centre - ray.dir * closest;
    const double radius = sphere.radius;
    const double rest = radius * radius - dot(perpendicular, perpendicular);
    if (rest < 0.0) return std::nullopt;
    const double half_chord = std::sqrt(rest / a);
    if (closest - half_chord >= 0.0) return closest - half_chord;
    if (closest + half_chord >= 0.0) return closest + half_chord;
    return std::nullopt;
}

void intersect(const Ray& ray, const Spheres& shape, std::uint32_t object, Hit& best) {
    for (std::size_t i = 0; i < shape.count(); ++i) {
        const Sphere sphere = shape.at(i);
        const auto t = intersect(ray, sphere);
        if (!t || *t >= best.t) continue;
        const Vec3d normal = ray.origin + ray.dir * *t - to_double(sphere.centre);
        best = {*t, normal, 0.0, 0.0, static_cast<std::uint32_t>(i), object};
    }
}

/// Moeller and Trumbore 1997.
void intersect_triangle(const Ray& ray, Vec3f a, Vec3f b, Vec3f c, std::uint32_t primitive,
                        std::uint32_t object, Hit& best) {
    const Vec3d corner = to_double(a);
    const Vec3d e1 = to_double(b) - corner;
    const Vec3d e2 = to_double(c) - corner;
    const Vec3d p = cross(ray.dir, e2);
    const double det = dot(e1, p);
    if (det == 0.0) return;
    const Vec3d s = ray.origin - corner;
    const double u = dot(s, p) / det;
    const Vec3d q = cross(s, e1);
    const double v = dot(ray.dir, q) / det;
    if (u < 0.0 || v < 0.0 || u + v > 1.0) return;
    const double t = dot(e2, q) / det;
    if (t < 0.0 || t >= best.t) return;
    best = {t, cross(e1, e2), u, v, primitive, object};
}

void intersect(const Ray& ray, const Mesh& mesh, std::uint32_t object, Hit& best) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& [a, b, c] = mesh.triangles[i];
        intersect_triangle(ray, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c],
                           static_cast<std::uint32_t>(i), object, best);
    }
}

void intersect(const Ray& ray, const Hexahedra& solids, std::uint32_t object, Hit& best) {
    for (std::size_t i = 0; i < solids.corners.size(); ++i) {
        const Hexahedra::Corners& p = solids.corners[i];
        for (const auto& [a, b, c, d] : Hexahedra::kFaces) {
            const auto primitive = static_cast<std::uint32_t>(i);
            intersect_triangle(ray, p[a], p[b], p[c], primitive, object, best);
            intersect_triangle(ray, p[a], p[c], p[d], primitive, object, best);
        }
    }
}

/// A function whose sign changes where a unit shape's surface is, among other places.
double level(const UnitShape& shape, Vec3d p) {
    const double about_z = std::hypot(p.x, p.y);
    const double lateral = about_z - (0.5 * (1.0 + shape.a) - 0.5 * (1.0 - shape.a) * p.z);
    switch (shape.kind) {
        case GlyphKind::ellipsoid: return length(p) - 1.0;
        case GlyphKind::box: return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) - 1.0;
        case GlyphKind::frustum:
            return shape.capped ? std::max(lateral, std::abs(p.z) - 1.0) : lateral;
        case GlyphKind::disc:
        case GlyphKind::rectangle: return p.z;
        case GlyphKind::torus: return std::hypot(about_z - 1.0, p.z) - shape.a;
        case GlyphKind::superellipsoid: {
            const double xy =
                std::pow(std::abs(p.x), 2.0 / shape.b) + std::pow(std::abs(p.y), 2.0 / shape.b);
            return std::pow(xy, shape.b / shape.a) + std::pow(std::abs(p.z), 2.0 / shape.a) - 1.0;
        }
        case GlyphKind::gaussian:
            return p.z - std::exp(-0.5 * about_z * about_z / (shape.a * shape.a));
        case GlyphKind::waves:
            return p.z - std::cos(std::numbers::pi * shape.a * p.x) *
                             std::cos(std::numbers::pi * shape.b * p.y);
    }
    return 0.0;
}

/// Whether a place where the level changes its sign belongs to the surface.
bool belongs(const UnitShape& shape, Vec3d p) {
    switch (shape.kind) {
        case GlyphKind::frustum: return std::abs(p.z) <= 1.0 + 1e-12;
        case GlyphKind::disc: return std::hypot(p.x, p.y) <= 1.0;
        case GlyphKind::rectangle:
        case GlyphKind::gaussian:
        case GlyphKind::waves: return std::abs(p.x) <= 1.0 && std::abs(p.y) <= 1.0;
        default: return true;
    }
}

/// Walks along the ray in small steps and looks for the level's sign to change. It knows of no
/// equation to solve, which is what makes it an oracle for the tracers that do.
void intersect(const Ray& ray, const UnitShape& shape, const Placement& place,
               std::uint32_t primitive, std::uint32_t object, Hit& best) {
    constexpr int kSteps = 3000;
    const Vec3d middle = to_double(place.origin);
    const std::array axes{to_double(place.x_axis), to_double(place.y_axis),
                          to_double(place.z_axis)};
    const double volume = dot(axes[0], cross(axes[1], axes[2]));
    if (!(std::abs(volume) > 0.0)) return;
    const std::array rows{cross(axes[1], axes[2]) / volume, cross(axes[2], axes[0]) / volume,
                          cross(axes[0], axes[1]) / volume};
    const auto local = [&](double t) {
        const Vec3d p = ray.origin + ray.dir * t - middle;
        return Vec3d{dot(rows[0], p), dot(rows[1], p), dot(rows[2], p)};
    };
    const double reach =
        2.0 * std::sqrt(dot(axes[0], axes[0]) + dot(axes[1], axes[1]) + dot(axes[2], axes[2]));
    const double closest = dot(middle - ray.origin, ray.dir);
    const double begin = std::max(closest - reach, 0.0);
    const double end = closest + reach;
    double lo = begin;
    double at_lo = level(shape, local(lo));
    for (int k = 1; k <= kSteps && lo < best.t; ++k) {
        const double hi = begin + (end - begin) * k / kSteps;
        const double at_hi = level(shape, local(hi));
        if ((at_lo < 0.0) != (at_hi < 0.0)) {
            double a = lo;
            double b = hi;
            for (int step = 0; step < 60; ++step) {
                const double m = 0.5 * (a + b);
                ((level(shape, local(m)) < 0.0) == (at_lo < 0.0) ? a : b) = m;
            }
            const Vec3d p = local(a);
            if (a < best.t && belongs(shape, p)) {
                constexpr double kStep = 1e-6;
                const auto slope = [&](Vec3d d) {
                    return level(shape, p + d * kStep) - level(shape, p - d * kStep);
                };
                const Vec3d normal = rows[0] * slope({1, 0, 0}) + rows[1] * slope({0, 1, 0}) +
                                     rows[2] * slope({0, 0, 1});
                best = {a, normal, 0.0, 0.0, primitive, object};
                return;
            }
        }
        lo = hi;
        at_lo = at_hi;
    }
}

void intersect(const Ray& ray, const Glyphs& glyphs, std::uint32_t object, Hit& best) {
    for (std::size_t i = 0; i < glyphs.count(); ++i) {
        intersect(ray, glyphs.shape, glyphs.at(i), static_cast<std::uint32_t>(i), object, best);
    }
}

class BruteForceTracer final : public Tracer {
  public:
    explicit BruteForceTracer(const Scene& scene) : scene_(scene) {}

    void intersect(std::span<const RayPacket> rays, std::span<HitPacket> hits,
                   Coherence /*coherence*/) const override {
        for (std::size_t k = 0; k < rays.size(); ++k) {
            for (int lane = 0; lane < kLanes; ++lane) {
                store(rays[k].active[lane] != 0 ? trace(rays[k], lane) : Hit{}, hits[k], lane);
            }
        }
    }

    void occluded(std::span<const RayPacket> rays, std::span<const Lanes<float>> reach,
                  std::span<Lanes<std::int32_t>> blocked) const override {
        for (std::size_t k = 0; k < rays.size(); ++k) {
            for (int lane = 0; lane < kLanes; ++lane) {
                const bool hit = rays[k].active[lane] != 0 &&
                                 trace(rays[k], lane).t < static_cast<double>(reach[k][lane]);
                blocked[k][lane] = hit ? -1 : 0;
            }
        }
    }

  private:
    Hit trace(const RayPacket& rays, int lane) const {
        const Ray ray{{rays.origin_x[lane], rays.origin_y[lane], rays.origin_z[lane]},
                      {rays.dir_x[lane], rays.dir_y[lane], rays.dir_z[lane]}};
        Hit best;
        for (std::uint32_t i = 0; i < scene_.objects().size(); ++i) {
            std::visit([&](const auto& shape) { ink::intersect(ray, shape, i, best); },
                       scene_.objects()[i].shape);
        }
        return best;
    }

    static void store(const Hit& hit, HitPacket& hits, int lane) {
        const Vec3f normal = to_float(hit.normal);
        hits.t[lane] = static_cast<float>(hit.t);
        hits.normal_x[lane] = normal.x;
        hits.normal_y[lane] = normal.y;
        hits.normal_z[lane] = normal.z;
        hits.u[lane] = static_cast<float>(hit.u);
        hits.v[lane] = static_cast<float>(hit.v);
        hits.primitive[lane] = hit.primitive;
        hits.object[lane] = hit.object;
    }

    const Scene& scene_;
};

}  // namespace

std::unique_ptr<Tracer> make_brute_force_tracer(const Scene& scene) {
    return std::make_unique<BruteForceTracer>(scene);
}

}  // namespace ink
