#include "sampling/mesh_walk.h"

#include <algorithm>
#include <array>
#include <variant>

namespace ink {

MeshWay::MeshWay(const WalkRow* rows, const WalkEnds& ends, std::size_t lane, bool backwards)
    : rows_(rows),
      lane_(static_cast<std::uint32_t>(lane)),
      count_(ends.count[lane]),
      end_(static_cast<WalkEnd>(ends.end[lane])),
      backwards_(backwards),
      last_{Foot{ends.feet[0][lane], ends.feet[1][lane], ends.feet[2][lane]},
            Foot{ends.feet[3][lane], ends.feet[4][lane], ends.feet[5][lane]}} {}

double MeshWay::end_nearness() const {
    std::size_t k = count_ - 1;
    while (k > 1 && at(k - 1) >= end_at() - kWayRounding) --k;
    return step_nearness(k);
}

double MeshWay::nearness(double place) const {
    std::size_t k = 1;
    while (k + 1 < count_ && at(k) < place) ++k;
    const double before = step_nearness(k - 1);
    const double after = step_nearness(k);
    const double length = at(k) - at(k - 1);
    if (!(length > 0.0)) return after;
    return before + (after - before) * std::clamp((place - at(k - 1)) / length, 0.0, 1.0);
}

WalkRow* WalkMemory::rows() {
    if (used_ == groups_.size()) {
        groups_.push_back(std::make_unique_for_overwrite<WalkRow[]>(kMostWalkRows));
    }
    return groups_[used_++].get();
}

MeshWalk::MeshWalk(const Scene& scene, const Projection& projection, NormalSource normals)
    : projection_(projection), view_(projection), surfaces_(scene.objects().size()) {
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
        const Object& object = scene.objects()[k];
        const auto* mesh = std::get_if<Mesh>(&object.shape);
        if (mesh == nullptr || mesh->twins.empty() || mesh->edge_flags.empty()) continue;
        if (std::max(mesh->triangles.size(), mesh->vertices.size()) > kMostWalked) continue;
        Surface& surface = surfaces_[k];
        surface.mesh = mesh;
        // As Shader::line_normals.
        const NormalSource source = object.normals.value_or(normals);
        const bool own = source == NormalSource::automatic && !mesh->line_normals.empty();
        const auto& corners = own ? mesh->line_normals : mesh->corner_normals;
        if (source != NormalSource::geometric && !corners.empty()) {
            surface.normals = corners[0].data();
        }
        // Normals of a file may be discontinuous anywhere.
        surface.creases_flagged = surface.normals != nullptr && (own || mesh->line_normals.empty());
    }
}

void MeshWalk::walk(std::span<const Walk> walks, std::span<const WayLine> lines, WalkMemory& memory,
                    std::vector<MeshWay>& ways) const {
    constexpr std::size_t kMost = kMostWalkGroups * kWalkLanes;
    std::array<WalkRow*, kMostWalkGroups> rows;
    for (std::size_t first = 0; first < walks.size();) {
        const std::uint32_t object = walks[first].from.object;
        std::size_t count = 1;
        while (count < kMost && first + count < walks.size() &&
               walks[first + count].from.object == object) {
            ++count;
        }
        const std::size_t groups = (count + kWalkLanes - 1) / kWalkLanes;
        for (std::size_t k = 0; k < groups * kWalkLanes; ++k) {
            const Walk& walk = walks[first + std::min(k, count - 1)];
            memory.starts[k / kWalkLanes].put(k % kWalkLanes, lines[walk.line], walk.from.primitive,
                                              walk.target, walk.limit, walk.backwards);
        }
        for (std::size_t k = 0; k < groups; ++k) rows[k] = memory.rows();
        walk_side_by_side(*surfaces_[object].mesh, view_, std::span(memory.starts).first(groups),
                          std::span(rows).first(groups), memory.ends);
        for (std::size_t k = 0; k < count; ++k) {
            ways.emplace_back(rows[k / kWalkLanes], memory.ends[k / kWalkLanes], k % kWalkLanes,
                              walks[first + k].backwards);
        }
        first += count;
    }
}

MeshWalk::Crease MeshWalk::sharpest_crease(std::uint32_t object, const WayLine& line,
                                           const MeshWay& way) const {
    const Surface& surface = surfaces_[object];
    const Mesh& mesh = *surface.mesh;
    Crease sharpest;
    const std::size_t past = way.count() - (way.end() == WalkEnd::unknown ? 0 : 1);
    for (std::size_t k = 1; k < past; ++k) {
        const std::uint32_t edge = way.edge(k);
        const Mesh::Triangle& corners = mesh.triangles[edge / 3];
        if (surface.creases_flagged && !mesh.is_crease(edge / 3, edge % 3)) continue;
        const Feet feet{foot_of(view_, line, mesh.vertices[corners[edge % 3]]),
                        foot_of(view_, line, mesh.vertices[corners[(edge + 1) % 3]])};
        const double share = feet[0].side / (feet[0].side - feet[1].side);
        const float turn = surface.turn_across(edge, share);
        if (turn > sharpest.turn) sharpest = {turn, way.at(k), way.step_nearness(k), feet};
    }
    return sharpest;
}

/// How far the normal turns at a place of an edge.
float MeshWalk::Surface::turn_across(std::uint32_t edge, double share) const {
    const std::uint32_t twin = mesh->twins[edge];
    const bool flipped = mesh->triangles[edge / 3][edge % 3] == mesh->triangles[twin / 3][twin % 3];
    const Vec3f n = normal(edge, share);
    const Vec3f m = normal(twin, flipped ? share : 1.0 - share);
    return length(flipped ? n + m : n - m);
}

Vec3f MeshWalk::Surface::normal(std::uint32_t edge, double share) const {
    const std::uint32_t triangle = edge / 3;
    if (normals != nullptr) {
        const Vec3f p = unpack_normal(normals[edge]);
        const Vec3f q = unpack_normal(normals[3 * triangle + (edge + 1) % 3]);
        const auto s = static_cast<float>(share);
        const Vec3f sum = p * (1.0F - s) + q * s;
        // Opposite normals can cancel.
        if (dot(sum, sum) > 1e-6F) return normalize(sum);
    }
    const Mesh::Triangle& corners = mesh->triangles[triangle];
    const Vec3d a = to_double(mesh->vertices[corners[0]]);
    const Vec3d b = to_double(mesh->vertices[corners[1]]);
    const Vec3d c = to_double(mesh->vertices[corners[2]]);
    return to_float(normalize(cross(b - a, c - a)));
}

}  // namespace ink
