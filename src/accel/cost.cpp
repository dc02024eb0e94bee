#include "accel/cost.h"

#include <fmt/format.h>

#include <thread>
#include <variant>
#include <vector>

#include "accel/clusters.h"
#include "base/error.h"
#include "base/memory.h"

namespace ink {

namespace {

template <class T>
double size_of(const std::vector<T>& values) {
    return static_cast<double>(values.size() * sizeof(T));
}

double stored(const Spheres& s) {
    return size_of(s.spheres) + size_of(s.colors) + size_of(s.parts) + size_of(s.copies);
}
double stored(const Mesh& m) {
    return size_of(m.vertices) + size_of(m.triangles) + size_of(m.corner_normals) +
           size_of(m.line_normals) + size_of(m.colors) + size_of(m.parts) + size_of(m.faces) +
           size_of(m.edge_flags) + size_of(m.twins);
}
double stored(const Glyphs& g) {
    return size_of(g.placements) + size_of(g.colors) + size_of(g.parts) + size_of(g.copies);
}
double stored(const Hexahedra& h) {
    return size_of(h.corners) + size_of(h.colors) + size_of(h.parts);
}

/// Of a cluster: itself, its box and the boxes above, and its share in the picture's pyramid of
/// bounds (accel/screen_tracer.cpp).
constexpr double kClusterBytes = (sizeof(Cluster) + 26.0 + 22.0) / kLanes;
/// While clusters are made, each primitive has a key and its number.
constexpr double kKeyBytes = 16.0 + sizeof(std::uint32_t);

// Nanoseconds of one thread that building takes for a primitive, roughly: to warn of minutes, not
// to tell seconds. The hierarchy of glyphs is Embree's.
constexpr double kSphereNs = 150.0;
constexpr double kTriangleNs = 200.0;
constexpr double kGlyphNs = 600.0;
/// Of Embree's hierarchy over glyphs, a primitive; likewise.
constexpr double kGlyphBytes = 160.0;

/// Of more spheres and triangles than this, Embree traces pictures of usual sizes
/// (make_suited_screen_tracer). Its hierarchy takes a primitive about so much.
constexpr double kManyPrimitives = 2.0 * 1024.0 * 1024.0 * kLanes;
constexpr double kEmbreeBytes = 36.0;
constexpr double kEmbreeNs = 700.0;

/// What ambient light takes for a sphere, of tens of millions of them.
constexpr double kAmbientBytes = 45.0;
constexpr double kAmbientNs = 2000.0;

struct Build {
    double bytes, seconds;
};

Build build_of(const Spheres& s) {
    const auto once = static_cast<double>(s.spheres.size());
    const auto all = static_cast<double>(s.count());
    return {once * (sizeof(SphereLanes) / double{kLanes} + kKeyBytes) + all * kClusterBytes,
            1e-9 * kSphereNs * once};
}
Build build_of(const Mesh& m) {
    const auto count = static_cast<double>(m.triangles.size());
    const double lanes =
        sizeof(TriangleLanes) + (m.corner_normals.empty() ? 0.0 : sizeof(CornerNormals));
    return {count * (lanes / double{kLanes} + kKeyBytes + kClusterBytes),
            1e-9 * kTriangleNs * count};
}
Build build_of(const Glyphs& g) {
    const auto once = static_cast<double>(g.placements.size());
    return {once * kGlyphBytes + static_cast<double>(g.count()) * kClusterBytes,
            1e-9 * kGlyphNs * once};
}
Build build_of(const Hexahedra& h) {
    const auto count = static_cast<double>(h.corners.size());
    return {count * kGlyphBytes, 1e-9 * kGlyphNs * count};
}

}  // namespace

Cost cost_of(std::span<const Object> objects) {
    Cost cost;
    double many = 0.0;
    for (const Object& object : objects) {
        const Build build =
            std::visit([](const auto& shape) { return build_of(shape); }, object.shape);
        cost.stored_bytes +=
            std::visit([](const auto& shape) { return stored(shape); }, object.shape);
        cost.stored_bytes += size_of(object.elements);
        cost.build_bytes += build.bytes;
        cost.build_seconds += build.seconds;
        if (const auto* spheres = std::get_if<Spheres>(&object.shape)) {
            const auto count = static_cast<double>(spheres->count());
            cost.ambient_bytes += kAmbientBytes * count;
            cost.ambient_seconds += 1e-9 * kAmbientNs * count;
        }
        if (!std::holds_alternative<Glyphs>(object.shape)) {
            many += static_cast<double>(object.primitive_count());
        }
    }
    if (many > kManyPrimitives) {
        cost.build_bytes += kEmbreeBytes * many;
        cost.build_seconds += 1e-9 * kEmbreeNs * many;
    }
    const double threads = std::max(std::thread::hardware_concurrency(), 1U);
    cost.build_seconds /= threads;
    cost.ambient_seconds /= threads;
    return cost;
}

void check_memory(const Cost& cost) {
    const double free = free_memory_bytes();
    if (cost.build_bytes <= free) return;
    throw Error(
        fmt::format("the scene needs {:.2g} GB of memory more to be drawn, but {:.2g} GB "
                    "are free; draw less of it, as with --clip or --select, or use a larger "
                    "machine",
                    cost.build_bytes * 1e-9, free * 1e-9));
}

}  // namespace ink
