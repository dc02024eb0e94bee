#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
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

/// Distance of two unit vectors at this angle.
float chord(float degrees) { return 2.0F * std::sin(degrees * std::numbers::pi_v<float> / 360.0F); }

/// Computes the normals of one mesh, vertex by vertex; scratch memory is kept between vertices.
class NormalSmoother {
  public:
    /// `sharp`: the chord from which on creases stay what they are up to their ends, where one ends
    /// on a smooth surface.
    NormalSmoother(const Mesh& mesh, const MeshTopology& topology, std::span<const Facet> facets,
                   float sharp, PackedNormals& normals)
        : mesh_(mesh), topology_(topology), facets_(facets), sharp_(sharp), normals_(normals) {}

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
        for (const FanCorner& at : fan_) {
            if (ends_sharply(at, at.corner) || ends_sharply(at, previous(at.corner))) {
                normal_of(at.corner) = own_normal(facets_[at.corner / 3].normal);
            }
        }
    }

    /// Whether an edge at a fan's corner is a sharp crease with the fan on both sides.
    bool ends_sharply(const FanCorner& at, Corner edge) const {
        if (!topology_.has_twin(edge) || !mesh_.is_crease(edge / 3, edge % 3)) return false;
        const Corner twin = topology_.twin(edge);
        const Vec3f own = facets_[edge / 3].normal;
        const Vec3f other = facets_[twin / 3].normal;
        const float turn = length(topology_.twin_is_flipped(edge) ? own + other : own - other);
        if (turn < sharp_) return false;
        const Corner beyond =
            topology_.vertex(twin) == topology_.vertex(at.corner) ? twin : next(twin);
        return std::ranges::find(fan_, beyond, &FanCorner::corner) != fan_.end();
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
    float sharp_;
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
    // A mesh with normals of its own is not shaded by these, so that nothing need be smooth where a
    // crease ends: the line would fade out over its last edge, however long and sharp that is.
    const bool shaded = mesh.corner_normals.empty();
    const float sharp = shaded ? std::numeric_limits<float>::infinity() : chord(settings.sharp_deg);
    PackedNormals normals;
    reserve_large(normals, mesh.triangles.size());
    normals.resize(mesh.triangles.size(), {kUnset, kUnset, kUnset});
    parallel_ranges(mesh.vertices.size(), 4096, [&](std::size_t begin, std::size_t end) {
        NormalSmoother smoother(mesh, topology, facets, sharp, normals);
        for (std::size_t vertex = begin; vertex < end; ++vertex) smoother.smooth(vertex);
    });
    (mesh.corner_normals.empty() ? mesh.corner_normals : mesh.line_normals) = std::move(normals);
}

}  // namespace ink
