#include "shading/stick_strings.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace ink {

namespace {

/// Radii from one ball to the next, at most.
constexpr float kApart = 0.7F;

/// Open cylinders, whose ends are within atoms.
const Glyphs* sticks_of(const Object& object) {
    const auto* glyphs = std::get_if<Glyphs>(&object.shape);
    const bool are_sticks = glyphs != nullptr && object.kind == ObjectKind::molecule &&
                            glyphs->shape.kind == GlyphKind::frustum && glyphs->shape.a == 1.0 &&
                            !glyphs->shape.capped;
    return are_sticks ? glyphs : nullptr;
}

}  // namespace

std::optional<StickStrings> StickStrings::of(const Scene& scene) {
    bool any = false;
    for (const Object& object : scene.objects()) {
        if (sticks_of(object) != nullptr) {
            any = true;
        } else if (!std::holds_alternative<Spheres>(object.shape)) {
            return {};
        }
    }
    if (!any) return {};

    StickStrings strings;
    for (const Object& object : scene.objects()) {
        const auto* shape = std::get_if<Spheres>(&object.shape);
        for (std::size_t k = 0; shape != nullptr && k < shape->count(); ++k) {
            strings.balls_.push_back(shape->at(k));
        }
    }
    for (const Object& object : scene.objects()) {
        std::vector<std::size_t>& first = strings.first_.emplace_back();
        const Glyphs* sticks = sticks_of(object);
        for (std::size_t k = 0; sticks != nullptr && k < sticks->count(); ++k) {
            first.push_back(strings.balls_.size());
            strings.add(sticks->at(k));
        }
        first.push_back(strings.balls_.size());
    }
    return strings;
}

void StickStrings::add(const Placement& stick) {
    const float radius = length(stick.x_axis);
    const float half = length(stick.z_axis);
    const float steps = std::ceil(2.0F * half / std::max(kApart * radius, 1e-6F));
    const int count = static_cast<int>(std::clamp(steps, 1.0F, 1000.0F));
    for (int k = 0; k <= count; ++k) {
        const float z = 2.0F * static_cast<float>(k) / static_cast<float>(count) - 1.0F;
        balls_.push_back({stick.origin + stick.z_axis * z, radius});
    }
}

std::size_t StickStrings::nearest(std::size_t object, std::size_t primitive, Vec3f point) const {
    const std::size_t first = first_[object][primitive];
    const std::size_t last = first_[object][primitive + 1] - 1;
    const Vec3f from = balls_[first].centre;
    const Vec3f along = balls_[last].centre - from;
    const float share = dot(point - from, along) / std::max(dot(along, along), 1e-30F);
    const auto steps = static_cast<float>(last - first);
    return first + static_cast<std::size_t>(std::clamp(share * steps + 0.5F, 0.0F, steps));
}

}  // namespace ink
