#include "camera/supports.h"

#include <algorithm>
#include <limits>
#include <mutex>
#include <variant>

#include "accel/tracer.h"
#include "base/parallel.h"

namespace ink {

namespace {
constexpr std::size_t kGrain = 1 << 15;
}  // namespace

std::array<double, 4> supports(const Scene& scene, const std::array<Vec3f, 4>& normals) {
    constexpr double kMax = std::numeric_limits<double>::max();
    std::array<double, 4> least{kMax, kMax, kMax, kMax};
    std::mutex mutex;
    const auto reduce = [&](std::size_t count, const auto& value) {
        parallel_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
            std::array<float, 4> part{kInfinity, kInfinity, kInfinity, kInfinity};
            for (std::size_t i = begin; i < end; ++i) {
                for (std::size_t k = 0; k < 4; ++k) {
                    part[k] = std::min(part[k], value(normals[k], i));
                }
            }
            const std::scoped_lock lock(mutex);
            for (std::size_t k = 0; k < 4; ++k) least[k] = std::min<double>(least[k], part[k]);
        });
    };
    for (const Object& object : scene.objects()) {
        if (const auto* shape = std::get_if<Spheres>(&object.shape)) {
            reduce(shape->count(), [&](Vec3f n, std::size_t i) {
                const Sphere sphere = shape->at(i);
                return dot(n, sphere.centre) - sphere.radius;
            });
        } else if (const auto* mesh = std::get_if<Mesh>(&object.shape)) {
            reduce(mesh->vertices.size(),
                   [&](Vec3f n, std::size_t i) { return dot(n, mesh->vertices[i]); });
        } else if (const auto* glyphs = std::get_if<Glyphs>(&object.shape)) {
            reduce(glyphs->placements.size(), [&](Vec3f n, std::size_t i) {
                const Vec3d opposite = to_double(-n);
                return static_cast<float>(-support(glyphs->shape, glyphs->placements[i], opposite));
            });
        } else {
            const auto& solids = std::get<Hexahedra>(object.shape);
            reduce(solids.corners.size() * 8,
                   [&](Vec3f n, std::size_t i) { return dot(n, solids.corners[i / 8][i % 8]); });
        }
    }
    return least;
}

}  // namespace ink
