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
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "io/child_process.h"
#include "io/file_text.h"
#include "io/obj_materials.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

/// What Assimp may open: the model, from memory, and buffers near it.
class Files : public Assimp::IOSystem {
  public:
    Files(std::string model, std::string_view text, Path folder)
        : model_(std::move(model)), text_(text), folder_(std::move(folder)) {}

    bool Exists(const char* name) const override {
        return name == model_ || buffer_path(name).has_value();
    }
    char getOsSeparator() const override { return '/'; }
    Assimp::IOStream* Open(const char* name, const char* /*mode*/) override {
        if (name == model_) return stream(text_);
        const std::optional<Path> path = buffer_path(name);
        if (!path) return nullptr;
        texts_.push_back(std::make_unique<std::string>(read_text(*path)));
        return stream(*texts_.back());
    }
    void Close(Assimp::IOStream* stream) override { delete stream; }

  private:
    static Assimp::IOStream* stream(std::string_view text) {
        return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(text.data()),
                                          text.size());
    }

    /// The names in a model are a stranger's: nothing outside its folder is opened.
    std::optional<Path> buffer_path(const char* name) const {
        const Path path = Path(name).lexically_normal();
        const Path below = path.lexically_relative(folder_.lexically_normal());
        if (below.empty() || *below.begin() == ".." ||
            to_lower(path.extension().string()) != ".bin") {
            return std::nullopt;
        }
        std::error_code error;
        return std::filesystem::is_regular_file(path, error) ? std::optional(path) : std::nullopt;
    }

    std::string model_;
    std::string_view text_;
    std::vector<std::unique_ptr<std::string>> texts_;  ///< of other files
    Path folder_;
};

Vec3f to_vec(const aiVector3D& v) { return {v.x, v.y, v.z}; }

std::span<const aiMesh* const> meshes_of(const aiScene& scene) {
    return {scene.mMeshes, scene.mNumMeshes};
}

template <class Has>
bool all_meshes(const aiScene& scene, const Has& has) {
    return std::ranges::all_of(meshes_of(scene), has);
}

/// The diffuse colour of a mesh's material, if it has one that the file gives.
std::optional<Rgb8> material_color(const aiScene& scene, const aiMesh& mesh) {
    aiColor4D color;
    if (mesh.mMaterialIndex >= scene.mNumMaterials) return std::nullopt;
    const aiMaterial& material = *scene.mMaterials[mesh.mMaterialIndex];
    // Invented by Assimp for faces before the first material.
    if (material.GetName() == aiString("DefaultMaterial")) return std::nullopt;
    if (material.Get(AI_MATKEY_BASE_COLOR, color) != AI_SUCCESS &&
        material.Get(AI_MATKEY_COLOR_DIFFUSE, color) != AI_SUCCESS) {
        return std::nullopt;
    }
    return to_rgb8({color.r, color.g, color.b});
}

/// Gathers the meshes of a scene, each where its nodes place it.
class SceneWalk {
  public:
    SceneWalk(const aiScene& scene, std::size_t most_vertices)
        : scene_(scene),
          most_vertices_(most_vertices),
          normals_(all_meshes(scene, [](const aiMesh* m) { return m->HasNormals(); })),
          colors_(all_meshes(scene, [](const aiMesh* m) { return m->HasVertexColors(0); })) {
        polygons_.single_precision = true;
        // Several materials become colours of the vertices.
        std::optional<Rgb8> first;
        for (const aiMesh* const mesh : meshes_of(scene)) {
            const std::optional<Rgb8> color = material_color(scene, *mesh);
            if (mesh == scene.mMeshes[0]) first = color;
            several_ = several_ || color != first;
        }
        several_ = several_ && !colors_;
    }

    /// Nothing when a coordinate is not usable, or there are more vertices than may be.
    std::optional<PolygonMesh> run() {
        if (scene_.mRootNode == nullptr || !add(*scene_.mRootNode, aiMatrix4x4())) {
            return std::nullopt;
        }
        if (polygons_.part_names.size() < 2) {
            polygons_.part_names.clear();
            polygons_.parts.clear();
        }
        return std::move(polygons_);
    }

  private:
    bool add(const aiNode& node, const aiMatrix4x4& above) {
        const aiMatrix4x4 placed = above * node.mTransformation;
        for (const unsigned index : std::span(node.mMeshes, node.mNumMeshes)) {
            if (index >= scene_.mNumMeshes || !add(*scene_.mMeshes[index], node, placed))
                return false;
        }
        return std::ranges::all_of(std::span(node.mChildren, node.mNumChildren),
                                   [&](const aiNode* child) { return add(*child, placed); });
    }

