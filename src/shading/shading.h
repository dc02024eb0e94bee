#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "accel/tracer.h"
#include "base/color.h"
#include "base/lanes.h"
#include "camera/camera.h"
#include "scene/scene.h"

namespace ink {

enum class ShadeMode : std::uint8_t {
    lambert,  ///< diffuse, two-sided (the paper's)
    toon,     ///< the same in four steps
    flat,     ///< surface colour without light
    none      ///< everything in the background's colour
};

struct ShadingSettings {
    ShadeMode mode = ShadeMode::lambert;
    Rgb8 background{255, 255, 255};
    bool transparent_background = false;
};

/// Linear colour, premultiplied by alpha.
struct ColorPacket {
    Lanes<float> r, g, b, a;
};

/// The mean of several packets: sum them, then scale.
void add(const ColorPacket& colors, ColorPacket& sum);
void scale(ColorPacket& colors, float factor);

/// What each object looks like, laid out for shading. Lights follow the camera: a key light from
/// the upper left, a weaker fill light from the right, and light from all around, a little more of
/// it from above.
class Shader {
  public:
    Shader(const Scene& scene, const Camera& camera, const ShadingSettings& settings);

    /// Colours of what a packet saw. Normals must be of unit length and face the viewer. False where
    /// all of it is background.
    bool shade(const HitPacket& hits, ColorPacket& colors) const;

    const ColorPacket& background() const { return background_; }

  private:
    struct Surface {
        Color color;
        const Rgb8* primitive_colors = nullptr;
        const Rgb8* vertex_colors = nullptr;
        const Mesh::Triangle* triangles = nullptr;
        const std::uint32_t* corner_normals = nullptr;  ///< three a triangle
    };
    struct NormalPacket {
        Lanes<float> x, y, z;
    };
    struct Lighting {
        Vec3f key_dir, fill_dir, up;
        float key, fill, ambient_middle, ambient_slope;
        float toon_steps;  ///< 0: smooth
    };

    static Color surface_color(const Surface& surface, const HitPacket& hits, int lane);
    void look_up_colors(const HitPacket& hits, std::uint32_t object, ColorPacket& colors) const;
    void smooth_normals(const HitPacket& hits, std::uint32_t object, NormalPacket& normals) const;
    /// For the lanes that hit `object`.
    static void interpolate_normals(const std::uint32_t* corner_normals, std::uint32_t object,
                                    const HitPacket& hits, NormalPacket& normals);
    static void illuminate(const HitPacket& hits, const NormalPacket& normals,
                           const Lighting& lighting, const ColorPacket& background,
                           ColorPacket& colors);

    std::vector<Surface> surfaces_;
    bool any_smooth_ = false;  ///< has corner normals
    ShadeMode mode_;
    Lighting lighting_{};
    ColorPacket background_;
};

}  // namespace ink
