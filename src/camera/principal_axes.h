#pragma once

#include "base/vec.h"
#include "scene/scene.h"

namespace ink {

/// Directions of least to greatest spread, orthonormal and right-handed (longest x middle =
/// shortest), each turned to its file axis rather than away from it.
struct PrincipalAxes {
    Vec3d longest, middle, shortest;
    /// Neither flat nor of a clear broad side: the axes are those of the file.
    bool bulky = false;
};

/// Principal axes of the sphere centres of a scene: eigenvectors of their covariance. A scene
/// without a clear broad side (round, or a single sphere) keeps the file's axes.
PrincipalAxes principal_axes(const Scene& scene);

}  // namespace ink
