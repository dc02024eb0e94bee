#include "render/face_density.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "render/screen_vertices.h"

namespace ink {

namespace {

/// Whether an edge of a triangle lies within a polygon, or has a line of another type.
bool has_no_line(const Mesh& mesh, std::uint32_t triangle, std::size_t edge) {
    if (!mesh.edge_flags.empty() && mesh.is_boundary(triangle, edge)) return true;
    if (mesh.faces.empty() || mesh.twins.empty()) return false;
    const std::uint32_t twin = mesh.twins[3 * std::size_t{triangle} + edge];
    return twin < Mesh::kManyTwins && mesh.faces[twin / 3] == mesh.faces[triangle];
}

/// Length of the lines of a triangle over its area, 1 / pixel, as far as the picture in full counts
/// them, which is `most` where they are endlessly dense. Each of them is half the triangle's own.
float lines_over_area(const Projection& projection, const Mesh& mesh, std::uint32_t triangle,
                      float most) {
    std::array<Vec2f, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3f& vertex = mesh.vertices[mesh.triangles[triangle][k]];
        const ScreenPoint seen = project(projection, to_double(vertex));
        if (seen.width <= 0.0F) return 0.0F;  // behind the eye
        corners[k] = {seen.x, seen.y};
    }
    float outline = 0.0F;
    for (std::size_t k = 0; k < 3; ++k) {
        if (has_no_line(mesh, triangle, k)) continue;
        outline += length(corners[(k + 1) % 3] - corners[k]);
    }
    if (outline == 0.0F) return 0.0F;
    const Vec2f u = corners[1] - corners[0];
    const Vec2f v = corners[2] - corners[0];
    const float area = 0.5F * std::abs(u.x * v.y - u.y * v.x);
    // Its lattice notices only one of the lines that cross between two neighbours; how many do is
    // about a matter of chance.
    return most * (1.0F - std::exp(-0.5F * outline / (most * area)));
}

}  // namespace

LineDensity face_density(const Edges& edges, const FaceMap& faces, float enlarged, WorkLoop& loop) {
    const Projection& projection = edges.pipeline.camera.projection();
    const Size size = edges.pipeline.settings.size;
    // A crossing on every edge of the picture's own lattice, see LineFinder::add_face_density.
    const float most = 0.5F * std::numbers::pi_v<float> * enlarged;
    // Squares of a density are sixteen pixels wide at least, so an eighth of all points will do.
    constexpr std::array kPoints{5, 15};
    constexpr float kArea = static_cast<float>(kLanes) / static_cast<float>(kPoints.size());
    std::vector<LineDensity> counted(static_cast<std::size_t>(loop.threads()), edges.no_lines);
    const auto rows = static_cast<std::size_t>((size.height + kBlockSide - 1) / kBlockSide);
    loop.run(rows, [&](std::size_t row, std::size_t worker) {
        const int y = static_cast<int>(row) * kBlockSide;
        for (int x = 0; x < size.width; x += kBlockSide) {
            const Lanes<std::uint32_t>& seen = faces.triangles(x, y);
            for (const int lane : kPoints) {
                if (seen[lane] == FaceMap::kNone) continue;
                const auto [object, primitive] = faces.triangle(seen[lane]);
                const float density =
                    lines_over_area(projection, *faces.mesh(object), primitive, most);
                const std::size_t style = edges.style_of(LineType::mesh, object);
                const Vec2f place{static_cast<float>(x + lane % kBlockSide) + 0.5F,
                                  static_cast<float>(y + lane / kBlockSide) + 0.5F};
                counted[worker].add(place, density * kArea, edges.ink.styles[style].width_px);
            }
        }
    });
    LineDensity all = counted.front();
    for (std::size_t k = 1; k < counted.size(); ++k) all += counted[k];
    return all;
}

}  // namespace ink