    bool add(const aiMesh& mesh, const aiNode& node, const aiMatrix4x4& place) {
        const std::size_t first_vertex = polygons_.positions.size();
        if (first_vertex + mesh.mNumVertices > most_vertices_) return false;
        if (!add_vertices(mesh, place)) return false;
        add_faces(mesh, first_vertex, place.Determinant() < 0.0F);
        polygons_.part_names.push_back(part_name(mesh, node));
        polygons_.parts.resize(polygons_.polygon_ends.size(),
                               static_cast<std::uint32_t>(polygons_.part_names.size() - 1));
        return true;
    }

    std::string part_name(const aiMesh& mesh, const aiNode& node) const {
        if (node.mName.length > 0) return node.mName.C_Str();
        if (mesh.mName.length > 0) return mesh.mName.C_Str();
        if (mesh.mMaterialIndex < scene_.mNumMaterials) {
            const aiString name = scene_.mMaterials[mesh.mMaterialIndex]->GetName();
            if (name.length > 0) return name.C_Str();
        }
        return fmt::format("part {}", polygons_.part_names.size() + 1);
    }

    /// False when a coordinate is not usable.
    bool add_vertices(const aiMesh& mesh, const aiMatrix4x4& place) {
        const bool moved = !place.IsIdentity();
        const std::optional<Rgb8> plain = material_color(scene_, mesh);
        aiMatrix3x3 turn(place);
        if (moved && normals_) turn.Inverse().Transpose();
        for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
            const aiVector3D position = moved ? place * mesh.mVertices[i] : mesh.mVertices[i];
            if (!polygons_.add_position(to_double(to_vec(position)))) return false;
            if (normals_) {
                polygons_.normals.push_back(
                    to_vec(moved ? turn * mesh.mNormals[i] : mesh.mNormals[i]));
            }
            if (several_) polygons_.colors.push_back(plain.value_or(Material{}.color));
            if (!colors_) continue;
            const aiColor4D& color = mesh.mColors[0][i];
            polygons_.colors.push_back(to_rgb8({color.r, color.g, color.b}));
        }
        return true;
    }

    /// A mirrored mesh has its faces turned round, so that they still face outwards.
    void add_faces(const aiMesh& mesh, std::size_t first_vertex, bool mirrored) {
        for (const aiFace& face : std::span(mesh.mFaces, mesh.mNumFaces)) {
            for (unsigned k = 0; k < face.mNumIndices; ++k) {
                const unsigned index = face.mIndices[mirrored ? face.mNumIndices - 1 - k : k];
                // Another mesh's vertex is as wrong as none at all.
                const std::size_t vertex =
                    index < mesh.mNumVertices ? first_vertex + index : kNoVertex;
                polygons_.corners.push_back(static_cast<std::uint32_t>(vertex));
            }
            polygons_.end_polygon();
        }
    }

    static constexpr std::uint32_t kNoVertex = 0xFFFFFFFFU;

    const aiScene& scene_;
    std::size_t most_vertices_;
    bool normals_;  ///< of all meshes
    bool colors_;
    bool several_ = false;  ///< meshes have materials of several colours
    PolygonMesh polygons_;
};

// ---- The way from the child ----

template <class T>
void put(std::string& bytes, const std::vector<T>& values) {
    const std::uint64_t count = values.size();
    bytes.append(reinterpret_cast<const char*>(&count), sizeof(count));
    if (count > 0) bytes.append(reinterpret_cast<const char*>(values.data()), count * sizeof(T));
}

void put(std::string& bytes, std::string_view text) {
    put(bytes, std::vector<char>(text.begin(), text.end()));
}

/// Takes values off the front of what a child sent, which may be anything.
class Parcel {
  public:
    explicit Parcel(std::string_view bytes) : rest_(bytes) {}

    template <class T>
    bool take(std::vector<T>& values) {
        std::uint64_t count = 0;
        if (rest_.size() < sizeof(count)) return false;
        std::memcpy(&count, rest_.data(), sizeof(count));
        rest_.remove_prefix(sizeof(count));
        if (count > rest_.size() / sizeof(T)) return false;
        if (count == 0) return true;
        values.resize(count);
        std::memcpy(values.data(), rest_.data(), count * sizeof(T));
        rest_.remove_prefix(count * sizeof(T));
        return true;
    }
    bool take(std::string& text) {
        std::vector<char> letters;
        if (!take(letters)) return false;
        text.assign(letters.begin(), letters.end());
        return true;
    }
    bool take(std::vector<std::string>& list) {
        std::string joined;
        if (!take(joined)) return false;
        for (std::string_view rest = joined; !rest.empty();) {
            const std::size_t end = std::min(rest.find('\0'), rest.size());
            list.emplace_back(rest.substr(0, end));
            rest.remove_prefix(std::min(end + 1, rest.size()));
        }
        return true;
    }

  private:
    std::string_view rest_;
};

