// Which edges of a mesh are creases of the shape that it stands for, and which only come from
// cutting a round shape into flat triangles.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/bounds.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "scene/mesh_topology.h"

namespace ink {

namespace {

/// Distance of two unit vectors at this angle. Turns are compared as such distances, which needs no
/// trigonometry and keeps the digits of small turns.
float chord(float degrees) { return 2.0F * std::sin(degrees * std::numbers::pi_v<float> / 360.0F); }

/// Edges that hang together: first join all, then look at the groups.
class CreaseGroups {
  public:
    struct Group {
        Bounds3f bounds;
        std::uint32_t edges = 0;
        bool is_loose = false;  ///< has a loose end
    };

    explicit CreaseGroups(std::size_t vertex_count)
        : parents_(vertex_count), numbers_(vertex_count, kNone) {
        std::iota(parents_.begin(), parents_.end(), 0U);
    }

    void join(std::uint32_t a, std::uint32_t b) {
        const std::uint32_t root_a = root(a);
        const std::uint32_t root_b = root(b);
        parents_[std::max(root_a, root_b)] = std::min(root_a, root_b);
    }

    Group& of(std::uint32_t vertex) {
        std::uint32_t& number = numbers_[root(vertex)];
        if (number == kNone) {
            number = static_cast<std::uint32_t>(groups_.size());
            groups_.emplace_back();
        }
        return groups_[number];
    }

  private:
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

    std::uint32_t root(std::uint32_t vertex) {
        while (parents_[vertex] != vertex) {
            parents_[vertex] = parents_[parents_[vertex]];
            vertex = parents_[vertex];
        }
        return vertex;
    }

    std::vector<std::uint32_t> parents_;  ///< trees of vertices that edges connect
    std::vector<std::uint32_t> numbers_;  ///< a root: its group
    std::vector<Group> groups_;
};

class EdgeClassifier {
  public:
    EdgeClassifier(const Mesh& mesh, const MeshTopology& topology, std::span<const Facet> facets,
                   const CreaseSettings& settings)
        : mesh_(mesh),
          topology_(topology),
          facets_(facets),
          settings_(settings),
          sharp_(chord(settings.sharp_deg)),
          least_(chord(settings.min_deg)),
          creases_(mesh.triangles.size() * 3) {
        reserve_large(turns_, creases_.size());
        turns_.resize(creases_.size());
    }

    std::vector<std::uint8_t> run() {
        for_each_edge([&](Corner edge) { turns_[edge] = turn(edge); });
        for_each_edge([&](Corner edge) {
            // Each pair of twins is decided once. A byte an edge: no two threads write the same.
            if (!topology_.has_twin(edge) || topology_.twin(edge) < edge || !is_crease(edge))
                return;
            creases_[edge] = creases_[topology_.twin(edge)] = 1;
        });
        if (mesh_.triangles.size() >= settings_.fine_triangles) drop_noise();
        return flags();
    }

  private:
    void for_each_edge(const auto& body) const {
        parallel_ranges(turns_.size(), 16384, [&](std::size_t begin, std::size_t end) {
            for (std::size_t edge = begin; edge < end; ++edge) body(static_cast<Corner>(edge));
        });
    }

    float turn(Corner edge) const {
        if (!topology_.has_twin(edge)) return 0.0F;
        const Vec3f own = facets_[edge / 3].normal;
        const Vec3f other = facets_[topology_.twin(edge) / 3].normal;
        return length(topology_.twin_is_flipped(edge) ? own + other : own - other);
    }

    /// In double, as the facets are.
    Vec3d vector_along(Corner edge) const {
        return to_double(mesh_.vertices[topology_.vertex(next(edge))]) -
               to_double(mesh_.vertices[topology_.vertex(edge)]);
    }

    bool is_crease(Corner edge) const {
        const float turned = turns_[edge];
        if (turned < least_ || within_a_polygon(edge)) return false;
        return turned >= sharp_ || turned > settings_.isolation * turn_around(edge);
    }

    bool within_a_polygon(Corner edge) const {
        return !mesh_.faces.empty() &&
               mesh_.faces[edge / 3] == mesh_.faces[topology_.twin(edge) / 3];
    }

    /// How much the smooth surface about an edge turns across the edge's direction, going by the
    /// edges of the triangles within two rings. What lies beyond a sharp edge is another surface.
    float turn_around(Corner edge) const {
        const Vec3d along = normalize(vector_along(edge));
        float most = 0.0F;
        const auto consider = [&](Corner other) {
            if (turns_[other] <= most || turns_[other] >= sharp_) return;
            const Vec3d direction = vector_along(other);
            const double share = std::abs(dot(direction, along)) / length(direction);
            most = std::max(most, turns_[other] * static_cast<float>(share));
        };
        for (const Corner side : {edge, topology_.twin(edge)}) {
            for (const Corner near : {next(side), previous(side)}) {
                consider(near);
                if (!topology_.has_twin(near) || turns_[near] >= sharp_) continue;
                consider(next(topology_.twin(near)));
                consider(previous(topology_.twin(near)));
            }
        }
        return most;
    }

