#pragma once

#include <filesystem>
#include <string_view>

#include "io/polygon_mesh.h"

namespace ink {

/// Reads a mesh file whose bytes are `text` with Assimp, as the format of `extension` (".glb"), in
/// a child process. Vertices may come unshared, one a corner; each node is a part, in its place in
/// the scene. Assimp opens no other file than buffers (.bin) in the folder of `file` or below.
/// Throws InputError, which names `format`, where Assimp refuses the file, dies of it, or a
/// coordinate is unusable.
PolygonMesh assimp_mesh(const std::filesystem::path& file, std::string_view text,
                        std::string_view extension, std::string_view format);

}  // namespace ink