std::string join(const std::vector<std::string>& list) {
    std::string joined;
    for (const std::string& entry : list) joined += entry + '\0';
    return joined;
}

std::string pack(const PolygonMesh& mesh) {
    std::string bytes;
    put(bytes, std::vector<double>{mesh.origin.x, mesh.origin.y, mesh.origin.z});
    put(bytes, mesh.positions);
    put(bytes, mesh.normals);
    put(bytes, mesh.colors);
    put(bytes, mesh.corners);
    put(bytes, mesh.polygon_ends);
    put(bytes, mesh.parts);
    put(bytes, std::vector<Rgb8>(mesh.color ? 1U : 0U, mesh.color.value_or(Rgb8{})));
    put(bytes, join(mesh.part_names));
    put(bytes, join(mesh.warnings));
    put(bytes, std::vector<std::uint64_t>{mesh.faces_read});
    return bytes;
}

bool is_complete(const PolygonMesh& mesh) {
    const auto none_or = [](std::size_t size, std::size_t whole) {
        return size == 0 || size == whole;
    };
    const auto finite = [](const Vec3f& p) {
        return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    };
    return none_or(mesh.normals.size(), mesh.positions.size()) &&
           none_or(mesh.colors.size(), mesh.positions.size()) &&
           none_or(mesh.parts.size(), mesh.polygon_ends.size()) &&
           std::ranges::all_of(mesh.parts,
                               [&](std::uint32_t p) { return p < mesh.part_names.size(); }) &&
           std::ranges::is_sorted(mesh.polygon_ends) &&
           (mesh.polygon_ends.empty() || mesh.polygon_ends.back() <= mesh.corners.size()) &&
           std::ranges::all_of(mesh.positions, finite);
}

std::optional<PolygonMesh> unpack(std::string_view bytes) {
    PolygonMesh mesh;
    std::vector<double> origin;
    std::vector<Rgb8> color;
    std::vector<std::uint64_t> faces_read;
    Parcel parcel(bytes);
    const bool whole =
        parcel.take(origin) && parcel.take(mesh.positions) && parcel.take(mesh.normals) &&
        parcel.take(mesh.colors) && parcel.take(mesh.corners) && parcel.take(mesh.polygon_ends) &&
        parcel.take(mesh.parts) && parcel.take(color) && parcel.take(mesh.part_names) &&
        parcel.take(mesh.warnings) && parcel.take(faces_read);
    if (!whole || origin.size() != 3 || faces_read.size() != 1 || !is_complete(mesh))
        return std::nullopt;
    mesh.origin = {origin[0], origin[1], origin[2]};
    if (!color.empty()) mesh.color = color[0];
    mesh.faces_read = faces_read[0];
    mesh.single_precision = true;
    return mesh;
}

/// What the child does. Empty: Assimp refused the file, or a coordinate is not usable.
std::string read_packed(const Path& file, std::string_view text, std::string_view extension) {
    const Path folder = std::filesystem::absolute(file).parent_path();
    const std::string model = (folder / (model_name(file) + std::string(extension))).string();
    Assimp::Importer importer;
    importer.SetIOHandler(new Files(model, text, folder));  // the importer owns it
    const aiScene* const scene = importer.ReadFile(model, 0);
    if (scene == nullptr) return {};

    // Copies by nodes may make a model larger than its file, but not without bound.
    constexpr std::size_t kCopies = 1000;
    const std::size_t most = std::min<std::size_t>(kCopies * text.size(), std::size_t{1} << 31);
    std::optional<PolygonMesh> polygons = SceneWalk(*scene, most).run();
    if (!polygons) return {};
    for (const aiMesh* const mesh : meshes_of(*scene)) {
        polygons->faces_read += mesh->mNumFaces;
        if (!polygons->color) polygons->color = material_color(*scene, *mesh);
    }
    return pack(*polygons);
}

}  // namespace

PolygonMesh assimp_mesh(const Path& file, std::string_view text, std::string_view extension,
                        std::string_view format) {
    ChildLimits limits;
    // Assimp holds each vertex several times over; 100 times the file is more than any needs.
    limits.memory_bytes = (std::size_t{2} << 30) + 100 * text.size();
    const ChildResult child =
        in_child_process([&] { return read_packed(file, text, extension); }, limits);
    if (child.end == ChildResult::End::too_large) {
        throw InputError(file,
                         fmt::format("takes more time or memory than a {} file of its size can "
                                     "need; export it again",
                                     format));
    }
    if (child.end == ChildResult::End::done) {
        if (std::optional<PolygonMesh> mesh = unpack(child.bytes)) {
            mesh->format = format;
            return std::move(*mesh);
        }
    }
    throw InputError(file, fmt::format("cannot be read as a {} file; export it again", format));
}

}  // namespace ink
