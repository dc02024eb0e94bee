#pragma once

#include <span>

#include "accel/tracer.h"
#include "base/color.h"
#include "base/lanes.h"
#include "base/multiversion.h"
#include "shading/lights.h"

namespace ink {

struct ColorLanes {
    Lanes<float> r, g, b;
    void fill(Color color) {
        r.fill(color.r);
        g.fill(color.g);
        b.fill(color.b);
    }
};

/// Linear colour, premultiplied by alpha.
struct ColorPacket {
    Lanes<float> r, g, b, a;
};

/// What surfaces make of light besides scattering it: fields of Material, lane by lane.
struct Gloss {
    Lanes<float> specular, roughness, metal;
};

/// Sixteen points of surfaces, as camera rays or rays that a mirror sends on see them. Normals are
/// of unit length and face the origin of the ray.
struct SurfacePacket {
    const RayPacket& rays;
    const PointPacket& points;  ///< of the screen, through which they are seen
    const HitPacket& hits;
    const NormalPacket& normals;
};

/// Share of a light that finds its way to a surface that lies open to so much of the sky: rays that
/// graze the scene on their way to a cleft mostly do not arrive.
INKTRACE_INLINE float cleft_light(float open) {
    constexpr float kCleftShade = 0.5F;
    return 1.0F - kCleftShade * (1.0F - open);
}

/// Adds what a light gives to the scattered light: colour * max(n . l, 0), as far as `visible`.
void add_diffuse(const LightSource& light, const SurfacePacket& surface,
                 const Lanes<float>& visible, ColorLanes& scattered);

/// What the sky and all lights give to surfaces, in one go, times the surface's colour: of the sky
/// as far as they lie `open` to it, of the lights cleft_light; null: all do. No light may be a
/// disc.
void shade_open(const LightRig& lights, const NormalPacket& normals, const Lanes<float>* open,
                const ColorLanes& base, ColorLanes& lit);

/// The same straight to pixels; rays that hit nothing get the background.
void shade_open(const LightRig& lights, const HitPacket& hits, const NormalPacket& normals,
                const Lanes<float>* open, const ColorLanes& base, const ColorPacket& background,
                ColorPacket& colors);

/// The same of surfaces of one colour that all lie open.
void shade_open(const LightRig& lights, const HitPacket& hits, const NormalPacket& normals,
                Color base, const ColorPacket& background, ColorPacket& colors);

/// The sky's light, as far as surfaces lie `open` to it.
void add_sky(const SkyLight& sky, const SurfacePacket& surface, const Lanes<float>& open,
             ColorLanes& scattered);

/// Adds a light's highlight: the distribution of GGX (Walter et al. 2007) over its own maximum, so
/// that `specular` is how bright its middle is, however wide. Of metals it has the surface's
/// colour.
void add_highlight(const LightSource& light, const SurfacePacket& surface, const Gloss& gloss,
                   const ColorLanes& base, const Lanes<float>& visible, ColorLanes& reflected);

/// Adds what metals reflect of a studio without walls: bright above, dark at the horizon, dim
/// below, the softer the rougher.
void add_surroundings(const SkyLight& sky, const SurfacePacket& surface, const Gloss& gloss,
                      const ColorLanes& base, const Lanes<float>& open, ColorLanes& reflected);

/// From cool to warm as surfaces turn towards the light, each tinted by the surface's colour
/// (Gooch, Gooch, Shirley and Cohen 1998), and darker in clefts.
void shade_gooch(const LightSource& light, const SurfacePacket& surface, const ColorLanes& base,
                 const Lanes<float>& open, ColorLanes& lit);

/// The surface's colour, darker in clefts only.
void shade_flat(const ColorLanes& base, const Lanes<float>& open, ColorLanes& lit);

/// The surface's colour times the light that it scatters.
void multiply(const ColorLanes& base, const ColorLanes& scattered, ColorLanes& lit);

/// The same, of what metal does not keep from scattering, and what is reflected.
void add_reflected(const ColorLanes& base, const ColorLanes& scattered, const Gloss& gloss,
                   const ColorLanes& reflected, ColorLanes& lit);

/// Moves colours towards `other` by a share of the way.
void mix(ColorLanes& colors, float share, Color other);

/// Four tones in place of smooth shading, in the light's own hue. Where lanes of a 2 x 2 block of
/// points are a pixel apart or less, one tone passes into the next over a pixel.
void posterize(const SurfacePacket& surface, ColorLanes& scattered);

/// Takes away from light all but these shares.
void darken(const Lanes<float>& shares, ColorLanes& scattered);

}  // namespace ink
