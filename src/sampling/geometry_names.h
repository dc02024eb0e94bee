#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/ids.h"
#include "scene/scene.h"

namespace ink {

/// What a geometry ID stands for, in words.
struct GeometryName {
    std::string object;   ///< name of the molecule, mesh or particle set
    std::string part;     ///< chain or group; empty where unknown
    std::string element;  ///< symbol, of an atom; else empty
    /// Which one of its object, from 0: primitive or part. None where the whole object is meant.
    std::optional<std::uint32_t> index;

    /// "1crn A C 17"
    std::string label() const;
};

/// The names behind the IDs of a scene, which it outlives.
class GeometryNames {
  public:
    GeometryNames() = default;
    GeometryNames(const Scene& scene, std::optional<IdLevel> level);

    /// Empty for the background.
    GeometryName operator()(GeometryId id) const;
    /// Index in the scene of the object that an ID belongs to, which must not be the background's.
    std::size_t object_of(GeometryId id) const;

  private:
    struct ObjectNames {
        GeometryId first;  ///< of the object's IDs
        IdLevel level;
        std::string name;
        std::vector<std::string> part_names;
        std::vector<Copy> copies{};
        std::size_t originals = 0;
        std::uint32_t parts_a_copy = 0;
        std::vector<std::uint32_t> parts{};    ///< of primitives
        std::vector<std::uint8_t> elements{};  ///< atomic numbers, of primitives

        CopyNumbering numbering() const { return {copies, originals, parts_a_copy}; }
    };
    std::vector<ObjectNames> objects_;
};

}  // namespace ink
