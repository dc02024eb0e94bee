#pragma once

#include <cstdint>

#include "shading/lighting.h"

namespace ink {

struct NormalLanes {
    const Lanes<float>&x, &y, &z;
};

/// Normals at the corners of an object's triangles, interpolated over those that lanes hit, on the
/// side of the `geometric` normals, which lanes that hit something else keep. `corner_normals` are
/// packed (pack_normal, scene/mesh.h), three a triangle. `normals` may be what `geometric` refers
/// to.
void interpolate_normals(const std::uint32_t* corner_normals, std::uint32_t object,
                         const HitPacket& hits, const NormalLanes& geometric,
                         NormalPacket& normals);

}  // namespace ink
