#pragma once

#include <cstdint>

#include "shading/lighting.h"

namespace ink {

/// Normals at the corners of an object's triangles, interpolated over those that lanes hit, on the
/// side of the geometric normals that `normals` holds. Lanes that hit something else are left as
/// they are. `corner_normals` are packed (pack_normal, scene/mesh.h), three a triangle.
void interpolate_normals(const std::uint32_t* corner_normals, std::uint32_t object,
                         const HitPacket& hits, NormalPacket& normals);

}  // namespace ink
