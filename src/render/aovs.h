#pragma once

#include <optional>
#include <vector>

#include "accel/tracer.h"
#include "camera/camera.h"
#include "film/film.h"
#include "lines/line_planes.h"
#include "render/settings.h"
#include "sampling/line_ids.h"
#include "sampling/sampler.h"
#include "scene/scene.h"

namespace ink {

/// Writes what the sample rays saw, as numbers beside the picture. With several samples a pixel,
/// the first one's: identities and depths have no mean.
class AovWriter {
  public:
    /// Adds the planes of `aovs` to the film: id.primitive, id.part, id.object (0: background); Z
    /// (distance along the ray, world units); N.X, N.Y, N.Z (geometric, facing the viewer); P.X,
    /// P.Y, P.Z (world); line.A (line strength), and if `located`, what LinePlanes has: line.type,
    /// line.distance, line.id.near, line.id.far.
    AovWriter(const Scene& scene, const Camera& camera, const std::vector<Aov>& aovs, bool located,
              Film& film);

    void put(Block block, Vec2f offset, const HitPacket& hits) const;
    void put_strength(Block block, const Lanes<float>& strength) const;
    bool wants_line_planes() const { return line_planes_.has_value(); }
    /// Pixels [x0, x1) x [y0, y1), where the planes begin.
    void put_lines(int x0, int y0, int x1, int y1, const LinePlanes& lines) const;

  private:
    void put_ids(Block block, const HitPacket& hits) const;
    void put_depths(Block block, Vec2f offset, const HitPacket& hits) const;
    void put_normals(Block block, const HitPacket& hits) const;
    void put_positions(Block block, Vec2f offset, const HitPacket& hits) const;

    struct IdPlane {
        std::size_t plane;
        LineIds ids;
    };

    const Frame& frame_;
    const Camera& camera_;
    Film& film_;
    std::vector<IdPlane> ids_;
    std::optional<std::size_t> depth_, normal_, position_, lines_;  ///< first plane of each
    std::optional<std::size_t> line_planes_;
};

}  // namespace ink
