#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/tracer.h"
#include "sampling/samples.h"
#include "scene/scene.h"

namespace ink {

/// What the scene knows of the surfaces that rays hit, which spares the search for lines many rays.
class Surfaces {
  public:
    /// `normals`: which ones creases are found by, of objects that name none of their own.
    Surfaces(const Scene& scene, NormalSource normals);

    /// Adds the sphere, or the triangle and its open edge, that a hit lies on.
    void describe(const HitPacket& hits, int lane, Sample& sample) const;

    bool is_mesh(std::uint32_t object) const;

    /// See WayOutFunction. The sample must have been described.
    double way_out(const Viewpoint& viewpoint, const Sample& sample, Vec2f from, Vec2f to) const;

    /// The sphere that was hit; of radius 0 where it was none.
    Ball ball(std::uint32_t object, std::uint32_t primitive) const {
        const auto* spheres = spheres_[object];
        if (spheres == nullptr) return {};
        const Sphere sphere = spheres->at(primitive);
        return {sphere.centre, sphere.radius};
    }

    /// Of the mesh that was hit, its face; 0 elsewhere.
    std::uint32_t face(const HitPacket& hits, int lane) const;

    /// Where the line between the faces of two hits on one mesh crosses the way from screen point a
    /// to b, in [0, 1]: where the way leaves the first triangle and enters the second by edges that
    /// bound their faces; in the middle of the two if other faces lie between.
    float face_crossing(const Viewpoint& viewpoint, Vec2f a, const HitPacket& hits_a, int lane_a,
                        Vec2f b, const HitPacket& hits_b, int lane_b) const;

    /// Numbers for hits as SampleGrid::surface has them: one for each sphere or triangle.
    void number(const HitPacket& hits, Lanes<std::uint32_t>& numbers) const;

    /// Whether no line can run between two hits that are neighbours on screen: they lie on one
    /// sphere, ellipsoid, triangle, disc, face of a box, or on the side of one frustum, or on two
    /// triangles that share an edge which is no crease, and neither of which is turned away. False
    /// where that is not known.
    bool smooth_between(const HitPacket& a, int lane_a, const HitPacket& b, int lane_b) const {
        return smooth_between(a, lane_a, nullptr, b, lane_b, nullptr);
    }
    /// The same, of hits whose positions in the scene frame are known, unless null.
    bool smooth_between(const HitPacket& a, int lane_a, const Vec3f* at_a, const HitPacket& b,
                        int lane_b, const Vec3f* at_b) const;
    /// The same of many pairs by their numbers, of which each two differ: the edge across which two
    /// triangles of a mesh are smooth, or Mesh::kNoTwin for all else. The spans have equal length.
    void find_smooth_edges(const Viewpoint& viewpoint, std::span<const std::uint32_t> first,
                           std::span<const std::uint32_t> second,
                           std::span<std::uint32_t> edges) const;

  private:
    bool knows_smooth_edges(std::size_t object) const;
    bool across_smooth_edge(const Mesh& mesh, std::uint32_t a, Vec3f normal_a, std::uint32_t b,
                            Vec3f normal_b) const;

    const Scene& scene_;
    NormalSource normals_;
    std::vector<const Spheres*> spheres_;  ///< of each object; null: other shapes
    std::vector<const Mesh*> meshes_;      ///< likewise
    std::vector<std::uint32_t> numbers_;   ///< of the first primitive of each object
    std::vector<std::size_t> numbered_;    ///< objects whose primitives have numbers of their own
};

}  // namespace ink
