#pragma once

#include <array>

#include "scene/scene.h"

namespace ink {

/// Smallest value of dot(normal, p) over every point p of the scene, for each of four normals.
std::array<double, 4> supports(const Scene& scene, const std::array<Vec3f, 4>& normals);

}  // namespace ink
