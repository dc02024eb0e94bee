// glTF 2.0 and its binary form, by Assimp.

#include <algorithm>
#include <array>

#include "base/error.h"
#include "io/assimp_reader.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/polygon_mesh.h"

namespace ink {

namespace {

FileContents read_gltf(const std::filesystem::path& file, const ReadOptions& /*options*/) {
    const std::string text = read_text(file);
    // Whatever the name says: a GLB file begins with its magic.
    const bool binary = std::string_view(text).starts_with("glTF");
    return mesh_contents(file, assimp_mesh(file, text, binary ? ".glb" : ".gltf", "glTF"));
}

}  // namespace

Reader gltf_reader() {
    static constexpr std::array<std::string_view, 2> kExtensions{"gltf", "glb"};
    return {"glTF", kExtensions, read_gltf};
}

}  // namespace ink
