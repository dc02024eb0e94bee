#include "scene/mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

#include "base/parallel.h"

namespace ink {

namespace {

// An odd number of codes, so that 0 has one of its own and axis-aligned normals stay exact.
constexpr float kOctahedronRadius = 32767.f;
constexpr float kHighestCode = 2.f * kOctahedronRadius;

std::uint32_t code(float coordinate) {
    const float shifted = std::floor(coordinate * kOctahedronRadius + kOctahedronRadius + 0.5f);
    return static_cast<std::uint32_t>(std::clamp(shifted, 0.f, kHighestCode));
}

}  // namespace

std::uint32_t pack_normal(Vec3f unit) {
    const Vec3f p = unit / (std::abs(unit.x) + std::abs(unit.y) + std::abs(unit.z));
    if (p.z >= 0.f) return code(p.x) | code(p.y) << 16;
    // The lower half of the octahedron is folded outwards over the edges of the upper one.
    return code(std::copysign(1.f - std::abs(p.y), p.x)) |
           code(std::copysign(1.f - std::abs(p.x), p.y)) << 16;
}

Vec3f unpack_normal(std::uint32_t packed) {
    const float x = static_cast<float>(packed & 0xffffu) - kOctahedronRadius;
    const float y = static_cast<float>(packed >> 16) - kOctahedronRadius;
    const float z = kOctahedronRadius - std::abs(x) - std::abs(y);
    const float fold = std::max(-z, 0.f);
    return normalize(Vec3f{x - std::copysign(fold, x), y - std::copysign(fold, y), z});
}

// ---- welding -----------------------------------------------------------------------------------

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Numbers distinct positions in the order in which they come.
class PositionIndex {
  public:
    PositionIndex() : slots_(1024, kNone) {}

    std::uint32_t number_of(Vec3f position) {
        const Vec3f key = position + Vec3f{};  // -0 + 0 is 0
        std::uint32_t& slot = slot_of(key);
        if (slot != kNone) return slot;
        const auto number = static_cast<std::uint32_t>(positions_.size());
        slot = number;
        positions_.push_back(key);
        // Grown as needed rather than made for the worst case: a triangle soup has six times as
        // many corners as positions, and a smaller table stays in cache.
        if (positions_.size() * 2 > slots_.size()) grow();
        return number;
    }

    std::vector<Vec3f> take_positions() { return std::move(positions_); }

  private:
    static std::uint64_t hash(Vec3f p) {
        std::uint64_t h = std::bit_cast<std::uint32_t>(p.x);
        h = (h ^ std::bit_cast<std::uint32_t>(p.y)) * 0x9e3779b97f4a7c15u;
        h = (h ^ (h >> 32) ^ std::bit_cast<std::uint32_t>(p.z)) * 0xbf58476d1ce4e5b9u;
        h = (h ^ (h >> 29)) * 0x94d049bb133111ebu;
        return h ^ (h >> 32);
    }

    std::uint32_t& slot_of(Vec3f key) {
        const std::size_t mask = slots_.size() - 1;
        std::size_t i = hash(key) & mask;
        while (slots_[i] != kNone && positions_[slots_[i]] != key) i = (i + 1) & mask;
        return slots_[i];
    }

    void grow() {
        slots_.assign(slots_.size() * 2, kNone);
        for (std::size_t i = 0; i < positions_.size(); ++i) {
            slot_of(positions_[i]) = static_cast<std::uint32_t>(i);
        }
    }

    std::vector<std::uint32_t> slots_;  ///< numbers; the size is a power of two
    std::vector<Vec3f> positions_;
};

/// Twice the area as a vector along the normal. In double, because the squares of small
/// coordinates leave the range of a float.
Vec3d area_vector(const Mesh& mesh, const Mesh::Triangle& triangle) {
    const Vec3d a = to_double(mesh.vertices[triangle[0]]);
    return cross(to_double(mesh.vertices[triangle[1]]) - a,
                 to_double(mesh.vertices[triangle[2]]) - a);
}

/// Keeps the entries of an optional per-triangle array that `kept` names, in order.
template <class T>
void keep(std::vector<T>& values, const std::vector<std::uint32_t>& kept) {
    if (values.empty()) return;
    for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
    values.resize(kept.size());
}

std::vector<std::uint32_t> triangles_with_area(const Mesh& mesh) {
    std::vector<std::uint32_t> kept;
    kept.reserve(mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        if (area_vector(mesh, mesh.triangles[i]) != Vec3d{}) {
            kept.push_back(static_cast<std::uint32_t>(i));
        }
    }
    return kept;
}

std::size_t drop_triangles_without_area(Mesh& mesh) {
    const std::vector<std::uint32_t> kept = triangles_with_area(mesh);
    const std::size_t dropped = mesh.triangles.size() - kept.size();
    if (dropped == 0) return 0;
    keep(mesh.triangles, kept);
    keep(mesh.faces, kept);
    keep(mesh.parts, kept);
    keep(mesh.corner_normals, kept);
    return dropped;
}

}  // namespace

