#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "accel/tracer.h"
#include "base/color.h"
#include "base/lanes.h"
#include "camera/camera.h"
#include "scene/scene.h"
#include "shading/ambient.h"
#include "shading/depth_cue.h"
#include "shading/lighting.h"
#include "shading/lights.h"
#include "shading/material_rules.h"
#include "shading/primitive_colors.h"
#include "shading/shadows.h"
#include "shading/stick_borders.h"

namespace ink {

enum class ShadeMode : std::uint8_t {
    lambert,  ///< diffuse, two-sided (the paper's)
    toon,     ///< the same in four steps
    gooch,    ///< from cool to warm towards the key light (Gooch et al. 1998)
    flat,     ///< surface colour without light
    none      ///< everything in the background's colour
};

struct ShadingSettings {
    ShadeMode mode = ShadeMode::lambert;
    /// Share of light that comes from all around, occluded; [0, 1]. Default: see shows_clefts.
    std::optional<float> ambient;
    int ambient_quality = 3;  ///< of ambient occlusion, [1, kMostAmbientQuality]
    ShadowMode shadows = ShadowMode::none;
    std::vector<LightRule> lights;  ///< empty: default_lights
    std::vector<MaterialRule> materials;
    float pastel = 0.0F;  ///< share of white in every surface's colour, [0, 1]
    float fog = 0.0F;     ///< share of the background in what is farthest, [0, 1]
    Rgb8 background{255, 255, 255};
    bool transparent_background = false;
    NormalSource normals = NormalSource::automatic;  ///< of lines, where an object has no own
};

/// The mean of several packets: sum them, then scale.
void add(const ColorPacket& colors, ColorPacket& sum);
void scale(ColorPacket& colors, float factor);

/// What each object looks like, laid out for shading.
class Shader {
  public:
    /// `tracer` answers shadow rays. Throws UsageError where a material is for no object.
    Shader(const Scene& scene, const Tracer& tracer, const Camera& camera,
           const ShadingSettings& settings);

    /// What the shares of light from all around are asked for; null: everything lies open.
    void use(const AmbientOcclusion* ambient) { ambient_ = ambient; }

    /// Smooths the borders of colour on sticks where no line runs along them that would do so:
    /// `ids` has the level of each object. A sample stands for a square of `spacing` pixels.
    void smooth_sticks(const Scene& scene, const Camera& camera, float spacing,
                       std::span<const IdLevel> ids);

    /// Colours of what a packet saw. Normals must be of unit length and face the viewer. False
    /// where all of it is background.
    bool shade(const SurfacePacket& surface, ColorPacket& colors) const;
    /// The same, from geometric normals.
    bool shade(const RayPacket& rays, const PointPacket& points, const HitPacket& hits,
               ColorPacket& colors) const;
    /// Whether colours follow from which primitives were hit and their normals, so that hits need
    /// no more than these.
    bool needs_normals_only() const {
        return open_ && (ambient_ == nullptr || ambient_->needs_normals_only()) && fog_ <= 0.0F &&
               !any_vertex_colors_ && !stick_borders_;
    }
    /// If so, of a block of points, or a strip.
    bool shade(const HitPacket& hits, const NormalPacket& normals, bool is_strip,
               ColorPacket& colors) const;
    /// How bright the surface is for the light that falls on it, whatever its colour: 1 where the
    /// brightest light falls straight on. Where modes of shading know no light, 1.
    void brightness(const SurfacePacket& surface, Lanes<float>& bright) const;
    /// Shading normals: interpolated where a mesh has normals at its corners, else geometric.
    void smooth(const HitPacket& hits, NormalPacket& normals) const;
    /// Normals that creases are found by, see NormalSource.
    void line_normals(const HitPacket& hits, NormalPacket& normals) const;
    /// Whether `line_normals` differ from what `smooth` gives for any object.
    bool has_line_normals() const { return any_line_normals_; }

    /// Whether a lane's colour depends on what the lanes beside it saw.
    bool compares_neighbours() const { return mode_ == ShadeMode::toon; }

    /// Asks the cache for what shading these hits will read, to be called a few packets ahead.
    void prefetch(const HitPacket& hits) const;

    const ColorPacket& background() const { return background_; }
    const DepthCue& depth_cue() const { return depth_cue_; }

  private:
    struct Surface {
        Color color;
        float specular = 0.0F, roughness = 1.0F, metal = 0.0F;
        PrimitiveColors primitives{};
        const Rgb8* vertex_colors = nullptr;
        const Mesh::Triangle* triangles = nullptr;
        const std::uint32_t* corner_normals = nullptr;  ///< three a triangle
        const std::uint32_t* line_normals = nullptr;    ///< likewise; null: geometric
    };
    static Color surface_color(const Surface& surface, const HitPacket& hits, int lane);
    void look_up_colors(const HitPacket& hits, std::uint32_t object, ColorLanes& colors) const;
    void look_up_gloss(const HitPacket& hits, Gloss& gloss) const;
    void illuminate(const SurfacePacket& surface, const ColorLanes& base, ColorLanes& lit) const;
    void add_fog(const SurfacePacket& surface, ColorLanes& lit) const;
    void whiten(ColorLanes& base) const;
    static void finish(const HitPacket& hits, const ColorLanes& lit, const ColorPacket& background,
                       ColorPacket& colors);
    void add_surface(const Object& object, const ResolvedMaterial& material, NormalSource usual);
    /// `source` is one of a surface's two arrays of normals.
    void interpolate(const HitPacket& hits, const std::uint32_t* Surface::*source,
                     NormalPacket& normals) const;
    std::vector<Surface> surfaces_;
    bool any_smooth_ = false;        ///< has normals at corners
    bool any_line_normals_ = false;  ///< has line normals other than its corner normals
    bool any_vertex_colors_ = false;
    bool any_gloss_ = false;  ///< has highlights or metal
    ShadeMode mode_;
    float pastel_;
    LightRig lights_;
    bool open_ = false;  ///< surfaces only scatter light, and nothing keeps it from them
    Shadows shadows_;
    std::optional<StickBorders> stick_borders_;
    const AmbientOcclusion* ambient_ = nullptr;
    DepthCue depth_cue_;
    float fog_;
    Color background_color_;
    ColorPacket background_;
};

}  // namespace ink
