#pragma once

#include <cstdint>
#include <vector>

#include "accel/projection.h"
#include "base/vec.h"
#include "sampling/mesh_crossing.h"
#include "scene/scene.h"

namespace ink {

/// Finds what lies between neighbouring points of the screen by walking across the meshes that they
/// see, from triangle to triangle along the way on the screen, until the surface turns away or
/// ends. So lines lie where edges of the mesh are, exactly, and no ray is traced. By which edge the
/// way leaves a triangle is decided by signs that belong to vertices alone, so that it never slips
/// between two triangles.
class MeshWalk {
  public:
    /// A mesh as creases of it are found.
    struct Surface {
        const Mesh* mesh = nullptr;              ///< null: nothing to walk on
        const std::uint32_t* normals = nullptr;  ///< packed, a corner; null: those of the facets
        bool creases_flagged = true;             ///< only where the mesh says so
    };

    /// `normals`: which ones creases are found by, of objects that name none of their own.
    MeshWalk(const Scene& scene, const Projection& projection, NormalSource normals);

    /// Whether there is a mesh to walk on, which knows what lies beside each of its edges.
    bool knows(std::uint32_t object) const { return surfaces_[object].mesh != nullptr; }

    /// See MeshCrossingFunction. Of the object of each key `knows` must hold, or it must be that of
    /// a miss.
    MeshCrossing cross(Vec2f from, SurfaceKey first, Vec2f to, SurfaceKey second,
                       const MeshChecks& checks, std::vector<SurfaceKey>& expected) const;

  private:
    Projection projection_;
    std::vector<Surface> surfaces_;  ///< of each object
};

}  // namespace ink
