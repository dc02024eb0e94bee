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
    NormalSource normals = NormalSource::automatic;  ///< of lines, where an object has no own
};

/// Linear colour, premultiplied by alpha.
struct ColorPacket {
    Lanes<float> r, g, b, a;
};

struct NormalPacket {
    Lanes<float> x, y, z;
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

    /// Colours of what a packet saw. Normals must be of unit length and face the viewer. False
    /// where all of it is background.
    bool shade(const HitPacket& hits, ColorPacket& colors) const;
    /// The same, from normals that `smooth` has made.
    bool shade(const HitPacket& hits, const NormalPacket& normals, ColorPacket& colors) const;
    /// Shading normals: interpolated where a mesh has normals at its corners, else geometric.
    void smooth(const HitPacket& hits, NormalPacket& normals) const;
    /// Normals that creases are found by, see NormalSource.
    void line_normals(const HitPacket& hits, NormalPacket& normals) const;
    /// Whether `line_normals` differ from what `smooth` gives for any object.
    bool has_line_normals() const { return any_line_normals_; }

    /// Asks the cache for what shading these hits will read, to be called a few packets ahead.
    void prefetch(const HitPacket& hits) const;

    const ColorPacket& background() const { return background_; }

  private:
    struct Surface {
        Color color;
        const Rgb8* primitive_colors = nullptr;
        const Rgb8* vertex_colors = nullptr;
        const Mesh::Triangle* triangles = nullptr;
        const std::uint32_t* corner_normals = nullptr;  ///< three a triangle
        const std::uint32_t* line_normals = nullptr;    ///< likewise; null: geometric
    };
    struct Lighting {
        Vec3f key_dir, fill_dir, up;
        float key, fill, ambient_middle, ambient_slope;
        float toon_steps;  ///< 0: smooth
    };

    static Color surface_color(const Surface& surface, const HitPacket& hits, int lane);
    void look_up_colors(const HitPacket& hits, std::uint32_t object, ColorPacket& colors) const;
    /// `source` is one of a surface's two arrays of normals.
    void interpolate(const HitPacket& hits, const std::uint32_t* Surface::*source,
                     NormalPacket& normals) const;
    /// For the lanes that hit `object`.
    static void interpolate_normals(const std::uint32_t* corner_normals, std::uint32_t object,
                                    const HitPacket& hits, NormalPacket& normals);
    static void illuminate(const HitPacket& hits, const NormalPacket& normals,
                           const Lighting& lighting, const ColorPacket& background,
                           ColorPacket& colors);

    std::vector<Surface> surfaces_;
    bool any_smooth_ = false;        ///< has normals at corners
    bool any_line_normals_ = false;  ///< has line normals other than its corner normals
    ShadeMode mode_;
    Lighting lighting_{};
    ColorPacket background_;
};

}  // namespace ink
