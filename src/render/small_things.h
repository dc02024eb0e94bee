#pragma once

#include <vector>

#include "camera/camera.h"
#include "sampling/line_ids.h"
#include "scene/scene.h"

namespace ink {

/// Atoms, grains and sticks so small on the picture that their outlines would leave nothing of
/// them. An outline that would cover more of such a thing than lines may cover of an area gets
/// thinner, whether it stands alone or among others, where LineDensity sees to it as well.
class SmallThings {
  public:
    /// `most` is the share of an area that lines may cover (Settings::line_density); lines are no
    /// wider than `widest`, pixels. All outlive this.
    SmallThings(const Scene& scene, const LineIds& ids, const Camera& camera, float most,
                float widest);

    /// Whether the outlines of any thing get thinner.
    bool any() const { return any_; }
    /// By how much to scale the width of a line that belongs to `owner`, whose edge is seen at a
    /// point of the screen at distance t.
    float width_scale(GeometryId owner, Vec2f point, float t, float width_px) const;

  private:
    /// What of an object has outlines of its own.
    struct Things {
        const Spheres* balls = nullptr;  ///< one an ID, each of its own radius
        float width = kInfinity;         ///< else of every one, scene units
        /// Share of a thing that the half of its outline covers which lies on it, times the thing's
        /// width over the line's: 2 of a ball, 1 of a stick.
        float covered = 2.0F;
    };

    static Things things_of(const Object& object, IdLevel level);
    static float least_width(const Things& things);
    /// How wide a scene unit is on the picture.
    float pixels_at(float distance) const {
        return parallel_ ? pixels_a_unit_ : pixels_a_unit_ / distance;
    }
    /// The widest line that things of this width on the picture bear.
    float widest_line(const Things& things, float width_px) const {
        return most_ * width_px / things.covered;
    }

    const LineIds& ids_;
    const Camera& camera_;
    bool parallel_;
    float pixels_a_unit_ = 0.0F;        ///< perspective: one unit from the eye
    float least_pixels_a_unit_ = 0.0F;  ///< where the scene is farthest
    float most_;
    std::vector<Things> objects_;
    bool any_ = false;
};

}  // namespace ink
