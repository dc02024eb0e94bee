#pragma once

#include <optional>
#include <vector>

#include "accel/tracer.h"
#include "scene/scene.h"

namespace ink {

/// Turns hits into geometry IDs at the level that matters for lines, which each object may have of
/// its own. The IDs of a level are the same however many threads or tiles there are.
class LineIds {
  public:
    /// `level` for every object; by default particles and atoms are told apart one by one and a
    /// mesh is one object.
    LineIds(const Scene& scene, std::optional<IdLevel> level);

    void resolve(const HitPacket& hits, Lanes<GeometryId>& ids) const;
    GeometryId resolve(std::uint32_t object, std::uint32_t primitive) const;

  private:
    struct ObjectIds {
        GeometryId first;      ///< of the object's IDs
        std::uint32_t stride;  ///< 1: every primitive has its own; 0: they share one
        const std::vector<std::uint32_t>* groups = nullptr;  ///< instead: an offset a primitive
    };
    std::vector<ObjectIds> objects_;
};

}  // namespace ink
