#include "shading/stick_borders.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace ink {

namespace {

/// Share of a square of side 1 in which a linear function is positive that is `value` in its middle
/// and changes by `x` and `y`, neither negative, from side to side.
float share_beside(float value, float x, float y) {
    const float most = std::max(x, y);
    const float least = std::min(x, y);
    const float far = 0.5F * (most + least) - std::abs(value);  // from the last corner
    if (far <= 0.0F) return value > 0.0F ? 1.0F : 0.0F;
    const float corner = far * far / (2.0F * most * std::max(least, 1e-6F * most));
    if (far < least) return value > 0.0F ? 1.0F - corner : corner;
    return 0.5F + value / most;
}

}  // namespace

/// Between a half and its other one.
struct StickBorders::Border {
    Vec3f middle;
    Vec3f into;  ///< the half, unit
    Rgb8 color;  ///< of the other one
};

StickBorders::StickBorders(const Projection& projection, float spacing)
    : spacing_(spacing),
      right_(to_float(projection.right)),
      down_(to_float(projection.down)),
      forward_(to_float(projection.forward)),
      start_(to_float(projection.start)),
      start_depth_(static_cast<float>(projection.start_depth)),
      origin_step_(static_cast<float>(projection.origin_step)),
      slope_step_(static_cast<float>(projection.slope_step)) {}

void StickBorders::add(const Glyphs* glyphs, IdLevel ids) {
    const bool smooths =
        glyphs != nullptr && !glyphs->other_half.empty() && ids != IdLevel::primitive;
    objects_.push_back({smooths ? glyphs : nullptr, ids == IdLevel::part});
    any_ |= smooths;
}

std::size_t StickBorders::other_half(const Sticks& sticks, std::size_t stored) {
    const std::vector<std::uint32_t>& parts = sticks.glyphs->parts;
    const std::size_t other = stored + static_cast<std::size_t>(sticks.glyphs->other_half[stored]);
    return sticks.by_parts && parts[stored] != parts[other] ? stored : other;
}

StickBorders::Border StickBorders::border_of(const Glyphs& glyphs, std::size_t primitive,
                                             std::size_t other) {
    const Placement place = glyphs.at(primitive);
    const bool is_first = glyphs.numbering().source(primitive) < other;
    const Vec3f to_end = is_first ? place.z_axis : -place.z_axis;
    return {place.origin + to_end, to_end * (-1.0F / length(to_end)), glyphs.colors[other]};
}

/// Share of a lane's pixel that lies beyond the border of the half that it hit.
float StickBorders::beyond(const Border& border, const SurfacePacket& surface, int lane) const {
    // Farther away no border cuts a pixel: where the surface turns away more than this, pixels are
    // narrow but for the outline, which is not ours.
    constexpr float kLeastCosine = 0.2F;
    constexpr float kFar = 6.0F;
    const RayPacket& rays = surface.rays;
    const Vec3f dir{rays.dir_x[lane], rays.dir_y[lane], rays.dir_z[lane]};
    const Vec3f point = Vec3f{rays.origin_x[lane], rays.origin_y[lane], rays.origin_z[lane]} +
                        dir * surface.hits.t[lane];
    const float inside = dot(point - border.middle, border.into);
    const float depth = dot(point - start_, forward_) + start_depth_;
    const float pixel =
        spacing_ * (slope_step_ > 0.0F ? slope_step_ * std::abs(depth) : origin_step_);
    if (!(std::abs(inside) < kFar * pixel)) return 0.0F;
    // By how much `inside` changes from pixel to pixel, on the plane that touches the surface.
    const Vec3f normal{surface.normals.x[lane], surface.normals.y[lane], surface.normals.z[lane]};
    const float cosine = std::max(-dot(normal, dir), kLeastCosine);
    const float along = dot(border.into, dir) / cosine;
    const auto change = [&](Vec3f step) {
        return std::abs(pixel * (dot(border.into, step) + along * dot(normal, step)));
    };
    return 1.0F - share_beside(inside, change(right_), change(down_));
}

void StickBorders::mix(const SurfacePacket& surface, ColorLanes& colors) const {
    std::uint32_t last_object = kNoObject;
    std::uint32_t last_primitive = kNoObject;
    Border border{};
    for (int i = 0; i < kLanes; ++i) {
        const std::uint32_t object = surface.hits.object[i];
        if (object == kNoObject || objects_[object].glyphs == nullptr) continue;
        const Glyphs& glyphs = *objects_[object].glyphs;
        const std::uint32_t primitive = surface.hits.primitive[i];
        const std::size_t stored = glyphs.numbering().source(primitive);
        const std::size_t other = other_half(objects_[object], stored);
        if (other == stored) continue;
        if (object != last_object || primitive != last_primitive) {
            border = border_of(glyphs, primitive, other);
            last_object = object;
            last_primitive = primitive;
        }
        const float share = beyond(border, surface, i);
        if (share <= 0.0F) continue;
        const Color color = srgb_decode(border.color);
        colors.r[i] += share * (color.r - colors.r[i]);
        colors.g[i] += share * (color.g - colors.g[i]);
        colors.b[i] += share * (color.b - colors.b[i]);
    }
}

}  // namespace ink