    /// Drops creases that are too few or too scattered to be of the shape. See CreaseSettings.
    void drop_noise() {
        const std::vector<Corner> edges = each_crease_once();
        if (edges.empty()) return;
        CreaseGroups groups = groups_of(edges);
        CreaseGroups pieces = pieces_of_mesh();
        for (const Corner edge : edges) {
            const CreaseGroups::Group& group = groups.of(topology_.vertex(edge));
            const CreaseGroups::Group& piece = pieces.of(topology_.vertex(edge));
            const bool keep =
                piece.edges < 3 * settings_.fine_triangles ||
                extent(group.bounds) >= settings_.line_extent * extent(piece.bounds) ||
                (!group.is_loose && group.edges >= settings_.closed_edges);
            if (!keep) creases_[edge] = creases_[topology_.twin(edge)] = 0;
        }
    }

    /// The mesh in pieces that hang together: an assembly has many, each with a size of its own.
    CreaseGroups pieces_of_mesh() const {
        CreaseGroups pieces(mesh_.vertices.size());
        for (const Mesh::Triangle& triangle : mesh_.triangles) {
            pieces.join(triangle[0], triangle[1]);
            pieces.join(triangle[1], triangle[2]);
        }
        for (const Mesh::Triangle& triangle : mesh_.triangles) {
            CreaseGroups::Group& piece = pieces.of(triangle[0]);
            piece.edges += 3;
            for (const std::uint32_t vertex : triangle) piece.bounds.add(mesh_.vertices[vertex]);
        }
        return pieces;
    }

    CreaseGroups groups_of(std::span<const Corner> edges) const {
        CreaseGroups groups(mesh_.vertices.size());
        for (const Corner edge : edges) {
            groups.join(topology_.vertex(edge), topology_.vertex(next(edge)));
        }
        const std::vector<std::uint8_t> loose = loose_ends(edges);
        for (const Corner edge : edges) {
            CreaseGroups::Group& group = groups.of(topology_.vertex(edge));
            ++group.edges;
            for (const Corner end : {edge, next(edge)}) {
                group.bounds.add(mesh_.vertices[topology_.vertex(end)]);
                group.is_loose |= loose[topology_.vertex(end)] != 0;
            }
        }
        return groups;
    }

    std::vector<Corner> each_crease_once() const {
        std::vector<Corner> edges;
        for (std::size_t i = 0; i < creases_.size(); ++i) {
            const auto edge = static_cast<Corner>(i);
            if (creases_[i] != 0 && edge < topology_.twin(edge)) edges.push_back(edge);
        }
        return edges;
    }

    /// A vertex: 1 where a crease ends without meeting another one or the rim of the surface.
    std::vector<std::uint8_t> loose_ends(std::span<const Corner> edges) const {
        std::vector<std::uint8_t> meeting(mesh_.vertices.size());
        const auto count = [&](Corner edge) {
            for (const Corner end : {edge, next(edge)}) {
                std::uint8_t& creases = meeting[topology_.vertex(end)];
                creases = static_cast<std::uint8_t>(std::min(creases + 1, 2));
            }
        };
        for (const Corner edge : edges) count(edge);
        for (std::size_t i = 0; i < creases_.size(); ++i) {
            const auto edge = static_cast<Corner>(i);
            if (!topology_.has_twin(edge)) count(edge);
        }
        for (std::uint8_t& creases : meeting) creases = creases == 1 ? 1 : 0;
        return meeting;
    }

    static double extent(const Bounds3f& bounds) {
        return length(to_double(bounds.upper) - to_double(bounds.lower));
    }

    std::vector<std::uint8_t> flags() const {
        std::vector<std::uint8_t> flags(mesh_.triangles.size());
        for (std::size_t edge = 0; edge < creases_.size(); ++edge) {
            const Corner twin = topology_.twin(static_cast<Corner>(edge));
            const bool crease = creases_[edge] != 0 || twin == MeshTopology::kBranching;
            const unsigned set = (twin == MeshTopology::kBoundary ? Mesh::kBoundaryEdge : 0U) |
                                 (crease ? Mesh::kCreaseEdge : 0U);
            flags[edge / 3] = static_cast<std::uint8_t>(flags[edge / 3] | set << edge % 3);
        }
        return flags;
    }

    const Mesh& mesh_;
    const MeshTopology& topology_;
    std::span<const Facet> facets_;
    const CreaseSettings& settings_;
    float sharp_, least_;                ///< chords
    std::vector<float> turns_;           ///< an edge: chord; 0 without a twin
    std::vector<std::uint8_t> creases_;  ///< an edge: whether it is one
};

}  // namespace

std::vector<std::uint8_t> classify_edges(const Mesh& mesh, const MeshTopology& topology,
                                         std::span<const Facet> facets,
                                         const CreaseSettings& settings) {
    return EdgeClassifier(mesh, topology, facets, settings).run();
}

}  // namespace ink
