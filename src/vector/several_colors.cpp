#include "vector/several_colors.h"

#include <cstdint>
#include <unordered_map>
#include <variant>

namespace ink {

namespace {

/// Remembers the first colour of each geometry.
class FirstColors {
  public:
    /// Whether the geometry has had another colour before.
    bool differs(GeometryId geometry, Rgb8 color) {
        return first_.try_emplace(geometry, color).first->second != color;
    }

  private:
    std::unordered_map<GeometryId, Rgb8> first_;
};

bool mixes(const Mesh& mesh, std::uint32_t object, const LineIds& ids, FirstColors& seen) {
    for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k) {
        const GeometryId id = ids.resolve(object, k);
        for (const std::uint32_t vertex : mesh.triangles[k]) {
            if (seen.differs(id, mesh.colors[vertex])) return true;
        }
    }
    return false;
}

/// Of atoms, sticks, particles. Copies have the colours of what they are copied from.
template <class Primitives>
bool mixes(const Primitives& shape, std::uint32_t object, const LineIds& ids, FirstColors& seen) {
    if (ids.level(object) == IdLevel::primitive) return false;
    for (std::uint32_t k = 0; k < shape.colors.size(); ++k) {
        if (seen.differs(ids.resolve(object, k), shape.colors[k])) return true;
    }
    return false;
}

}  // namespace

bool has_geometry_of_several_colors(const Scene& scene, const LineIds& ids) {
    FirstColors seen;
    for (std::uint32_t k = 0; k < scene.objects().size(); ++k) {
        const bool mixed = std::visit(
            [&](const auto& shape) { return !shape.colors.empty() && mixes(shape, k, ids, seen); },
            scene.objects()[k].shape);
        if (mixed) return true;
    }
    return false;
}

}  // namespace ink
