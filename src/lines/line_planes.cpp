#include "lines/line_planes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace ink {

namespace {

constexpr float kHalfDiagonal = 0.7072F;  // of a pixel

float distance_to(const Segment& segment, Vec2f p) {
    const Vec2f d = segment.b - segment.a;
    const Vec2f r = p - segment.a;
    const float squared = d.x * d.x + d.y * d.y;
    const float along = squared > 0.0F ? (r.x * d.x + r.y * d.y) / squared : 0.0F;
    const Vec2f off = r - d * std::clamp(along, 0.0F, 1.0F);
    return std::sqrt(off.x * off.x + off.y * off.y);
}

}  // namespace

void LinePlanes::begin(int x0, int y0, int width, int height) {
    x0_ = x0;
    y0_ = y0;
    width_ = width;
    height_ = height;
    const std::size_t size = index(0, height);
    distance_.assign(size, std::numeric_limits<float>::infinity());
    t_.assign(size, std::numeric_limits<float>::infinity());
    for (auto* plane : {&type_, &near_id_, &far_id_, &level_}) plane->assign(size, 0);
}

void LinePlanes::add(const Segment& segment, float width) {
    const float reach = 0.5F * width + kHalfDiagonal;
    const auto first = [&](float a, float b, int origin) {
        return std::max(static_cast<int>(std::floor(std::min(a, b) - reach)) - origin, 0);
    };
    const auto last = [&](float a, float b, int origin, int size) {
        return std::min(static_cast<int>(std::floor(std::max(a, b) + reach)) - origin, size - 1);
    };
    const GeometryId far = segment.left == segment.owner ? segment.right : segment.left;
    const Line line{segment.t, segment.type, segment.owner, far, segment.level};
    for (int y = first(segment.a.y, segment.b.y, y0_);
         y <= last(segment.a.y, segment.b.y, y0_, height_); ++y) {
        for (int x = first(segment.a.x, segment.b.x, x0_);
             x <= last(segment.a.x, segment.b.x, x0_, width_); ++x) {
            const float distance = distance_to(
                segment, {static_cast<float>(x0_ + x) + 0.5F, static_cast<float>(y0_ + y) + 0.5F});
            add(x, y, distance, width, line);
        }
    }
}

void LinePlanes::add(int x, int y, float distance, float width, const Line& line) {
    if (distance >= 0.5F * width + kHalfDiagonal) return;
    const auto type = static_cast<std::uint32_t>(line.type) + 1;
    const std::size_t k = index(x, y);
    distance_[k] = std::min(distance_[k], distance);
    // In an order of its own, so that it does not depend on that of the segments.
    if (type_[k] != 0 && std::tie(t_[k], type_[k], near_id_[k], far_id_[k], level_[k]) <=
                             std::tie(line.t, type, line.near, line.far, line.level)) {
        return;
    }
    t_[k] = line.t;
    type_[k] = type;
    near_id_[k] = line.near;
    far_id_[k] = line.far;
    level_[k] = line.level;
}

}  // namespace ink
