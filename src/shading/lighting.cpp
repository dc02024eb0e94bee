#include "shading/lighting.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/multiversion.h"

namespace ink {

namespace {

/// Towards a light from a lane's point, unit.
INKTRACE_INLINE Vec3f direction_to(const LightSource& light, const SurfacePacket& surface, int i) {
    if (!light.is_disc) return light.from;
    const float t = surface.hits.object[i] == kNoObject ? 0.0F : surface.hits.t[i];
    const float x = light.from.x - (surface.rays.origin_x[i] + t * surface.rays.dir_x[i]);
    const float y = light.from.y - (surface.rays.origin_y[i] + t * surface.rays.dir_y[i]);
    const float z = light.from.z - (surface.rays.origin_z[i] + t * surface.rays.dir_z[i]);
    const float scale = 1.0F / std::sqrt(std::max(x * x + y * y + z * z, 1e-20F));
    return {x * scale, y * scale, z * scale};
}

INKTRACE_INLINE float along(const NormalPacket& normals, int i, Vec3f d) {
    return normals.x[i] * d.x + normals.y[i] * d.y + normals.z[i] * d.z;
}

INKTRACE_INLINE void multiply_lanes(const ColorLanes& a, const ColorLanes& b, ColorLanes& product) {
    for (int i = 0; i < kLanes; ++i) {
        product.r[i] = a.r[i] * b.r[i];
        product.g[i] = a.g[i] * b.g[i];
        product.b[i] = a.b[i] * b.b[i];
    }
}

/// Everything is open.
struct AllOpen {
    float operator[](int /*lane*/) const { return 1.0F; }
};

INKTRACE_INLINE Color color_at(Color color, int /*lane*/) { return color; }
INKTRACE_INLINE Color color_at(const ColorLanes& colors, int i) {
    return {colors.r[i], colors.g[i], colors.b[i]};
}

/// What the sky and all lights give to surfaces that scatter it, as far as they lie open; the
/// arithmetic is that of add_sky and add_diffuse. A sum of its own, which the compiler knows to be
/// apart from the normals.
template <class Openness>
INKTRACE_INLINE ColorLanes open_light(const LightRig& lights, const NormalPacket& normals,
                                      const Openness& open) {
    ColorLanes sum;
    const SkyLight sky = lights.sky;
    for (int i = 0; i < kLanes; ++i) {
        const float up = along(normals, i, sky.up);
        sum.r[i] = (sky.middle.r + sky.slope.r * up) * open[i];
        sum.g[i] = (sky.middle.g + sky.slope.g * up) * open[i];
        sum.b[i] = (sky.middle.b + sky.slope.b * up) * open[i];
    }
    for (const LightSource& light : lights.sources) {
        const Vec3f from = light.from;
        const Color color = light.color;
        for (int i = 0; i < kLanes; ++i) {
            const float falls = std::max(along(normals, i, from), 0.0F) * cleft_light(open[i]);
            sum.r[i] += color.r * falls;
            sum.g[i] += color.g * falls;
            sum.b[i] += color.b * falls;
        }
    }
    return sum;
}

INKTRACE_INLINE ColorLanes open_light(const LightRig& lights, const NormalPacket& normals,
                                      const Lanes<float>* open) {
    return open == nullptr ? open_light(lights, normals, AllOpen{})
                           : open_light(lights, normals, *open);
}

/// What hits get, and what the background shows elsewhere.
template <class Base>
INKTRACE_INLINE void put_pixels(const HitPacket& hits, const Base& base, const ColorLanes& light,
                                const ColorPacket& background, ColorPacket& __restrict colors) {
    for (int i = 0; i < kLanes; ++i) {
        const bool miss = hits.object[i] == kNoObject;
        const Color own = color_at(base, i);
        colors.r[i] = miss ? background.r[i] : own.r * light.r[i];
        colors.g[i] = miss ? background.g[i] : own.g * light.g[i];
        colors.b[i] = miss ? background.b[i] : own.b * light.b[i];
        colors.a[i] = miss ? background.a[i] : 1.0F;
    }
}

}  // namespace

INKTRACE_MULTIVERSION
void add_diffuse(const LightSource& light, const SurfacePacket& surface,
                 const Lanes<float>& visible, ColorLanes& scattered) {
    for (int i = 0; i < kLanes; ++i) {
        const Vec3f to = direction_to(light, surface, i);
        const float falls = std::max(along(surface.normals, i, to), 0.0F) * visible[i];
        scattered.r[i] += light.color.r * falls;
        scattered.g[i] += light.color.g * falls;
        scattered.b[i] += light.color.b * falls;
    }
}

INKTRACE_MULTIVERSION
void shade_open(const LightRig& lights, const NormalPacket& normals, const Lanes<float>* open,
                const ColorLanes& base, ColorLanes& lit) {
    multiply_lanes(base, open_light(lights, normals, open), lit);
}

INKTRACE_MULTIVERSION
void shade_open(const LightRig& lights, const HitPacket& hits, const NormalPacket& normals,
                const Lanes<float>* open, const ColorLanes& base, const ColorPacket& background,
                ColorPacket& __restrict colors) {
    put_pixels(hits, base, open_light(lights, normals, open), background, colors);
}

INKTRACE_MULTIVERSION
void shade_open(const LightRig& lights, const HitPacket& hits, const NormalPacket& normals,
                Color base, const ColorPacket& background, ColorPacket& __restrict colors) {
    put_pixels(hits, base, open_light(lights, normals, AllOpen{}), background, colors);
}

INKTRACE_MULTIVERSION
void add_sky(const SkyLight& sky, const SurfacePacket& surface, const Lanes<float>& open,
             ColorLanes& scattered) {
    for (int i = 0; i < kLanes; ++i) {
        const float up = along(surface.normals, i, sky.up);
        scattered.r[i] += (sky.middle.r + sky.slope.r * up) * open[i];
        scattered.g[i] += (sky.middle.g + sky.slope.g * up) * open[i];
        scattered.b[i] += (sky.middle.b + sky.slope.b * up) * open[i];
    }
}

INKTRACE_MULTIVERSION
void add_highlight(const LightSource& light, const SurfacePacket& surface, const Gloss& gloss,
                   const ColorLanes& base, const Lanes<float>& visible, ColorLanes& reflected) {
    for (int i = 0; i < kLanes; ++i) {
        const Vec3f to = direction_to(light, surface, i);
        const float x = to.x - surface.rays.dir_x[i];
        const float y = to.y - surface.rays.dir_y[i];
        const float z = to.z - surface.rays.dir_z[i];
        const float half = 1.0F / std::sqrt(std::max(x * x + y * y + z * z, 1e-12F));
        const float cosine = along(surface.normals, i, {x, y, z}) * half;
        const float alpha = gloss.roughness[i] * gloss.roughness[i];
        const float wide = alpha * alpha;
        const float lobe = wide / (cosine * cosine * (wide - 1.0F) + 1.0F);
        const float lit = along(surface.normals, i, to) > 0.0F ? 1.0F : 0.0F;
        const float strength = gloss.specular[i] * lobe * lobe * lit * visible[i];
        const float metal = gloss.metal[i];
        reflected.r[i] += light.color.r * strength * (1.0F + metal * (base.r[i] - 1.0F));
        reflected.g[i] += light.color.g * strength * (1.0F + metal * (base.g[i] - 1.0F));
        reflected.b[i] += light.color.b * strength * (1.0F + metal * (base.b[i] - 1.0F));
    }
}

INKTRACE_MULTIVERSION
void add_surroundings(const SkyLight& sky, const SurfacePacket& surface, const Gloss& gloss,
                      const ColorLanes& base, const Lanes<float>& open, ColorLanes& reflected) {
    for (int i = 0; i < kLanes; ++i) {
        const float into =
            along(surface.normals, i,
                  {surface.rays.dir_x[i], surface.rays.dir_y[i], surface.rays.dir_z[i]});
        const float up = surface.rays.dir_x[i] * sky.up.x + surface.rays.dir_y[i] * sky.up.y +
                         surface.rays.dir_z[i] * sky.up.z -
                         2.0F * into * along(surface.normals, i, sky.up);
        // From 0 below the horizon to 1 above it, within an angle that grows with roughness.
        const float soft = 0.15F + 0.85F * gloss.roughness[i];
        const float s = std::min(std::max(0.5F + 0.5F * (up - 0.1F) / soft, 0.0F), 1.0F);
        const float smooth = s * s * (3.0F - 2.0F * s);
        const float dark = 1.0F - std::abs(up);  // towards the horizon
        const float light = (0.25F + 0.80F * smooth - 0.12F * dark * (1.0F - gloss.roughness[i]));
        const float strength = gloss.metal[i] * light * open[i];
        reflected.r[i] += strength * base.r[i];
        reflected.g[i] += strength * base.g[i];
        reflected.b[i] += strength * base.b[i];
    }
}

INKTRACE_MULTIVERSION
void shade_gooch(const LightSource& light, const SurfacePacket& surface, const ColorLanes& base,
                 const Lanes<float>& open, ColorLanes& lit) {
    constexpr Color kCool{0.05F, 0.09F, 0.32F};
    constexpr Color kWarm{0.42F, 0.34F, 0.10F};
    constexpr float kCoolShare = 0.28F;
    constexpr float kWarmShare = 0.62F;
    for (int i = 0; i < kLanes; ++i) {
        const float warm = 0.5F + 0.5F * along(surface.normals, i, direction_to(light, surface, i));
        const float share = kCoolShare + (kWarmShare - kCoolShare) * warm;
        const auto tone = [&](float color, float cool, float hot) {
            return (cool + (hot - cool) * warm + share * color) * open[i];
        };
        lit.r[i] = tone(base.r[i], kCool.r, kWarm.r);
        lit.g[i] = tone(base.g[i], kCool.g, kWarm.g);
        lit.b[i] = tone(base.b[i], kCool.b, kWarm.b);
    }
}

INKTRACE_MULTIVERSION
void shade_flat(const ColorLanes& base, const Lanes<float>& open, ColorLanes& lit) {
    for (int i = 0; i < kLanes; ++i) {
        lit.r[i] = base.r[i] * open[i];
        lit.g[i] = base.g[i] * open[i];
        lit.b[i] = base.b[i] * open[i];
    }
}

INKTRACE_MULTIVERSION
void multiply(const ColorLanes& base, const ColorLanes& scattered, ColorLanes& lit) {
    multiply_lanes(base, scattered, lit);
}

INKTRACE_MULTIVERSION
void add_reflected(const ColorLanes& base, const ColorLanes& scattered, const Gloss& gloss,
                   const ColorLanes& reflected, ColorLanes& lit) {
    for (int i = 0; i < kLanes; ++i) {
        const float share = 1.0F - gloss.metal[i];
        lit.r[i] = base.r[i] * scattered.r[i] * share + reflected.r[i];
        lit.g[i] = base.g[i] * scattered.g[i] * share + reflected.g[i];
        lit.b[i] = base.b[i] * scattered.b[i] * share + reflected.b[i];
    }
}

INKTRACE_MULTIVERSION
void mix(ColorLanes& colors, float share, Color other) {
    for (int i = 0; i < kLanes; ++i) {
        colors.r[i] += share * (other.r - colors.r[i]);
        colors.g[i] += share * (other.g - colors.g[i]);
        colors.b[i] += share * (other.b - colors.b[i]);
    }
}

namespace {

/// How much brightness changes from a lane to the one beside or below it in a 4 x 4 block, over a
/// pixel; 0 if the two see different surfaces or are not neighbours.
float change(const SurfacePacket& surface, const Lanes<float>& bright, int i, int other) {
    constexpr float kFarthest = 1.5F;     // pixels
    constexpr float kSameSurface = 0.5F;  // cosine between normals
    const HitPacket& hits = surface.hits;
    const float x = surface.points.x[i] - surface.points.x[other];
    const float y = surface.points.y[i] - surface.points.y[other];
    const float distance = std::sqrt(x * x + y * y);
    const Vec3f n{surface.normals.x[other], surface.normals.y[other], surface.normals.z[other]};
    if (hits.object[i] != hits.object[other] || distance <= 0.0F || distance > kFarthest ||
        along(surface.normals, i, n) < kSameSurface) {
        return 0.0F;
    }
    return (bright[i] - bright[other]) / distance;
}

/// The tone that a brightness is drawn in, `blur` apart from which it is that tone alone.
float tone(float bright, float blur) {
    constexpr std::array kTones{0.10F, 0.34F, 0.64F, 0.92F};
    constexpr std::array kBorders{0.17F, 0.42F, 0.68F};
    float found = kTones[0];
    for (std::size_t k = 0; k < kBorders.size(); ++k) {
        const float past = (bright - kBorders[k]) / blur + 0.5F;
        found += (kTones[k + 1] - kTones[k]) * std::min(std::max(past, 0.0F), 1.0F);
    }
    return found;
}

}  // namespace

void posterize(const SurfacePacket& surface, ColorLanes& scattered) {
    constexpr float kSharpest = 1e-4F;
    constexpr float kSoftest = 0.1F;
    Lanes<float> bright;
    for (int i = 0; i < kLanes; ++i) {
        bright[i] = std::max({scattered.r[i], scattered.g[i], scattered.b[i]});
    }
    for (int i = 0; i < kLanes; ++i) {
        if (bright[i] <= 0.0F) continue;
        const float across = change(surface, bright, i, i ^ 1);
        const float down = change(surface, bright, i, i ^ 4);
        const float blur =
            std::min(std::max(std::sqrt(across * across + down * down), kSharpest), kSoftest);
        const float step = tone(bright[i], blur);
        if (scattered.r[i] == bright[i] && scattered.g[i] == bright[i] &&
            scattered.b[i] == bright[i]) {
            scattered.r[i] = scattered.g[i] = scattered.b[i] = step;
            continue;
        }
        scattered.r[i] *= step / bright[i];
        scattered.g[i] *= step / bright[i];
        scattered.b[i] *= step / bright[i];
    }
}

INKTRACE_MULTIVERSION
void darken(const Lanes<float>& shares, ColorLanes& scattered) {
    for (int i = 0; i < kLanes; ++i) {
        scattered.r[i] *= shares[i];
        scattered.g[i] *= shares[i];
        scattered.b[i] *= shares[i];
    }
}

}  // namespace ink
