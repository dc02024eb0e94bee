#pragma once

#include <algorithm>

#include "base/vec.h"
#include "camera/camera.h"
#include "scene/scene.h"

namespace ink {

/// How far back in the scene a point lies: 0 where the scene begins, as the viewer sees it, and 1
/// where it ends.
class DepthCue {
  public:
    DepthCue(const Scene& scene, const Camera& camera) : back_(camera.back()) {
        const Bounds3f& box = scene.bounds();
        const auto extent = [](float axis, float lower, float upper) {
            return axis > 0.0F ? Vec2f{axis * lower, axis * upper}
                               : Vec2f{axis * upper, axis * lower};
        };
        const Vec2f sum = extent(back_.x, box.lower.x, box.upper.x) +
                          extent(back_.y, box.lower.y, box.upper.y) +
                          extent(back_.z, box.lower.z, box.upper.z);
        near_ = sum.y;
        range_ = std::max(sum.y - sum.x, 1e-6F);
        scale_ = sum.y > sum.x ? 1.0F / (sum.y - sum.x) : 0.0F;
    }

    /// Of a point in the scene frame.
    float operator()(Vec3f p) const {
        const float depth = (near_ - dot(p, back_)) * scale_;
        return depth < 0.0F ? 0.0F : depth > 1.0F ? 1.0F : depth;
    }

    /// From the nearest to the farthest, scene units.
    float range() const { return range_; }

  private:
    Vec3f back_;
    float near_ = 0.0F, scale_ = 0.0F, range_ = 1.0F;
};

}  // namespace ink
