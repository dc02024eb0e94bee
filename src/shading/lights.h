#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/color.h"
#include "base/vec.h"
#include "camera/camera.h"
#include "scene/scene.h"

namespace ink {

/// A light as settings and scene files give it.
struct LightRule {
    enum class Kind : std::uint8_t {
        sun,     ///< far away: all its rays run alike
        camera,  ///< the same, given as the viewer sees it
        disc,    ///< a disc in the scene that faces the scene's middle
        sky      ///< from all around, by how far a surface faces up
    };
    Kind kind = Kind::sun;
    Vec3d from{0, 0, 1};    ///< sun: direction that it shines from, world; camera: right, up,
                            ///< towards the viewer; disc: its middle, world
    double size = 0.0;      ///< sun, camera: diameter in degrees; disc: radius, world units
    double strength = 1.0;  ///< of the light on a surface that faces it; >= 0
    Rgb8 color{255, 255, 255};
    std::optional<Rgb8> ground;  ///< sky: colour from below; default: half of `color`
    friend bool operator==(const LightRule&, const LightRule&) = default;
};

/// A light in the scene frame.
struct LightSource {
    Vec3f from;  ///< unit direction towards it; or the middle of a disc
    bool is_disc = false;
    Vec3f side, up;       ///< disc: half axes; else those of the disc at distance 1 that it fills
    Color color;          ///< linear, times strength
    bool shadows = true;  ///< whether it can cast any
    bool has_size() const { return dot(side, side) > 0.0F; }
};

/// Light from all around: `middle` + `slope` * (n . up).
struct SkyLight {
    Color middle, slope;
    Vec3f up;
};

struct LightRig {
    std::vector<LightSource> sources;
    SkyLight sky;
};

/// The lights of a scene that has none of its own: a key light from the upper left, a weaker fill
/// light from the right, a rim light from behind, and light from all around. They follow the
/// camera, and together are a little below 1 where the key light falls straight on, so that no
/// colour clips. `ambient` in [0, 1] moves light from the key to the sky: 0 is the Lambert shading
/// of a studio, 1 an overcast day.
LightRig default_lights(const Camera& camera, float ambient);

/// The lights that `rules` describe. Directions of no length are taken as towards the viewer.
LightRig make_lights(const Scene& scene, const Camera& camera, const std::vector<LightRule>& rules);

}  // namespace ink
