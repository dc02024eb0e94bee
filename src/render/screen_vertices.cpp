#include "render/screen_vertices.h"

#include <algorithm>
#include <cstddef>
#include <variant>

#include "base/parallel.h"

namespace ink {

ScreenPoint project(const Projection& p, const Vec3d& position) {
    const Vec3d v = position - p.start;
    const double depth = dot(v, p.forward);
    const double width = p.origin_step + depth * p.slope_step;
    const double scale = 1.0 / width;
    return {static_cast<float>(dot(v, p.right) * scale + static_cast<double>(p.centre.x)),
            static_cast<float>(dot(v, p.down) * scale + static_cast<double>(p.centre.y)),
            static_cast<float>(depth), static_cast<float>(width)};
}

ScreenVertices::ScreenVertices(const Scene& scene, const Projection& projection, Size size,
                               int threads)
    : points_(scene.objects().size()) {
    constexpr std::size_t kVerticesAPixel = 2;
    constexpr std::size_t kGrain = 4096;
    for (std::size_t k = 0; k < points_.size(); ++k) {
        const auto* mesh = std::get_if<Mesh>(&scene.objects()[k].shape);
        if (mesh == nullptr || mesh->vertices.size() > kVerticesAPixel * size.pixels()) continue;
        const std::vector<Vec3f>& vertices = mesh->vertices;
        std::vector<ScreenPoint>& points = points_[k];
        points.resize(vertices.size());
        parallel_for((vertices.size() + kGrain - 1) / kGrain, threads,
                     [&](std::size_t grain, std::size_t) {
                         const std::size_t end = std::min((grain + 1) * kGrain, vertices.size());
                         for (std::size_t i = grain * kGrain; i < end; ++i) {
                             points[i] = project(projection, to_double(vertices[i]));
                         }
                     });
    }
}

}  // namespace ink
