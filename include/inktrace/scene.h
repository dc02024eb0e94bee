#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "inktrace/settings.h"

namespace inktrace {

/// A quantity that atoms or particles carry, to colour by.
struct FieldInfo {
    std::string name;
    std::size_t components = 1;
    /// Of all components; greater than `most` where no value is finite, or where none was looked
    /// at.
    double least = 0.0;
    double most = 0.0;
    std::vector<std::string> words{};  ///< of a field of words: those that there are, in order
};

/// What a file held.
struct FileInfo {
    std::filesystem::path path;
    std::string format;       ///< "PDB"
    std::string kind;         ///< "molecule", "particles", "mesh" or "shape"
    std::string length_unit;  ///< "angstrom"; empty where the format does not say
    int frames = 1;
    std::vector<std::pair<std::string, std::uint64_t>> counts;  ///< ("atoms", 327), ...
    /// What can be asked for by its name: ("chains", {"A", "B"}), ("ligands", {"HEM"}), ...
    std::vector<std::pair<std::string, std::vector<std::string>>> names{};
    std::array<double, 3> lower{};  ///< bounds of what is drawn, in the file's units
    std::array<double, 3> upper{};
    std::vector<FieldInfo> fields;          ///< what atoms or particles carry
    std::uint64_t memory_bytes = 0;         ///< that drawing it takes, beside the picture
    std::optional<double> chosen_radius{};  ///< of particles whose file gives none
    /// Of the field that gives the colours, or its length where it has components: the values at
    /// the ends of the colour map.
    std::optional<std::pair<double, double>> color_range{};
    /// Of particles: the field that could tell kinds of them apart (type, material), and whether it
    /// gives the colours, because there are several.
    std::string kind_field{};
    bool has_kinds = false;
    std::vector<std::string> warnings;  ///< what was left out or guessed
};

/// What a scene will take. Estimates, from measurements.
struct SceneCost {
    std::uint64_t bytes = 0;       ///< of memory at most, to draw it, itself included
    double build_seconds = 0.0;    ///< until it is ready for rays, with all threads
    double ambient_seconds = 0.0;  ///< more, where there is ambient light
};

/// What loading keeps beside what is drawn.
struct LoadOptions {
    /// What the file says about each atom and particle, for `Renderer::pick`: memory in proportion
    /// to the file.
    bool facts = false;
};

/// Molecules, particles, meshes and shapes to draw together.
class Scene {
  public:
    Scene();
    Scene(Scene&&) noexcept;
    Scene& operator=(Scene&&) noexcept;
    ~Scene();

    /// Adds what a file holds; the format is told from the extension. `frame` counts from 0. Of a
    /// scene file, its objects: its settings are for the caller to take (scene_file_settings).
    /// Throws Error (input).
    FileInfo load(const std::filesystem::path& file, int frame = 0);
    /// The same, by settings of topic "Input": frame, selection, colours and so on. Throws Error
    /// (input) also where they name what the file does not have.
    FileInfo load(const std::filesystem::path& file, const Settings& settings,
                  const LoadOptions& options = {});

    /// Adds spheres: x, y, z, radius of each, and either no colours or r, g, b (0 to 255, sRGB) of
    /// each. Values must be finite and radii positive, else Error (input).
    void add_spheres(std::string_view name, std::span<const float> centers_and_radii,
                     std::span<const std::uint8_t> colors = {});

    /// Adds a triangle mesh: x, y, z of each vertex, three vertex indices of each triangle; `color`
    /// is sRGB. Normals are smooth but for creases. Throws Error (input) for an index or a
    /// coordinate that is not valid.
    void add_mesh(std::string_view name, std::span<const float> vertices,
                  std::span<const std::uint32_t> triangles,
                  std::array<std::uint8_t, 3> color = {204, 204, 204});

    std::size_t primitive_count() const;  ///< atoms, particles, triangles, bonds, ...
    SceneCost cost() const;

    struct Impl;  ///< the library's own
    Impl& impl() { return *impl_; }

  private:
    std::unique_ptr<Impl> impl_;
};

/// The settings that a scene file (.json) asks for, names and values in order, for `Settings::set`;
/// none of any other file. Throws Error (input), with line and key.
std::vector<std::pair<std::string, std::string>> scene_file_settings(
    const std::filesystem::path& file);

/// What a file holds, with the ranges of its fields, by settings of topic "Input". Throws Error
/// (input).
FileInfo inspect(const std::filesystem::path& file, const Settings& settings = {});

/// The formats that `Scene::load` reads, each with its extensions: ("PDB", ".pdb .ent").
std::vector<std::pair<std::string, std::string>> input_formats();

}  // namespace inktrace
