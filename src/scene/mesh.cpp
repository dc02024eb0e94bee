#include "scene/mesh.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

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

    /// Asks the cache for what `number_of` will look at.
    void prefetch(Vec3f position) const {
        __builtin_prefetch(&slots_[hash(position + Vec3f{}) & (slots_.size() - 1)]);
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

std::size_t weld(Mesh& mesh) {
    mesh.edge_flags.clear();
    const std::size_t dropped = drop_triangles_without_area(mesh);
    PositionIndex index;
    std::vector<std::uint32_t> renumbered(mesh.vertices.size(), kNone);
    std::vector<Rgb8> colors;
    constexpr std::size_t kAhead = 6;  // triangles; long enough for memory to answer
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        if (i + kAhead < mesh.triangles.size()) {
            for (const std::uint32_t vertex : mesh.triangles[i + kAhead]) {
                index.prefetch(mesh.vertices[vertex]);
            }
        }
        for (std::uint32_t& vertex : mesh.triangles[i]) {
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

}  // namespace ink
