#include "accel/sphere_range.h"

#include <algorithm>
#include <cmath>

namespace ink {

namespace {

struct Range {
    float least, most;
};

Range operator*(Range a, Range b) {
    const auto [least, most] =
        std::minmax({a.least * b.least, a.least * b.most, a.most * b.least, a.most * b.most});
    return {least, most};
}

Range squared(Range a) {
    const Range all = a * a;
    return {a.least <= 0.0F && a.most >= 0.0F ? 0.0F : all.least, all.most};
}

/// Least value of a x^2 + b x y + c y^2, a convex form, on a rectangle.
float least_of_form(float a, float b, float c, Range x, Range y) {
    if (x.least <= 0.0F && x.most >= 0.0F && y.least <= 0.0F && y.most >= 0.0F) return 0.0F;
    const auto value = [&](float p, float q) { return p * (a * p + b * q) + c * q * q; };
    float least = kInfinity;
    for (const float side : {x.least, x.most}) {
        const float best = std::clamp(-0.5F * b * side / c, y.least, y.most);
        least = std::min(least, value(side, best));
    }
    for (const float side : {y.least, y.most}) {
        const float best = std::clamp(-0.5F * b * side / a, x.least, x.most);
        least = std::min(least, value(best, side));
    }
    return least;
}

}  // namespace

SphereRange sphere_range(const Projection& projection, const SphereForm& form,
                         const Window& window) {
    constexpr float kSlack = 1e-4F;       // of the height of the outline's form
    constexpr float kDepthSlack = 1e-5F;  // in a scene of size 1
    const Range qx{window.left, window.right};
    const Range qy{window.top, window.bottom};
    const Range dx{qx.least - form.u, qx.most - form.u};
    const Range dy{qy.least - form.v, qy.most - form.v};
    float least_h = kInfinity;  // concave: least at a corner
    for (const float x : {dx.least, dx.most}) {
        for (const float y : {dy.least, dy.most}) {
            least_h = std::min(least_h, form.f - (x * (form.a * x + form.b * y) + form.c * y * y));
        }
    }
    const float most_h = form.f - least_of_form(form.a, form.b, form.c, dx, dy);
    SphereRange range;
    range.covers = least_h > kSlack * form.f;
    range.reaches = !(most_h < -kSlack * form.f);
    if (!range.reaches) return range;

    const auto slope = static_cast<float>(projection.slope_step);
    const auto origin = static_cast<float>(projection.origin_step);
    const Range sx = Range{slope, slope} * qx;
    const Range sy = Range{slope, slope} * qy;
    const Range ox = Range{origin, origin} * qx;
    const Range oy = Range{origin, origin} * qy;
    const Range along_x = sx * Range{form.x - ox.most, form.x - ox.least};
    const Range along_y = sy * Range{form.y - oy.most, form.y - oy.least};
    const Range shortened{1.0F / (1.0F + squared(sx).most + squared(sy).most),
                          1.0F / (1.0F + squared(sx).least + squared(sy).least)};
    const Range before{form.z + along_x.least + along_y.least - std::sqrt(std::max(most_h, 0.0F)),
                       form.z + along_x.most + along_y.most - std::sqrt(std::max(least_h, 0.0F))};
    const Range depth = before * shortened;
    range.nearest = depth.least - kDepthSlack;
    range.farthest = depth.most + kDepthSlack;
    return range;
}

}  // namespace ink
