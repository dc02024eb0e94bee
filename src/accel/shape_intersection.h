#pragma once

#include <optional>

#include "base/vec.h"
#include "scene/glyphs.h"

// Where rays meet exact surfaces. Everything is computed in double precision about the point of the
// ray that is nearest to the shape's middle and in units of the shape, so that neither the distance
// of the eye nor the size of a glyph costs digits.
namespace ink {

struct ShapeRay {
    Vec3d origin, dir;  ///< `dir` of any length but zero
};

struct ShapeHit {
    double t;      ///< along the ray, in lengths of `dir`
    Vec3d normal;  ///< outward (of an open surface: along its z axis), of any length
};

/// A placed unit shape made ready for many rays.
class PlacedShape {
  public:
    PlacedShape(const UnitShape& shape, const Placement& placement);

    /// The first crossing of the surface at t in [t_near, t_far).
    std::optional<ShapeHit> intersect(const ShapeRay& ray, double t_near, double t_far) const;

  private:
    UnitShape shape_;
    Vec3d origin_;
    Vec3d row_x_, row_y_, row_z_;  ///< of the inverse of the placement's linear map
    bool visible_;                 ///< the map has a volume
};

/// The first crossing of a hexahedron's faces at t in [t_near, t_far). Faces share their edges
/// without a crack: a ray that meets one of them from outside never slips through.
std::optional<ShapeHit> intersect(const Hexahedra::Corners& corners, const ShapeRay& ray,
                                  double t_near, double t_far);

}  // namespace ink
