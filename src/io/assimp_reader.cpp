#include "io/assimp_reader.h"

#include <assimp/MemoryIOWrapper.h>
#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/text.h"
#include "io/file_text.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

/// A material library beside a model, as far as Assimp asked for one.
struct Library {
    std::string wanted;  ///< first name asked for; empty: none
    bool found = false;
};

/// What Assimp may open: the model, from memory, and material libraries near it.
class Files : public Assimp::IOSystem {
  public:
    Files(std::string model, std::string_view text, Path folder, Library& library)
        : model_(std::move(model)), text_(text), folder_(std::move(folder)), library_(library) {}

    bool Exists(const char* name) const override {
        return name == model_ || library_path(name).has_value();
    }
    char getOsSeparator() const override { return '/'; }
    Assimp::IOStream* Open(const char* name, const char* /*mode*/) override {
        if (name == model_) return stream(text_);
        if (library_.wanted.empty()) library_.wanted = Path(name).filename().string();
        const std::optional<Path> path = library_path(name);
        if (!path) return nullptr;
        library_.found = true;
        library_text_ = read_text(*path);
        return stream(library_text_);
    }
    void Close(Assimp::IOStream* stream) override { delete stream; }

  private:
    static Assimp::IOStream* stream(std::string_view text) {
        return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(text.data()),
                                          text.size());
    }

    /// The names in a model are a stranger's: nothing outside its folder is opened.
    std::optional<Path> library_path(const char* name) const {
        const Path path = Path(name).lexically_normal();
        const Path below = path.lexically_relative(folder_.lexically_normal());
        if (below.empty() || *below.begin() == ".." ||
            to_lower(path.extension().string()) != ".mtl")
            return std::nullopt;
        std::error_code error;
        return std::filesystem::is_regular_file(path, error) ? std::optional(path) : std::nullopt;
    }

    std::string model_;
    std::string_view text_;
    std::string library_text_;
    Path folder_;
    Library& library_;
};

Rgb8 to_rgb8(float r, float g, float b) {
    // Written so that NaN becomes 0.
    const auto byte = [](float x) {
        return static_cast<std::uint8_t>(x > 0.f ? std::lround(std::min(x, 1.f) * 255.f) : 0);
    };
    return {byte(r), byte(g), byte(b)};
}

Vec3f to_vec(const aiVector3D& v) { return {v.x, v.y, v.z}; }

std::span<const aiMesh* const> meshes_of(const aiScene& scene) {
    return {scene.mMeshes, scene.mNumMeshes};
}

template <class Has>
bool all_meshes(const aiScene& scene, const Has& has) {
    return std::ranges::all_of(meshes_of(scene), has);
}

std::string part_name(const aiScene& scene, const aiMesh& mesh, std::size_t number) {
    if (mesh.mName.length > 0) return mesh.mName.C_Str();
    if (mesh.mMaterialIndex < scene.mNumMaterials) {
        const aiString name = scene.mMaterials[mesh.mMaterialIndex]->GetName();
        if (name.length > 0) return name.C_Str();
    }
    return fmt::format("part {}", number + 1);
}

/// False when a coordinate is not usable.
bool add_vertices(const aiMesh& mesh, bool normals, bool colors, PolygonMesh& into) {
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
        if (!into.add_position(to_double(to_vec(mesh.mVertices[i])))) return false;
        if (normals) into.normals.push_back(to_vec(mesh.mNormals[i]));
        if (!colors) continue;
        const aiColor4D& color = mesh.mColors[0][i];
        into.colors.push_back(to_rgb8(color.r, color.g, color.b));
    }
    return true;
}

void add_faces(const aiMesh& mesh, std::size_t first_vertex, PolygonMesh& into) {
    for (const aiFace& face : std::span(mesh.mFaces, mesh.mNumFaces)) {
        for (const unsigned index : std::span(face.mIndices, face.mNumIndices)) {
            // Another mesh's vertex is as wrong as none at all.
            const std::size_t vertex =
                index < mesh.mNumVertices ? first_vertex + index : into.positions.size();
            into.corners.push_back(static_cast<std::uint32_t>(vertex));
        }
        into.end_polygon();
    }
}

std::optional<PolygonMesh> to_polygons(const aiScene& scene) {
    const bool normals = all_meshes(scene, [](const aiMesh* m) { return m->HasNormals(); });
    const bool colors = all_meshes(scene, [](const aiMesh* m) { return m->HasVertexColors(0); });
    const bool parts = scene.mNumMeshes > 1;
    PolygonMesh polygons;
    polygons.single_precision = true;
    for (const aiMesh* mesh : meshes_of(scene)) {
        const std::size_t first_vertex = polygons.positions.size();
        if (!add_vertices(*mesh, normals, colors, polygons)) return std::nullopt;
        add_faces(*mesh, first_vertex, polygons);
        if (!parts) continue;
        const std::size_t part = polygons.part_names.size();
        polygons.part_names.push_back(part_name(scene, *mesh, part));
        polygons.parts.resize(polygons.polygon_ends.size(), static_cast<std::uint32_t>(part));
    }
    return polygons;
}

/// The diffuse colour of the first material in use.
std::optional<Rgb8> material_color(const aiScene& scene) {
    for (const aiMesh* mesh : meshes_of(scene)) {
        aiColor3D color;
        if (mesh->mMaterialIndex >= scene.mNumMaterials) continue;
        const aiMaterial& material = *scene.mMaterials[mesh->mMaterialIndex];
        // Invented by Assimp for faces before the first material.
        if (material.GetName() == aiString("DefaultMaterial")) continue;
        if (material.Get(AI_MATKEY_COLOR_DIFFUSE, color) == AI_SUCCESS) {
            return to_rgb8(color.r, color.g, color.b);
        }
    }
    return std::nullopt;
}

}  // namespace

std::optional<PolygonMesh> assimp_mesh(const Path& file, std::string_view text,
                                       std::string_view extension) {
    const Path folder = std::filesystem::absolute(file).parent_path();
    const std::string model = (folder / (model_name(file) + std::string(extension))).string();
    Library library;
    Assimp::Importer importer;
    importer.SetIOHandler(new Files(model, text, folder, library));  // the importer owns it
    const aiScene* const scene = importer.ReadFile(model, 0);
    if (scene == nullptr) return std::nullopt;

    std::optional<PolygonMesh> polygons = to_polygons(*scene);
    if (!polygons) return std::nullopt;
    if (library.found) polygons->color = material_color(*scene);
    if (!library.wanted.empty() && !library.found) {
        polygons->warnings.push_back(
            fmt::format("The material library '{}' is not beside the file; its colours are left "
                        "out.",
                        library.wanted));
    }
    return polygons;
}

}  // namespace ink
