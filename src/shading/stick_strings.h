#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/vec.h"
#include "scene/scene.h"

namespace ink {

/// The sticks of molecules as strings of balls, which hide the sky as they do: where they overlap,
/// they are thinner by no more than a sixteenth.
class StickStrings {
  public:
    /// None where a scene is not of balls and sticks alone, or has no sticks.
    static std::optional<StickStrings> of(const Scene& scene);

    /// All balls of the scene, those of strings last.
    const std::vector<Sphere>& balls() const { return balls_; }
    /// The ball of a stick's string that is nearest to a point on it.
    std::size_t nearest(std::size_t object, std::size_t primitive, Vec3f point) const;

  private:
    void add(const Placement& stick);

    std::vector<Sphere> balls_;
    /// Of each object that is of sticks: the number of the first ball of each of them, and of what
    /// follows the last.
    std::vector<std::vector<std::size_t>> first_;
};

}  // namespace ink
