#include "scene/mesh.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "base/memory.h"
#include "base/parallel.h"
#include "scene/mesh_topology.h"

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

/// Finds positions that are bitwise equal, of those whose hashes fall to this share of the work.
class PositionShare {
  public:
    /// Shares are a power of two.
    PositionShare(const std::vector<Vec3f>& vertices, std::size_t share, std::size_t shares)
        : vertices_(vertices), share_(share), share_mask_(shares - 1) {
        // As a soup of triangles needs, which has six times as many corners as positions. A table
        // that grows when it must stays in cache longer than one made for the worst case.
        slots_.resize(std::bit_ceil(std::max<std::size_t>(vertices.size() / (4 * shares), 1024)));
    }

    /// Of each vertex of this share the first one at its position.
    void find_firsts(std::vector<std::uint32_t>& firsts) {
        std::array<Entry, kBlock> block;
        for (std::size_t begin = 0; begin < vertices_.size(); begin += kBlock) {
            const std::size_t count = collect(begin, block);
            for (std::size_t i = 0; i < count; ++i) firsts[block[i].vertex] = first_at(block[i]);
        }
    }

  private:
    static constexpr std::size_t kBlock = 64;
    /// A vertex with the low half of its hash, which tells almost all others apart.
    struct Entry {
        std::uint32_t tag = 0;
        std::uint32_t vertex = kNone;
    };

    static std::uint64_t hash(Vec3f p) {
        std::uint64_t h = std::bit_cast<std::uint32_t>(p.x);
        h = (h ^ std::bit_cast<std::uint32_t>(p.y)) * 0x9e3779b97f4a7c15u;
        h = (h ^ (h >> 32) ^ std::bit_cast<std::uint32_t>(p.z)) * 0xbf58476d1ce4e5b9u;
        h = (h ^ (h >> 29)) * 0x94d049bb133111ebu;
        return h ^ (h >> 32);
    }

    /// The next vertices of this share. Asks the cache for what `first_at` will look at.
    std::size_t collect(std::size_t begin, std::array<Entry, kBlock>& block) const {
        const std::size_t end = std::min(begin + kBlock, vertices_.size());
        std::size_t count = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint64_t h = hash(vertices_[i] + Vec3f{});  // -0 + 0 is 0
            block[count] = {static_cast<std::uint32_t>(h), static_cast<std::uint32_t>(i)};
            __builtin_prefetch(&slots_[block[count].tag & (slots_.size() - 1)]);
            count += (h >> 56U & share_mask_) == share_ ? 1 : 0;
        }
        return count;
    }

    std::uint32_t first_at(Entry entry) {
        const std::size_t mask = slots_.size() - 1;
        std::size_t i = entry.tag & mask;
        for (; slots_[i].vertex != kNone; i = (i + 1) & mask) {
            const Entry known = slots_[i];
            if (known.tag == entry.tag && vertices_[known.vertex] == vertices_[entry.vertex]) {
                return known.vertex;
            }
        }
        slots_[i] = entry;
        if (++used_ * 2 > slots_.size()) grow();
        return entry.vertex;
    }

    void grow() {
        const std::vector<Entry> old = std::exchange(slots_, std::vector<Entry>(2 * slots_.size()));
        const std::size_t mask = slots_.size() - 1;
        for (const Entry& entry : old) {
            if (entry.vertex == kNone) continue;
            std::size_t i = entry.tag & mask;
            while (slots_[i].vertex != kNone) i = (i + 1) & mask;
            slots_[i] = entry;
        }
    }

    const std::vector<Vec3f>& vertices_;
    std::size_t share_, share_mask_;
    std::vector<Entry> slots_;  ///< the size is a power of two
    std::size_t used_ = 0;
};

/// Of each vertex the first one at the same position, which may be itself. Every thread reads all
/// positions, and keeps its own share of them.
std::vector<std::uint32_t> firsts_at_positions(const std::vector<Vec3f>& vertices) {
    constexpr std::size_t kWorthSharing = 1 << 15;
    constexpr unsigned kMostShares = 16;
    const unsigned shares =
        vertices.size() < kWorthSharing
            ? 1U
            : std::bit_ceil(std::min(static_cast<unsigned>(hardware_threads()), kMostShares));
    std::vector<std::uint32_t> firsts;
    reserve_large(firsts, vertices.size());
    firsts.resize(vertices.size());
    parallel_ranges(shares, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t share = begin; share < end; ++share) {
            PositionShare(vertices, share, shares).find_firsts(firsts);
        }
    });
    return firsts;
}

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

bool all_have_area(const Mesh& mesh) {
    constexpr std::size_t kGrain = 1 << 15;
    std::atomic<bool> all = true;
    parallel_ranges(mesh.triangles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (area_vector(mesh, mesh.triangles[i]) == Vec3d{}) all = false;
        }
    });
    return all;
}

std::size_t drop_triangles_without_area(Mesh& mesh) {
    if (all_have_area(mesh)) return 0;
    const std::vector<std::uint32_t> kept = triangles_with_area(mesh);
    const std::size_t dropped = mesh.triangles.size() - kept.size();
    keep(mesh.triangles, kept);
    keep(mesh.faces, kept);
    keep(mesh.parts, kept);
    keep(mesh.corner_normals, kept);
    keep(mesh.line_normals, kept);
    return dropped;
}

}  // namespace

bool has_area(const Mesh& mesh, const Mesh::Triangle& triangle) {
    return area_vector(mesh, triangle) != Vec3d{};
}

std::size_t weld(Mesh& mesh) {
    mesh.edge_flags.clear();
    mesh.twins.clear();
    const std::size_t dropped = drop_triangles_without_area(mesh);
    const std::vector<std::uint32_t> firsts = firsts_at_positions(mesh.vertices);
    std::vector<std::uint32_t> numbers;  // of first vertices
    reserve_large(numbers, firsts.size());
    numbers.resize(firsts.size(), kNone);
    std::vector<Vec3f> positions;
    std::vector<Rgb8> colors;
    for (Mesh::Triangle& triangle : mesh.triangles) {
        for (std::uint32_t& vertex : triangle) {
            std::uint32_t& number = numbers[firsts[vertex]];
            if (number == kNone) {
                number = static_cast<std::uint32_t>(positions.size());
                positions.push_back(mesh.vertices[vertex] + Vec3f{});
                if (!mesh.colors.empty()) colors.push_back(mesh.colors[vertex]);
            }
            vertex = number;
        }
    }
    mesh.vertices = std::move(positions);
    mesh.colors = std::move(colors);
    return dropped;
}

}  // namespace ink
