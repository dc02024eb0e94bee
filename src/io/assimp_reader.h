#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "io/polygon_mesh.h"

namespace ink {

/// Reads a mesh file whose bytes are `text` with Assimp, as the format of `extension` (".obj").
/// Vertices come unshared, one a corner; each group or material is a part. Assimp opens no other
/// file than a material library (.mtl) in the folder of `file` or below. Nothing is returned when
/// Assimp refuses the file or a coordinate is unusable: the caller knows the format and can say
/// where and why.
std::optional<PolygonMesh> assimp_mesh(const std::filesystem::path& file, std::string_view text,
                                       std::string_view extension);

}  // namespace ink
