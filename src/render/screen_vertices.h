#pragma once

#include <cstdint>
#include <vector>

#include "accel/projection.h"
#include "base/image.h"
#include "scene/scene.h"

namespace ink {

/// Where a camera sees a point.
struct ScreenPoint {
    float x, y;   ///< pixels
    float depth;  ///< along the axis, scene units
    float width;  ///< of a pixel there, likewise; not positive behind the eye
};

ScreenPoint project(const Projection& projection, const Vec3d& position);

/// The vertices of the meshes of a scene as a camera sees them. Empty for a mesh that has many more
/// of them than the picture has pixels, most of which are not seen.
class ScreenVertices {
  public:
    ScreenVertices(const Scene& scene, const Projection& projection, Size size, int threads);

    /// Of an object's mesh; empty where they must be projected one by one.
    const std::vector<ScreenPoint>& of(std::uint32_t object) const { return points_[object]; }

  private:
    std::vector<std::vector<ScreenPoint>> points_;
};

}  // namespace ink
