#include <utility>
#include <vector>

#include "base/memory.h"
#include "base/parallel.h"
#include "scene/mesh_topology.h"

namespace ink {

namespace {

using PackedNormals = std::vector<std::array<std::uint32_t, 3>>;

// Not codes of a normal: a half of a code is at most 65534.
constexpr std::uint32_t kUnset = 0xFFFFFFFF;
constexpr std::uint32_t kTaken = 0xFFFFFFFE;
static_assert((kTaken >> 16U) == 0xFFFF);

/// Computes the normals of one mesh, vertex by vertex; scratch memory is kept between vertices.
class NormalSmoother {
  public:
    NormalSmoother(const Mesh& mesh, const MeshTopology& topology, std::span<const Facet> facets,
                   PackedNormals& normals)
        : mesh_(mesh), topology_(topology), facets_(facets), normals_(normals) {}

    void smooth(std::size_t vertex) {
        for (const Corner corner : topology_.about(vertex)) {
            if (normal_of(corner) == kUnset) smooth_fan(corner);
        }
    }

  private:
    /// A corner of a fan, and whether its triangle is wound the other way than the first one.
    struct FanCorner {
        Corner corner;
        bool flipped;
    };

    std::uint32_t& normal_of(Corner corner) const { return normals_[corner / 3][corner % 3]; }

    /// One normal for all corners about a vertex that can be reached without crossing a crease.
    void smooth_fan(Corner first) {
        fan_.clear();
        take({first, false});
        walk({first, false}, first);
        walk({first, false}, previous(first));
        Vec3f sum;
        for (const auto& [corner, flipped] : fan_) {
            const Facet& facet = facets_[corner / 3];
            const float angle = facet.angles[corner % 3];
            sum = sum + facet.normal * (flipped ? -angle : angle);
        }
        if (sum == Vec3f{}) {
            for (const auto& [corner, flipped] : fan_) {
                normal_of(corner) = own_normal(facets_[corner / 3].normal);
            }
            return;
        }
        // Almost always none is flipped, so one is enough.
        const Vec3f mean = normalize(sum);
        const std::uint32_t upright = pack_normal(mean);
        for (const auto& [corner, flipped] : fan_) {
            normal_of(corner) = flipped ? pack_normal(-mean) : upright;
        }
    }

    void take(FanCorner at) {
        fan_.push_back(at);
        normal_of(at.corner) = kTaken;
    }

    /// Goes about the vertex, out of the triangle across `edge` first, as far as the fan goes.
    void walk(FanCorner at, Corner edge) {
        const std::uint32_t vertex = topology_.vertex(at.corner);
        while (topology_.has_twin(edge) && !mesh_.is_crease(edge / 3, edge % 3)) {
            const Corner twin = topology_.twin(edge);
            at.flipped ^= topology_.twin_is_flipped(edge);
            at.corner = topology_.vertex(twin) == vertex ? twin : next(twin);
            if (normal_of(at.corner) != kUnset) return;
            take(at);
            edge = at.corner == twin ? previous(twin) : at.corner;
        }
    }

    /// Where opposite triangles meet; 0 where a triangle has no area.
    static std::uint32_t own_normal(Vec3f own) {
        return pack_normal(own == Vec3f{} ? Vec3f{0.0F, 0.0F, 1.0F} : own);
    }

    const Mesh& mesh_;
    const MeshTopology& topology_;
    std::span<const Facet> facets_;
    PackedNormals& normals_;
    std::vector<FanCorner> fan_;
};

}  // namespace

void smooth_normals(Mesh& mesh, const CreaseSettings& settings) {
    MeshTopology topology(mesh);
    smooth_normals(mesh, topology, settings);
    mesh.twins = std::move(topology).take_twins();
}

void smooth_normals(Mesh& mesh, const MeshTopology& topology, const CreaseSettings& settings) {
    const std::vector<Facet> facets = facets_of(mesh, topology);
    mesh.edge_flags = classify_edges(mesh, topology, facets, settings);
    PackedNormals normals;
    reserve_large(normals, mesh.triangles.size());
    normals.resize(mesh.triangles.size(), {kUnset, kUnset, kUnset});
    parallel_ranges(mesh.vertices.size(), 4096, [&](std::size_t begin, std::size_t end) {
        NormalSmoother smoother(mesh, topology, facets, normals);
        for (std::size_t vertex = begin; vertex < end; ++vertex) smoother.smooth(vertex);
    });
    (mesh.corner_normals.empty() ? mesh.corner_normals : mesh.line_normals) = std::move(normals);
}

}  // namespace ink