std::size_t weld(Mesh& mesh) {
    const std::size_t dropped = drop_triangles_without_area(mesh);
    PositionIndex index;
    std::vector<std::uint32_t> renumbered(mesh.vertices.size(), kNone);
    std::vector<Rgb8> colors;
    for (Mesh::Triangle& triangle : mesh.triangles) {
        for (std::uint32_t& vertex : triangle) {
            std::uint32_t& number = renumbered[vertex];
            if (number == kNone) {
                number = index.number_of(mesh.vertices[vertex]);
                const bool first = number == colors.size();
                if (first && !mesh.colors.empty()) colors.push_back(mesh.colors[vertex]);
            }
            vertex = number;
        }
    }
    mesh.vertices = index.take_positions();
    mesh.colors = std::move(colors);
    return dropped;
}

// ---- smooth normals ----------------------------------------------------------------------------

namespace {

using Corner = std::uint32_t;  ///< 3 * triangle + position in it

/// The corners that meet in each vertex, one vertex after another.
struct CornersByVertex {
    std::vector<std::uint32_t> begin;  ///< a vertex: its first place in `corners`; and the end
    std::vector<Corner> corners;

    std::span<const Corner> of(std::size_t vertex) const {
        return std::span(corners).subspan(begin[vertex], begin[vertex + 1] - begin[vertex]);
    }
};

CornersByVertex corners_by_vertex(const Mesh& mesh) {
    CornersByVertex by_vertex;
    by_vertex.begin.assign(mesh.vertices.size() + 2, 0);
    // Counted two places ahead: filling moves every start to its end, the next vertex's start.
    for (const Mesh::Triangle& triangle : mesh.triangles) {
        for (const std::uint32_t vertex : triangle) ++by_vertex.begin[vertex + 2];
    }
    std::partial_sum(by_vertex.begin.begin(), by_vertex.begin.end(), by_vertex.begin.begin());
    by_vertex.corners.resize(mesh.triangles.size() * 3);
    Corner corner = 0;
    for (const Mesh::Triangle& triangle : mesh.triangles) {
        for (const std::uint32_t vertex : triangle) {
            by_vertex.corners[by_vertex.begin[vertex + 1]++] = corner++;
        }
    }
    by_vertex.begin.pop_back();
    return by_vertex;
}

/// A triangle's unit normal and the angles at its corners, radians.
struct Facet {
    Vec3f normal;
    std::array<float, 3> angles{};
};

double angle_between(Vec3d a, Vec3d b) {
    const double cosine = dot(a, b) / std::sqrt(dot(a, a) * dot(b, b));
    return std::acos(std::clamp(cosine, -1.0, 1.0));
}

Facet facet_of(const Mesh& mesh, const Mesh::Triangle& triangle) {
    const Vec3d area = area_vector(mesh, triangle);
    if (area == Vec3d{}) return {};
    const Vec3d a = to_double(mesh.vertices[triangle[0]]);
    const Vec3d b = to_double(mesh.vertices[triangle[1]]);
    const Vec3d c = to_double(mesh.vertices[triangle[2]]);
    const double angle_a = angle_between(b - a, c - a);
    const double angle_b = angle_between(a - b, c - b);
    return {to_float(normalize(area)),
            {static_cast<float>(angle_a), static_cast<float>(angle_b),
             static_cast<float>(std::max(0.0, std::numbers::pi - angle_a - angle_b))}};
}

std::vector<Facet> facets_of(const Mesh& mesh) {
    std::vector<Facet> facets(mesh.triangles.size());
    parallel_ranges(facets.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) facets[i] = facet_of(mesh, mesh.triangles[i]);
    });
    return facets;
}

/// Corners about one vertex that face almost the same way.
struct Wing {
    Vec3f direction;  ///< unit
    Vec3f weighted;   ///< sum of normals times angles
};

