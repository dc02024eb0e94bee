#pragma once

#include <optional>
#include <span>
#include <vector>

#include "accel/tracer.h"
#include "scene/scene.h"

namespace ink {

/// Turns hits into geometry IDs at the level that matters for lines, which each object may have of
/// its own. The IDs of a level are the same however many threads or tiles there are.
class LineIds {
  public:
    /// `level` for every object that names none of its own; by default particles and atoms are told
    /// apart one by one and a mesh is one object.
    LineIds(const Scene& scene, std::optional<IdLevel> level);

    /// `level` for every object, whatever it names.
    static LineIds at_level(const Scene& scene, IdLevel level);

    /// Whether all that shares an ID of this object is one ball or ellipsoid, on which there is no
    /// line: neither crease nor self-occlusion.
    bool is_ball(std::uint32_t object) const { return objects_[object].ball; }

    void resolve(const HitPacket& hits, Lanes<GeometryId>& ids) const { resolve({&hits, 1}, &ids); }
    /// The same for packet after packet.
    void resolve(std::span<const HitPacket> hits, Lanes<GeometryId>* ids) const;
    GeometryId resolve(std::uint32_t object, std::uint32_t primitive) const;

    /// Index of the object that an ID belongs to, which must not be the background's.
    std::size_t object_of(GeometryId id) const;
    /// Whether two IDs, neither the background's, are of one whole: atoms or residues of one chain,
    /// primitives of one part.
    bool of_one_whole(GeometryId a, GeometryId b) const;
    /// The first ID of an object of the scene, and at which level its own are told apart.
    GeometryId first(std::size_t object) const { return objects_[object].first; }
    IdLevel level(std::size_t object) const { return objects_[object].level; }
    /// Of all objects.
    std::vector<IdLevel> levels() const;

  private:
    LineIds() = default;
    void add(const Object& object, IdLevel level, GeometryId& next);

    struct ObjectIds {
        GeometryId first;      ///< of the object's IDs
        std::uint32_t stride;  ///< 1: every primitive has its own; 0: they share one
        const std::vector<std::uint32_t>* groups = nullptr;  ///< instead: an offset a primitive
        CopyNumbering numbers{};                             ///< of groups
        /// An ID's whole, by its offset within one copy; null where IDs are no parts of anything.
        const std::vector<std::uint32_t>* wholes = nullptr;
        bool ball = false;  ///< an ID is one sphere
        IdLevel level = IdLevel::primitive;
    };
    std::vector<ObjectIds> objects_;
};

}  // namespace ink
