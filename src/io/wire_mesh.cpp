#include "io/wire_mesh.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "base/bounds.h"

namespace ink {

namespace {

/// Of the model's diagonal: about ten pixels across in a picture of 1000.
constexpr double kWireRadius = 0.005;

using Point = std::array<float, 3>;
using Edge = std::pair<Point, Point>;

std::vector<Edge> edges_of(const Mesh& mesh) {
    const auto at = [&](std::uint32_t vertex) {
        const Vec3f p = mesh.vertices[vertex] + Vec3f{};  // -0 + 0 is 0
        return Point{p.x, p.y, p.z};
    };
    std::vector<Edge> edges;
    for (const Mesh::Triangle& triangle : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Edge edge = std::minmax(at(triangle[k]), at(triangle[(k + 1) % 3]));
            if (edge.first != edge.second) edges.push_back(edge);
        }
    }
    std::ranges::sort(edges);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

}  // namespace

Glyphs wires_of(const Mesh& mesh) {
    const std::vector<Edge> edges = edges_of(mesh);
    const auto vector = [](const Point& p) { return Vec3f{p[0], p[1], p[2]}; };
    Bounds3f box;
    for (const auto& [from, to] : edges) {
        box.add(vector(from));
        box.add(vector(to));
    }
    Glyphs wires;
    wires.shape = {.kind = GlyphKind::frustum};
    if (edges.empty()) return wires;
    const double radius = kWireRadius * length(to_double(box.upper) - to_double(box.lower));
    for (const auto& [from, to] : edges) {
        wires.placements.push_back(
            placement_between(to_double(vector(from)), to_double(vector(to)), radius));
    }
    return wires;
}

}  // namespace ink
