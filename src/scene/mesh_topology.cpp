#include "scene/mesh_topology.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/memory.h"
#include "base/parallel.h"

namespace ink {

namespace {

constexpr std::size_t kGrain = 4096;

}  // namespace

MeshTopology::MeshTopology(const Mesh& mesh) : mesh_(&mesh) {
    sort_corners();
    match_edges();
}

void MeshTopology::sort_corners() {
    begin_.assign(mesh_->vertices.size() + 2, 0);
    // Counted two places ahead: filling moves every start to its end, the next vertex's start.
    for (const Mesh::Triangle& triangle : mesh_->triangles) {
        for (const std::uint32_t vertex : triangle) ++begin_[vertex + 2];
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    reserve_large(corners_, mesh_->triangles.size() * 3);
    corners_.resize(mesh_->triangles.size() * 3);
    Corner corner = 0;
    for (const Mesh::Triangle& triangle : mesh_->triangles) {
        for (const std::uint32_t vertex : triangle) corners_[begin_[vertex + 1]++] = corner++;
    }
    begin_.pop_back();
}

/// Each edge is matched at the lower of its two vertices, among the few edges that meet there.
void MeshTopology::match_edges() {
    // Edges from a vertex to itself stay as they are.
    reserve_large(twins_, corners_.size());
    twins_.resize(corners_.size(), kBranching);
    parallel_ranges(mesh_->vertices.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint64_t> edges;  // the higher vertex, then the edge
        for (std::size_t v = begin; v < end; ++v) {
            edges.clear();
            const auto add = [&](std::uint32_t other, Corner edge) {
                if (other > v) edges.push_back(std::uint64_t{other} << 32U | edge);
            };
            for (const Corner corner : about(v)) {
                add(vertex(next(corner)), corner);
                add(vertex(previous(corner)), previous(corner));
            }
            std::ranges::sort(edges);
            match(edges);
        }
    });
}

/// Edges with the same upper half are the same edge in different triangles.
void MeshTopology::match(std::span<const std::uint64_t> edges) {
    for (std::size_t i = 0; i < edges.size();) {
        std::size_t past = i + 1;
        while (past < edges.size() && edges[past] >> 32U == edges[i] >> 32U) ++past;
        const auto first = static_cast<Corner>(edges[i]);
        const auto second = static_cast<Corner>(edges[past - 1]);
        if (past - i == 1) twins_[first] = kBoundary;
        if (past - i == 2 && first / 3 != second / 3) {
            twins_[first] = second;
            twins_[second] = first;
        }
        i = past;
    }
}

// ---- facets ------------------------------------------------------------------------------------

namespace {

/// To 2e-8: Abramowitz and Stegun 4.4.46. Angles are weights; they take a third of the time so, and
/// are the same whatever library computes them.
double arc_cosine(double x) {
    const double a = std::abs(x);
    double p = -0.0012624911;
    for (const double c : {0.0066700901, -0.0170881256, 0.0308918810, -0.0501743046, 0.0889789874,
                           -0.2145988016, 1.5707963050}) {
        p = p * a + c;
    }
    const double angle = p * std::sqrt(1.0 - a);
    return x < 0.0 ? std::numbers::pi - angle : angle;
}

double angle_between(Vec3d a, Vec3d b) {
    const double cosine = dot(a, b) / std::sqrt(dot(a, a) * dot(b, b));
    return arc_cosine(std::clamp(cosine, -1.0, 1.0));
}

/// Computes the facets of one mesh. In double, because the squares of small coordinates leave the
/// range of a float.
class FacetBuilder {
  public:
    FacetBuilder(const Mesh& mesh, const MeshTopology& topology)
        : mesh_(mesh), topology_(topology), needles_(mesh.triangles.size()) {
        reserve_large(facets_, mesh.triangles.size());
        facets_.resize(mesh.triangles.size());
        double largest = 0.0;
        for (const Vec3f& p : mesh.vertices) {
            largest =
                std::max<double>(largest, std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}));
        }
        // Text files keep six or seven digits, and so do floats. A shift of one corner by such a
        // step turns a triangle of the lowest usable height by 3 degrees.
        constexpr double kStep = 1e-6;
        constexpr double kUncertainTurn = 0.05;
        lowest_usable_height_ = kStep * largest / kUncertainTurn;
    }

    std::vector<Facet> run() {
        for_each_triangle([&](std::size_t i) { measure(i); });
        for_each_triangle([&](std::size_t i) {
            if (needles_[i] != 0) borrow_normal(i);
        });
        return std::move(facets_);
    }

  private:
    void for_each_triangle(const auto& body) const {
        parallel_ranges(facets_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) body(i);
        });
    }

    std::array<Vec3d, 3> sides(std::size_t triangle) const {
        const auto& [a, b, c] = mesh_.triangles[triangle];
        const Vec3d p = to_double(mesh_.vertices[a]);
        const Vec3d q = to_double(mesh_.vertices[b]);
        const Vec3d r = to_double(mesh_.vertices[c]);
        return {q - p, r - q, p - r};
    }

    static std::size_t longest(const std::array<Vec3d, 3>& sides) {
        std::size_t best = 0;
        for (std::size_t k = 1; k < 3; ++k) {
            if (dot(sides[k], sides[k]) > dot(sides[best], sides[best])) best = k;
        }
        return best;
    }

    void measure(std::size_t triangle) {
        const std::array<Vec3d, 3> side = sides(triangle);
        const Vec3d area = cross(side[0], side[1]);
        if (area == Vec3d{}) return;
        const double doubled = length(area);
        const double angle_a = angle_between(side[0], -side[2]);
        const double angle_b = angle_between(side[1], -side[0]);
        const double angle_c = std::max(0.0, std::numbers::pi - angle_a - angle_b);
        facets_[triangle] = {to_float(area / doubled),
                             {static_cast<float>(angle_a), static_cast<float>(angle_b),
                              static_cast<float>(angle_c)}};
        const double base = length(side[longest(side)]);
        needles_[triangle] = doubled < lowest_usable_height_ * base ? 1 : 0;
    }

    /// Needles often come in fans, so several may have to be crossed.
    void borrow_normal(std::size_t needle) {
        constexpr int kMostNeedles = 16;
        std::size_t triangle = needle;
        bool flipped = false;
        for (int step = 0; step < kMostNeedles; ++step) {
            const auto edge = static_cast<Corner>(3 * triangle + longest(sides(triangle)));
            if (!topology_.has_twin(edge)) return;
            flipped ^= topology_.twin_is_flipped(edge);
            triangle = topology_.twin(edge) / 3;
            if (needles_[triangle] != 0) continue;
            const Vec3f normal = facets_[triangle].normal;
            facets_[needle].normal = flipped ? -normal : normal;
            return;
        }
    }

    const Mesh& mesh_;
    const MeshTopology& topology_;
    std::vector<Facet> facets_;
    std::vector<std::uint8_t> needles_;
    double lowest_usable_height_ = 0.0;
};

}  // namespace

std::vector<Facet> facets_of(const Mesh& mesh, const MeshTopology& topology) {
    return FacetBuilder(mesh, topology).run();
}

}  // namespace ink