std::uint32_t smooth_normal(const Wing& own, std::span<const Wing> wings, float cos_crease) {
    Vec3f sum;
    for (const Wing& other : wings) {
        if (dot(own.direction, other.direction) > cos_crease) sum = sum + other.weighted;
    }
    const float size = length(sum);
    if (size > 0.f) return pack_normal(sum / size);
    return pack_normal(own.direction == Vec3f{} ? Vec3f{0.f, 0.f, 1.f} : own.direction);
}

/// Computes the normals of one mesh, vertex by vertex; scratch memory is kept between vertices.
class NormalSmoother {
  public:
    NormalSmoother(std::span<const Facet> facets, float cos_crease,
                   std::vector<std::array<std::uint32_t, 3>>& normals)
        : facets_(facets), cos_crease_(cos_crease), normals_(normals) {}

    void smooth(std::span<const Corner> corners) {
        // Comparing all corners with all is fastest for the handful that a vertex has, and
        // hopeless for the tip of a finely divided cone.
        constexpr std::size_t kLargestExactFan = 256;
        if (corners.size() <= kLargestExactFan) {
            smooth_each(corners);
        } else {
            smooth_by_direction(corners);
        }
    }

  private:
    Wing wing_of(Corner corner) const {
        const Facet& facet = facets_[corner / 3];
        return {facet.normal, facet.normal * facet.angles[corner % 3]};
    }

    void smooth_each(std::span<const Corner> corners) {
        wings_.clear();
        for (const Corner corner : corners) wings_.push_back(wing_of(corner));
        for (std::size_t i = 0; i < corners.size(); ++i) {
            normals_[corners[i] / 3][corners[i] % 3] =
                smooth_normal(wings_[i], wings_, cos_crease_);
        }
    }

    /// The cell of a grid of 128 x 128 directions.
    std::uint32_t direction_cell(Corner corner) const {
        const Vec3f normal = facets_[corner / 3].normal;
        return normal == Vec3f{} ? 0u : pack_normal(normal) & 0xfe00fe00u;
    }

    void smooth_by_direction(std::span<const Corner> corners) {
        std::vector<std::pair<std::uint32_t, Corner>> by_cell;
        for (const Corner corner : corners) by_cell.emplace_back(direction_cell(corner), corner);
        std::ranges::sort(by_cell);
        wings_.clear();
        for (std::size_t i = 0; i < by_cell.size(); ++i) {
            const Wing wing = wing_of(by_cell[i].second);
            if (i == 0 || by_cell[i].first != by_cell[i - 1].first) wings_.push_back({});
            wings_.back().direction = wings_.back().direction + wing.direction;
            wings_.back().weighted = wings_.back().weighted + wing.weighted;
        }
        for (Wing& wing : wings_) {
            if (wing.direction != Vec3f{}) wing.direction = normalize(wing.direction);
        }
        assign_by_cell(by_cell);
    }

    void assign_by_cell(std::span<const std::pair<std::uint32_t, Corner>> by_cell) {
        std::size_t wing = 0;
        std::uint32_t normal = smooth_normal(wings_[0], wings_, cos_crease_);
        for (std::size_t i = 0; i < by_cell.size(); ++i) {
            if (i > 0 && by_cell[i].first != by_cell[i - 1].first) {
                normal = smooth_normal(wings_[++wing], wings_, cos_crease_);
            }
            const Corner corner = by_cell[i].second;
            normals_[corner / 3][corner % 3] = normal;
        }
    }

    std::span<const Facet> facets_;
    float cos_crease_;
    std::vector<std::array<std::uint32_t, 3>>& normals_;
    std::vector<Wing> wings_;
};

}  // namespace

void smooth_normals(Mesh& mesh, float crease_angle_deg) {
    const float cos_crease = std::cos(crease_angle_deg * std::numbers::pi_v<float> / 180.f);
    const std::vector<Facet> facets = facets_of(mesh);
    const CornersByVertex by_vertex = corners_by_vertex(mesh);
    mesh.corner_normals.resize(mesh.triangles.size());
    parallel_ranges(mesh.vertices.size(), 4096, [&](std::size_t begin, std::size_t end) {
        NormalSmoother smoother(facets, cos_crease, mesh.corner_normals);
        for (std::size_t vertex = begin; vertex < end; ++vertex) {
            smoother.smooth(by_vertex.of(vertex));
        }
    });
}

}  // namespace ink
