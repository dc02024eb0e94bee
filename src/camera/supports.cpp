#include "camera/supports.h"

#include <algorithm>
#include <limits>
#include <mutex>
#include <variant>

#include "accel/tracer.h"
#include "base/lanes.h"
#include "base/multiversion.h"
#include "base/parallel.h"

namespace ink {

namespace {

constexpr std::size_t kGrain = 1 << 12;

/// Sixteen spheres, or points, of radius 0.
struct BallLanes {
    Lanes<float> x, y, z, radius;

    void put(int lane, const Sphere& sphere) {
        x[lane] = sphere.centre.x;
        y[lane] = sphere.centre.y;
        z[lane] = sphere.centre.z;
        radius[lane] = sphere.radius;
    }
};

INKTRACE_MULTIVERSION
void reach(const BallLanes& balls, const std::array<Vec3f, 4>& normals,
           std::array<Lanes<float>, 4>& least) {
    for (std::size_t k = 0; k < normals.size(); ++k) {
        const Vec3f n = normals[k];
        for (int i = 0; i < kLanes; ++i) {
            const float at =
                n.x * balls.x[i] + n.y * balls.y[i] + n.z * balls.z[i] - balls.radius[i];
            least[k][i] = std::min(least[k][i], at);
        }
    }
}

}  // namespace

std::array<double, 4> supports(const Scene& scene, const std::array<Vec3f, 4>& normals) {
    constexpr double kMax = std::numeric_limits<double>::max();
    std::array<double, 4> least{kMax, kMax, kMax, kMax};
    std::mutex mutex;
    const auto add = [&](const std::array<float, 4>& part) {
        const std::scoped_lock lock(mutex);
        for (std::size_t k = 0; k < 4; ++k) least[k] = std::min<double>(least[k], part[k]);
    };
    const auto reduce_balls = [&](std::size_t count, const Motion& motion, const auto& ball) {
        // Instead of balls, the directions are turned.
        std::array<Vec3f, 4> turned;
        std::array<float, 4> shifts;
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3d n = to_double(normals[k]);
            turned[k] = to_float(motion.turn_back(n));
            shifts[k] = static_cast<float>(dot(n, motion.shift));
        }
        parallel_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
            std::array<Lanes<float>, 4> lanes;
            for (Lanes<float>& lane : lanes) lane.fill(kInfinity);
            BallLanes balls;
            for (std::size_t first = begin; first < end; first += kLanes) {
                for (int i = 0; i < kLanes; ++i) {
                    // Unused lanes repeat the last one.
                    balls.put(i, ball(std::min(first + static_cast<std::size_t>(i), end - 1)));
                }
                reach(balls, turned, lanes);
            }
            std::array<float, 4> part{};
            for (std::size_t k = 0; k < 4; ++k) {
                part[k] = *std::ranges::min_element(lanes[k]) + shifts[k];
            }
            add(part);
        });
    };
    const auto reduce_points = [&](std::size_t count, const auto& point) {
        reduce_balls(count, Motion{}, [&](std::size_t i) { return Sphere{point(i), 0.0F}; });
    };
    for (const Object& object : scene.objects()) {
        if (const auto* shape = std::get_if<Spheres>(&object.shape)) {
            const auto reduce = [&](const Motion& motion) {
                reduce_balls(shape->spheres.size(), motion,
                             [&](std::size_t i) { return shape->spheres[i]; });
            };
            if (shape->copies.empty()) reduce({});
            for (const Copy& copy : shape->copies) reduce(copy.motion);
        } else if (const auto* mesh = std::get_if<Mesh>(&object.shape)) {
            reduce_points(mesh->vertices.size(), [&](std::size_t i) { return mesh->vertices[i]; });
        } else if (const auto* glyphs = std::get_if<Glyphs>(&object.shape)) {
            parallel_ranges(glyphs->count(), kGrain, [&](std::size_t begin, std::size_t end) {
                std::array<float, 4> part{kInfinity, kInfinity, kInfinity, kInfinity};
                for (std::size_t i = begin; i < end; ++i) {
                    for (std::size_t k = 0; k < 4; ++k) {
                        const Vec3d opposite = to_double(-normals[k]);
                        const double far = support(glyphs->shape, glyphs->at(i), opposite);
                        part[k] = std::min(part[k], static_cast<float>(-far));
                    }
                }
                add(part);
            });
        } else {
            const auto& solids = std::get<Hexahedra>(object.shape);
            reduce_points(solids.corners.size() * 8,
                          [&](std::size_t i) { return solids.corners[i / 8][i % 8]; });
        }
    }
    return least;
}

}  // namespace ink
