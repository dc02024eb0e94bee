// Surfaces that were cut into triangles one by one, as CAD programs do, meet along edges whose
// corners differ in the last digits.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "base/bounds.h"
#include "base/parallel.h"
#include "scene/mesh_topology.h"

namespace ink {

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// The vertices on open edges, and which of them lie as near to each other as rounding leaves them.
class OpenVertices {
  public:
    OpenVertices(const Mesh& mesh, const MeshTopology& topology, const StitchSettings& settings)
        : mesh_(mesh), reach_(mesh.vertices.size(), kClosed), parts_(mesh.vertices.size()) {
        for (std::size_t i = 0; i < 3 * mesh.triangles.size(); ++i) {
            const auto edge = static_cast<Corner>(i);
            if (topology.twin(edge) != MeshTopology::kBoundary) continue;
            add(topology.vertex(edge), edge / 3);
            add(topology.vertex(next(edge)), edge / 3);
        }
        if (open_.empty()) return;
        measure(settings);
        std::ranges::sort(open_);
    }

    /// Moves the second of two vertices, each of which is the other's nearest, to the first.
    /// Returns how many moved.
    std::size_t close(std::vector<Vec3f>& vertices) const {
        if (open_.empty()) return 0;
        std::vector<std::uint32_t> nearest(vertices.size(), kNone);
        parallel_ranges(open_.size(), 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t n = begin; n < end; ++n) nearest[open_[n].second] = nearest_to(n);
        });
        std::size_t moved = 0;
        for (const auto& [along, v] : open_) {
            const std::uint32_t other = nearest[v];
            if (other == kNone || other > v || nearest[other] != v) continue;
            vertices[v] = vertices[other];
            ++moved;
        }
        return moved;
    }

  private:
    static constexpr float kClosed = -1.0F;

    void add(std::uint32_t vertex, std::uint32_t triangle) {
        if (reach_[vertex] != kClosed) return;
        // Of any direction; this one lies along no plane that a model is likely to have.
        const Vec3d direction{0.4802, 0.6329, 0.6074};
        reach_[vertex] = std::numeric_limits<float>::max();
        parts_[vertex] = mesh_.parts.empty() ? 0 : mesh_.parts[triangle];
        open_.emplace_back(dot(to_double(mesh_.vertices[vertex]), direction), vertex);
    }

    /// How far each may be from another one.
    void measure(const StitchSettings& settings) {
        Bounds3f bounds;
        for (const Mesh::Triangle& triangle : mesh_.triangles) {
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t v = triangle[k];
                const std::uint32_t w = triangle[(k + 1) % 3];
                bounds.add(mesh_.vertices[v]);
                if (reach_[v] == kClosed && reach_[w] == kClosed) continue;
                const double side = settings.share_of_edge * distance(v, w);
                for (const std::uint32_t end : {v, w}) {
                    reach_[end] = std::min(reach_[end], static_cast<float>(side));
                }
            }
        }
        const double size = length(to_double(bounds.upper) - to_double(bounds.lower));
        const auto most = static_cast<float>(settings.share_of_size * size);
        for (float& reach : reach_) reach = std::min(reach, most);
    }

    double distance(std::uint32_t v, std::uint32_t w) const {
        return length(to_double(mesh_.vertices[v]) - to_double(mesh_.vertices[w]));
    }

    /// Of one part, within the reach of both. Where very many lie in one plane across the
    /// direction in which they are sorted, not all are looked at.
    std::uint32_t nearest_to(std::size_t n) const {
        constexpr std::ptrdiff_t kMost = 1000;
        const auto [along, v] = open_[n];
        const auto at = static_cast<std::ptrdiff_t>(n);
        const auto end = static_cast<std::ptrdiff_t>(open_.size());
        std::pair<double, std::uint32_t> best{reach_[v], kNone};
        for (const std::ptrdiff_t step : {-1, 1}) {
            for (std::ptrdiff_t k = at + step; k >= 0 && k < end && std::abs(k - at) < kMost;
                 k += step) {
                const auto [other_along, w] = open_[static_cast<std::size_t>(k)];
                if (std::abs(other_along - along) > best.first) break;
                if (parts_[w] != parts_[v]) continue;
                const double apart = distance(v, w);
                if (apart <= reach_[w]) best = std::min(best, {apart, w});
            }
        }
        return best.second;
    }

    const Mesh& mesh_;
    std::vector<float> reach_;          ///< a vertex; kClosed if it is on no open edge
    std::vector<std::uint32_t> parts_;  ///< an open vertex
    std::vector<std::pair<double, std::uint32_t>> open_;  ///< by where they lie along a direction
};

}  // namespace

std::size_t stitch(Mesh& mesh, MeshTopology& topology, const StitchSettings& settings) {
    // Where several surfaces meet in a corner, each turn joins two of them.
    constexpr int kTurns = 6;
    std::size_t moved = 0;
    for (int turn = 0; turn < kTurns; ++turn) {
        const std::size_t now = OpenVertices(mesh, topology, settings).close(mesh.vertices);
        if (now == 0) break;
        moved += now;
        weld(mesh);
        topology = MeshTopology(mesh);
    }
    return moved;
}

std::size_t stitch(Mesh& mesh, const StitchSettings& settings) {
    MeshTopology topology(mesh);
    return stitch(mesh, topology, settings);
}

}  // namespace ink
