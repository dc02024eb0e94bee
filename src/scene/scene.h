#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/bounds.h"
#include "base/vec.h"
#include "scene/color_scale.h"
#include "scene/facts.h"
#include "scene/glyphs.h"
#include "scene/ids.h"
#include "scene/material.h"
#include "scene/mesh.h"
#include "scene/spheres.h"

namespace ink {

/// Where stored float coordinates lie in the world: world = origin + unit * stored. A frame near
/// the data keeps all bits of a float for the shape, however far from zero or small the file's
/// numbers are; `unit` is a power of two, so that scaling rounds nothing.
struct Frame {
    Vec3d origin;
    double unit = 1.0;

    Vec3d to_world(Vec3f stored) const { return origin + to_double(stored) * unit; }
    Vec3f from_world(Vec3d world) const { return to_float((world - origin) / unit); }
};

enum class ObjectKind : std::uint8_t { molecule, particles, mesh, shape };

using Shape = std::variant<Spheres, Mesh, Glyphs, Hexahedra>;

/// Spheres, triangles, glyphs or hexahedra.
std::size_t primitive_count(const Shape& shape);

/// How the primitives of a shape are copies of those that are stored, which is what arrays of one
/// entry each go by.
CopyNumbering numbering(const Shape& shape);

bool has_parts(const Shape& shape);
/// Which part a primitive of a shape with parts is of.
std::uint32_t part_of(const Shape& shape, std::size_t primitive);
/// The name of a part, which is "A-2" in the second copy of "A", where copies have `a_copy` parts
/// of their own each; empty where the part has none.
std::string name_of_part(std::span<const std::string> names, std::uint32_t a_copy,
                         std::uint32_t part);
/// What tells the names of a copy from those of what it copies: "-2"; empty for number 0.
std::string copy_suffix(std::size_t number);

/// One thing that was loaded or added: a molecule, a mesh, a particle set, an exact shape.
struct Object {
    std::string name;
    ObjectKind kind = ObjectKind::mesh;
    Frame frame{};  ///< of `shape`, until the object joins a scene
    Shape shape;
    Material material{};
    std::vector<std::string> part_names{};
    /// Of each part: what it is a part of itself, as residues are of a chain; or empty.
    std::vector<std::uint32_t> part_wholes{};
    std::vector<std::uint8_t> elements{};  ///< atomic numbers, one an atom; of molecules only
    /// What lines tell apart and find creases by; default: as for the picture.
    std::optional<IdLevel> ids{};
    /// What lines tell apart where neither this object nor the picture says; default: by its kind.
    std::optional<IdLevel> usual_ids{};
    /// Is of one thing with the object before it, as sticks are with the balls of a molecule: parts
    /// of one number and the whole of both share their IDs.
    bool continues_previous = false;
    std::optional<NormalSource> normals{};
    /// What the file says about a primitive; empty unless the reader was asked to keep it.
    FactSource facts{};
    std::optional<double> chosen_radius{};    ///< of particles whose file gives none
    std::optional<ColorScale> color_scale{};  ///< what its colours mean, where they mean something

    std::size_t primitive_count() const { return ink::primitive_count(shape); }
    Bounds3d world_bounds() const;
    std::string part_name(std::uint32_t part) const;
};

/// Everything there is to see, in one frame: the bounds are centred on the origin and have a half
/// diagonal in (1/2, 1].
class Scene {
  public:
    Scene() = default;
    /// Brings all objects into one frame. Their coordinates must be finite.
    explicit Scene(std::vector<Object> objects);

    const std::vector<Object>& objects() const { return objects_; }
    const Frame& frame() const { return frame_; }
    const Bounds3f& bounds() const { return bounds_; }  ///< in the scene's frame
    std::size_t primitive_count() const;
    bool empty() const { return objects_.empty(); }

  private:
    std::vector<Object> objects_;
    Frame frame_;
    Bounds3f bounds_;
};

}  // namespace ink
