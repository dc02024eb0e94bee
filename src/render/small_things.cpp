#include "render/small_things.h"

#include <algorithm>
#include <array>
#include <variant>

namespace ink {

namespace {

/// Of a glyph: the middle one of its three, for a plate is wide from most sides and a rod is not.
float middle_width(const Placement& glyph) {
    std::array<float, 3> half{length(glyph.x_axis), length(glyph.y_axis), length(glyph.z_axis)};
    std::ranges::sort(half);
    return 2.0F * half[1];
}

}  // namespace

SmallThings::SmallThings(const Scene& scene, const LineIds& ids, const Camera& camera, float most,
                         float widest)
    : ids_(ids), camera_(camera), parallel_(camera.orthographic()), most_(most) {
    if (most >= 1.0F) return;
    const Projection& projection = camera.projection();
    const double step = parallel_ ? projection.origin_step : projection.slope_step;
    pixels_a_unit_ = static_cast<float>(1.0 / step);
    least_pixels_a_unit_ = pixels_at(length(camera.eye()) + length(scene.bounds().upper));
    for (std::size_t k = 0; k < scene.objects().size(); ++k) {
        objects_.push_back(things_of(scene.objects()[k], ids.level(k)));
        const Things& things = objects_.back();
        any_ = any_ || widest_line(things, least_width(things) * least_pixels_a_unit_) < widest;
    }
}

SmallThings::Things SmallThings::things_of(const Object& object, IdLevel level) {
    Things things;
    if (const auto* spheres = std::get_if<Spheres>(&object.shape)) {
        // What is made of many has the outline of all of them.
        if (level == IdLevel::primitive) things.balls = spheres;
        return things;
    }
    const auto* glyphs = std::get_if<Glyphs>(&object.shape);
    if (glyphs == nullptr) return things;
    const bool sticks = glyphs->shape.kind == GlyphKind::frustum;
    const bool solids = sticks || glyphs->shape.kind == GlyphKind::ellipsoid ||
                        glyphs->shape.kind == GlyphKind::box;
    // Sticks that are one thing are still as thin as one of them.
    if (!solids || (level != IdLevel::primitive && !sticks)) return things;
    for (const Placement& glyph : glyphs->placements) {
        things.width = std::min(things.width, middle_width(glyph));
    }
    if (sticks) things.covered = 1.0F;
    return things;
}

float SmallThings::least_width(const Things& things) {
    if (things.balls == nullptr) return things.width;
    const auto& spheres = things.balls->spheres;
    if (spheres.empty()) return kInfinity;
    return 2.0F * std::ranges::min_element(spheres, {}, &Sphere::radius)->radius;
}

float SmallThings::width_scale(GeometryId owner, Vec2f point, float t, float width_px) const {
    if (owner == kBackground) return 1.0F;
    const std::size_t object = ids_.object_of(owner);
    const Things& things = objects_[object];
    float width = things.width;
    if (things.balls != nullptr) {
        const std::size_t ball = things.balls->numbering().source(owner - ids_.first(object));
        width = 2.0F * things.balls->spheres[ball].radius;
    }
    if (widest_line(things, width * least_pixels_a_unit_) >= width_px) return 1.0F;
    const float widest =
        widest_line(things, width * pixels_at(camera_.distance_from_eye(point, t)));
    return widest < width_px ? widest / width_px : 1.0F;
}

}  // namespace ink
