#include "shading/stick_borders.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace ink {

namespace {

/// Open cylinders, as bonds are.
const Glyphs* sticks_of(const Object& object) {
    const auto* glyphs = std::get_if<Glyphs>(&object.shape);
    const bool are_sticks = glyphs != nullptr && glyphs->shape.kind == GlyphKind::frustum &&
                            glyphs->shape.a == 1.0 && !glyphs->shape.capped &&
                            !glyphs->colors.empty();
    return are_sticks ? glyphs : nullptr;
}

/// Whether a stick ends where the next begins, and goes on in its direction.
bool goes_on(const Placement& a, const Placement& b) {
    constexpr float kNear = 0.02F;  // of the radius; places are rounded
    const float least = kNear * length(a.x_axis);
    return length((a.origin + a.z_axis) - (b.origin - b.z_axis)) <= least &&
           length(a.z_axis - b.z_axis) <= least;
}

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

void StickBorders::add(const Object& object,
                       const std::function<bool(std::uint32_t a, std::uint32_t b)>& mixes) {
    Halves& halves = objects_.emplace_back();
    const Glyphs* const sticks = sticks_of(object);
    if (sticks == nullptr) return;
    halves.other.resize(sticks->placements.size());
    for (std::uint32_t k = 0; k + 1 < halves.other.size(); ++k) {
        if (sticks->colors[k] == sticks->colors[k + 1] ||
            !goes_on(sticks->placements[k], sticks->placements[k + 1]) || !mixes(k, k + 1)) {
            continue;
        }
        halves.other[k] = 1;
        halves.other[++k] = -1;
        halves.sticks = sticks;
        any_ = true;
    }
}

StickBorders::Border StickBorders::border_of(const Halves& halves, std::size_t primitive) const {
    const std::size_t stored = halves.sticks->numbering().source(primitive);
    const bool is_first = halves.other[stored] > 0;
    const Placement place = halves.sticks->at(primitive);
    const Vec3f to_end = is_first ? place.z_axis : -place.z_axis;
    return {place.origin + to_end, to_end * (-1.0F / length(to_end)),
            halves.sticks->colors[is_first ? stored + 1 : stored - 1]};
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
        if (object == kNoObject || objects_[object].sticks == nullptr) continue;
        const Halves& halves = objects_[object];
        const std::uint32_t primitive = surface.hits.primitive[i];
        if (halves.other[halves.sticks->numbering().source(primitive)] == 0) continue;
        if (object != last_object || primitive != last_primitive) {
            border = border_of(halves, primitive);
            last_object = object;
            last_primitive = primitive;
        }
        const float share = beyond(border, surface, i);
        if (share <= 0.0F) continue;
        const Color other = srgb_decode(border.color);
        colors.r[i] += share * (other.r - colors.r[i]);
        colors.g[i] += share * (other.g - colors.g[i]);
        colors.b[i] += share * (other.b - colors.b[i]);
    }
}

}  // namespace ink
