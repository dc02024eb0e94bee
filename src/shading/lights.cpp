#include "shading/lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ink {

namespace {

Color operator*(Color color, float factor) {
    return {color.r * factor, color.g * factor, color.b * factor};
}

Vec3f view_direction(const Camera& camera, float right, float up, float back) {
    return normalize(camera.right() * right + camera.up() * up + camera.back() * back);
}

/// Two unit vectors that are perpendicular to a unit vector and to each other.
void make_axes(Vec3f n, Vec3f& side, Vec3f& up) {
    side = normalize(std::abs(n.z) < 0.9F ? cross({0, 0, 1}, n) : cross({1, 0, 0}, n));
    up = cross(n, side);
}

LightSource directional(Vec3f from, float strength, Color color = {1, 1, 1},
                        double diameter_deg = 0.0) {
    LightSource light{.from = from, .side = {}, .up = {}, .color = color * strength};
    make_axes(from, light.side, light.up);
    const auto radius = static_cast<float>(std::tan(0.5 * diameter_deg * std::numbers::pi / 180.0));
    light.side = light.side * radius;
    light.up = light.up * radius;
    return light;
}

Vec3f direction_of(const Camera& camera, const LightRule& rule) {
    if (length(rule.from) == 0.0) return camera.back();
    const Vec3f v = to_float(normalize(rule.from));
    return rule.kind == LightRule::Kind::camera ? view_direction(camera, v.x, v.y, v.z) : v;
}

LightSource disc(const Scene& scene, const LightRule& rule) {
    LightSource light{.from = scene.frame().from_world(rule.from),
                      .is_disc = true,
                      .side = {},
                      .up = {},
                      .color = srgb_decode(rule.color) * static_cast<float>(rule.strength)};
    const Vec3f middle = (scene.bounds().lower + scene.bounds().upper) * 0.5F;
    const Vec3f away = light.from - middle;
    make_axes(length(away) > 0.0F ? normalize(away) : Vec3f{0, 0, 1}, light.side, light.up);
    const auto radius = static_cast<float>(rule.size / scene.frame().unit);
    light.side = light.side * radius;
    light.up = light.up * radius;
    return light;
}

void add_sky(const LightRule& rule, SkyLight& sky) {
    const auto strength = static_cast<float>(rule.strength);
    const Color above = srgb_decode(rule.color) * strength;
    const Color below = rule.ground ? srgb_decode(*rule.ground) * strength : above * 0.5F;
    const auto add = [](Color& sum, Color a, Color b, float sign) {
        sum.r += 0.5F * (a.r + sign * b.r);
        sum.g += 0.5F * (a.g + sign * b.g);
        sum.b += 0.5F * (a.b + sign * b.b);
    };
    add(sky.middle, above, below, 1.0F);
    add(sky.slope, above, below, -1.0F);
}

}  // namespace

LightRig default_lights(const Camera& camera, float ambient) {
    const auto between = [&](float studio, float overcast) {
        return ambient == 0.0F ? studio : studio + ambient * (overcast - studio);
    };
    const float middle = between(0.17F, 0.48F);
    const float slope = between(0.06F, 0.10F);
    LightRig rig;
    rig.sources = {directional(view_direction(camera, -0.45F, 0.65F, 0.75F), between(0.66F, 0.44F)),
                   directional(view_direction(camera, 0.75F, -0.1F, 0.65F), between(0.16F, 0.08F))};
    rig.sources[1].shadows = false;
    if (ambient > 0.0F) {
        rig.sources.push_back(
            directional(view_direction(camera, 0.5F, 0.55F, -0.67F), between(0.0F, 0.20F)));
        rig.sources[2].shadows = false;
    }
    rig.sky = {{middle, middle, middle}, {slope, slope, slope}, camera.up()};
    return rig;
}

LightRig make_lights(const Scene& scene, const Camera& camera,
                     const std::vector<LightRule>& rules) {
    LightRig rig;
    rig.sky.up = camera.up();
    for (const LightRule& rule : rules) {
        switch (rule.kind) {
            case LightRule::Kind::sun:
            case LightRule::Kind::camera:
                rig.sources.push_back(directional(direction_of(camera, rule),
                                                  static_cast<float>(rule.strength),
                                                  srgb_decode(rule.color), rule.size));
                break;
            case LightRule::Kind::disc: rig.sources.push_back(disc(scene, rule)); break;
            case LightRule::Kind::sky: add_sky(rule, rig.sky); break;
        }
    }
    return rig;
}

}  // namespace ink
