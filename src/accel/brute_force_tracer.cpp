#include <cmath>
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
    for (std::size_t i = 0; i < shape.spheres.size(); ++i) {
        const auto t = intersect(ray, shape.spheres[i]);
        if (!t || *t >= best.t) continue;
        const Vec3d normal = ray.origin + ray.dir * *t - to_double(shape.spheres[i].centre);
        best = {*t, normal, 0.0, 0.0, static_cast<std::uint32_t>(i), object};
    }
}

/// Moeller and Trumbore 1997.
void intersect(const Ray& ray, const Mesh& mesh, std::uint32_t object, Hit& best) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& [a, b, c] = mesh.triangles[i];
        const Vec3d corner = to_double(mesh.vertices[a]);
        const Vec3d e1 = to_double(mesh.vertices[b]) - corner;
        const Vec3d e2 = to_double(mesh.vertices[c]) - corner;
        const Vec3d p = cross(ray.dir, e2);
        const double det = dot(e1, p);
        if (det == 0.0) continue;
        const Vec3d s = ray.origin - corner;
        const double u = dot(s, p) / det;
        const Vec3d q = cross(s, e1);
        const double v = dot(ray.dir, q) / det;
        if (u < 0.0 || v < 0.0 || u + v > 1.0) continue;
        const double t = dot(e2, q) / det;
        if (t < 0.0 || t >= best.t) continue;
        best = {t, cross(e1, e2), u, v, static_cast<std::uint32_t>(i), object};
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
