#pragma once

#include <cstdint>

#include "accel/tracer.h"
#include "sampling/samples.h"
#include "scene/scene.h"

namespace ink {

/// What the scene knows of the surfaces that rays hit, which spares the search for lines many rays.
class Surfaces {
  public:
    /// `normals`: which ones creases are found by, of objects that name none of their own.
    Surfaces(const Scene& scene, NormalSource normals) : scene_(scene), normals_(normals) {}

    /// The sphere that was hit from outside, if it was one.
    Ball ball(const HitPacket& hits, int lane) const;

    /// Whether no line can run between two hits that are neighbours on screen: they lie on one
    /// sphere, one triangle, or two triangles that share an edge which is no crease, and neither of
    /// which is turned away. False where that is not known.
    bool smooth_between(const HitPacket& a, int lane_a, const HitPacket& b, int lane_b) const;

  private:
    bool across_smooth_edge(const Mesh& mesh, std::uint32_t a, Vec3f normal_a, std::uint32_t b,
                            Vec3f normal_b) const;

    const Scene& scene_;
    NormalSource normals_;
};

}  // namespace ink
