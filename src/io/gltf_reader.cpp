// glTF 2.0 and its binary form, by Assimp.

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "base/error.h"
#include "io/assimp_reader.h"
#include "io/byte_order.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/polygon_mesh.h"

namespace ink {

namespace {

using Path = std::filesystem::path;
using Json = nlohmann::json;

bool is_binary(std::string_view bytes) { return bytes.starts_with("glTF"); }

/// The description of the model: all of a .gltf, the first chunk of a .glb.
std::string_view json_text(std::string_view bytes) {
    constexpr std::size_t kHeader = 20;
    if (!is_binary(bytes)) return bytes;
    if (bytes.size() < kHeader) return {};
    const auto size = load<std::uint32_t>(bytes.data() + 12, is_foreign(std::endian::little));
    return bytes.substr(kHeader, size);
}

/// Nothing where the entry is not there or not of this kind.
const Json* entry(const Json& list, const Json& index) {
    if (!list.is_array() || !index.is_number_unsigned()) return nullptr;
    const auto at = index.get<std::size_t>();
    return at < list.size() ? &list[at] : nullptr;
}

const Json& member(const Json& object, const char* name) {
    static const Json kNone;
    if (!object.is_object()) return kNone;
    const auto found = object.find(name);
    return found == object.end() ? kNone : *found;
}

/// How many triangles the meshes have, if they have nothing else and it can be told.
std::optional<std::uint64_t> promised_triangles(const Json& model) {
    constexpr unsigned kTriangles = 4;
    std::uint64_t triangles = 0;
    for (const Json& mesh : member(model, "meshes")) {
        for (const Json& primitive : member(mesh, "primitives")) {
            const Json& mode = member(primitive, "mode");
            if (!mode.is_null() && mode != kTriangles) return std::nullopt;
            const Json& indices = member(primitive, "indices");
            const Json& corners =
                indices.is_null() ? member(member(primitive, "attributes"), "POSITION") : indices;
            const Json* const accessor = entry(member(model, "accessors"), corners);
            if (accessor == nullptr) return std::nullopt;
            const Json& count = member(*accessor, "count");
            if (!count.is_number_unsigned()) return std::nullopt;
            triangles += count.get<std::uint64_t>() / 3;
        }
    }
    return triangles;
}

void refuse_unknown_compression(const Path& file, const Json& model) {
    for (const Json& extension : member(model, "extensionsRequired")) {
        if (!extension.is_string()) continue;
        const auto name = extension.get<std::string>();
        if (name.find("_draco_") == std::string::npos && name.find("meshopt") == std::string::npos)
            continue;
        throw InputError(file, fmt::format("needs {}, which is not understood; export it without "
                                           "compression",
                                           excerpt(name)));
    }
}

FileContents read_gltf(const Path& file, const ReadOptions& /*options*/) {
    const std::string text = read_text(file);
    // Whether it makes sense is Assimp's to say.
    const Json model = Json::parse(json_text(text), nullptr, false);
    refuse_unknown_compression(file, model);
    // Whatever the name says: a GLB file begins with its magic.
    PolygonMesh mesh = assimp_mesh(file, text, is_binary(text) ? ".glb" : ".gltf", "glTF");
    // Assimp leaves out faces that it cannot make, without a word.
    const auto promised = promised_triangles(model);
    if (promised && mesh.faces_read < *promised) {
        throw InputError(file, fmt::format("{} of {} triangles use vertices that are not there; "
                                           "the file is damaged: export it again",
                                           *promised - mesh.faces_read, *promised));
    }
    return mesh_contents(file, std::move(mesh));
}

}  // namespace

Reader gltf_reader() {
    static constexpr std::array<std::string_view, 2> kExtensions{"gltf", "glb"};
    return {"glTF", kExtensions, read_gltf};
}

}  // namespace ink
