#include "shading/shading.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "base/multiversion.h"
#include "shading/smooth_normals.h"

namespace ink {

namespace {

constexpr std::uint32_t kSeveralObjects = kNoObject - 1;

/// The object that all rays of a packet hit, if they hit anything.
std::uint32_t shared_object(const HitPacket& hits) {
    static_assert(kNoObject + 1 == 0);
    std::uint32_t least = kNoObject;
    std::uint32_t after = 0;  // the largest one
    for (int i = 0; i < kLanes; ++i) {
        const std::uint32_t object = hits.object[i];
        const std::uint32_t next = object + 1;
        least = object < least ? object : least;
        after = next > after ? next : after;
    }
    return after == 0 || least + 1 == after ? least : kSeveralObjects;
}

/// By this share it dims tones.
constexpr float kToonClefts = 0.75F;

}  // namespace

INKTRACE_MULTIVERSION
void add(const ColorPacket& colors, ColorPacket& sum) {
    for (int i = 0; i < kLanes; ++i) {
        sum.r[i] += colors.r[i];
        sum.g[i] += colors.g[i];
        sum.b[i] += colors.b[i];
        sum.a[i] += colors.a[i];
    }
}

INKTRACE_MULTIVERSION
void scale(ColorPacket& colors, float factor) {
    for (int i = 0; i < kLanes; ++i) {
        colors.r[i] *= factor;
        colors.g[i] *= factor;
        colors.b[i] *= factor;
        colors.a[i] *= factor;
    }
}

Shader::Shader(const Scene& scene, const Tracer& tracer, const Camera& camera,
               const ShadingSettings& settings)
    : mode_(settings.mode),
      pastel_(settings.pastel),
      lights_(settings.lights.empty() ? default_lights(camera, settings.ambient.value_or(0.0F))
                                      : make_lights(scene, camera, settings.lights)),
      shadows_(tracer, settings.shadows),
      depth_cue_(scene, camera),
      fog_(settings.fog) {
    const std::vector<ResolvedMaterial> materials = resolve_materials(scene, settings.materials);
    for (std::size_t k = 0; k < materials.size(); ++k) {
        add_surface(scene.objects()[k], materials[k], settings.normals);
    }
    open_ = mode_ == ShadeMode::lambert && !any_gloss_ &&
            std::ranges::none_of(lights_.sources, [&](const LightSource& light) {
                return light.is_disc || (light.shadows && shadows_.any());
            });
    background_color_ = srgb_decode(settings.background);
    const Color color = background_color_;
    const float alpha = settings.transparent_background ? 0.0F : 1.0F;
    background_.r.fill(color.r * alpha);
    background_.g.fill(color.g * alpha);
    background_.b.fill(color.b * alpha);
    background_.a.fill(alpha);
}

void Shader::add_surface(const Object& object, const ResolvedMaterial& material,
                         NormalSource usual) {
    Surface surface{.color = srgb_decode(material.color),
                    .specular = material.specular,
                    .roughness = material.roughness,
                    .metal = material.metal};
    if (!std::holds_alternative<Mesh>(object.shape)) {
        const auto& colors = std::visit(
            [](const auto& s) -> auto& { return s.colors; }, object.shape);
        const CopyNumbering numbers = numbering(object.shape);
        if (!colors.empty()) surface.primitives.colors = colors.data();
        if (!numbers.copies.empty()) {
            surface.primitives.a_copy = static_cast<std::uint32_t>(numbers.originals);
        }
    } else {
        const auto& mesh = std::get<Mesh>(object.shape);
        surface.triangles = mesh.triangles.data();
        if (!mesh.colors.empty()) surface.vertex_colors = mesh.colors.data();
        if (!mesh.corner_normals.empty()) surface.corner_normals = mesh.corner_normals[0].data();
        const NormalSource source = object.normals.value_or(usual);
        const bool own = source == NormalSource::automatic && !mesh.line_normals.empty();
        surface.line_normals = own ? mesh.line_normals[0].data() : surface.corner_normals;
        if (source == NormalSource::geometric) surface.line_normals = nullptr;
    }
    if (material.uniform) {
        surface.primitives = {};
        surface.vertex_colors = nullptr;
    }
    any_vertex_colors_ |= surface.vertex_colors != nullptr;
    any_smooth_ |= surface.corner_normals != nullptr || surface.line_normals != nullptr;
    any_line_normals_ |= surface.line_normals != surface.corner_normals;
    any_gloss_ |= material.specular > 0.0F || material.metal > 0.0F;
    surfaces_.push_back(surface);
}

void Shader::smooth_sticks(const Scene& scene, const Camera& camera, float spacing,
                           std::span<const IdLevel> ids) {
    stick_borders_.emplace(camera.projection(), spacing);
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
        const bool colored = surfaces_[k].primitives.colors != nullptr;
        stick_borders_->add(colored ? std::get_if<Glyphs>(&scene.objects()[k].shape) : nullptr,
                            ids[k]);
    }
    if (!stick_borders_->any()) stick_borders_.reset();
}

bool Shader::shade(const RayPacket& rays, const PointPacket& points, const HitPacket& hits,
                   ColorPacket& colors) const {
    NormalPacket normals;
    smooth(hits, normals);
    return shade({rays, points, hits, normals}, colors);
}

bool Shader::shade(const SurfacePacket& surface, ColorPacket& colors) const {
    const std::uint32_t object = shared_object(surface.hits);
    if (object == kNoObject || mode_ == ShadeMode::none) {
        colors = background_;
        return object != kNoObject;
    }
    ColorLanes base;
    look_up_colors(surface.hits, object, base);
    if (stick_borders_) stick_borders_->mix(surface, base);
    whiten(base);
    ColorLanes lit;
    illuminate(surface, base, lit);
    if (fog_ > 0.0F) add_fog(surface, lit);
    finish(surface.hits, lit, background_, colors);
    return true;
}

bool Shader::shade(const HitPacket& hits, const NormalPacket& normals, bool is_strip,
                   ColorPacket& colors) const {
    const std::uint32_t object = shared_object(hits);
    if (object == kNoObject) {
        colors = background_;
        return false;
    }
    if (ambient_ == nullptr && object != kSeveralObjects &&
        surfaces_[object].primitives.colors == nullptr && pastel_ <= 0.0F) {
        shade_open(lights_, hits, normals, surfaces_[object].color, background_, colors);
        return true;
    }
    ColorLanes base;
    look_up_colors(hits, object, base);
    whiten(base);
    Lanes<float> open;
    if (ambient_ != nullptr) ambient_->openness(hits, normals, is_strip, open);
    shade_open(lights_, hits, normals, ambient_ != nullptr ? &open : nullptr, base, background_,
               colors);
    return true;
}

/// Colours of surfaces before light falls on them.
void Shader::whiten(ColorLanes& base) const {
    if (pastel_ > 0.0F) mix(base, pastel_, {1, 1, 1});
}

void Shader::smooth(const HitPacket& hits, NormalPacket& normals) const {
    if (any_smooth_) return interpolate(hits, &Surface::corner_normals, normals);
    normals = {hits.normal_x, hits.normal_y, hits.normal_z};
}

void Shader::line_normals(const HitPacket& hits, NormalPacket& normals) const {
    if (any_smooth_) return interpolate(hits, &Surface::line_normals, normals);
    normals = {hits.normal_x, hits.normal_y, hits.normal_z};
}

void Shader::prefetch(const HitPacket& hits) const {
    if (!any_smooth_) return;
    const std::uint32_t object = shared_object(hits);
    if (object == kNoObject) return;
    if (object != kSeveralObjects) {
        const std::uint32_t* normals = surfaces_[object].corner_normals;
        if (normals == nullptr) return;
        for (int i = 0; i < kLanes; ++i) {
            const std::uint32_t primitive = hits.object[i] == kNoObject ? 0 : hits.primitive[i];
            __builtin_prefetch(normals + std::size_t{3} * primitive);
        }
        return;
    }
    for (int i = 0; i < kLanes; ++i) {
        const auto* normals =
            hits.object[i] == kNoObject ? nullptr : surfaces_[hits.object[i]].corner_normals;
        if (normals != nullptr) __builtin_prefetch(normals + std::size_t{3} * hits.primitive[i]);
    }
}

Color Shader::surface_color(const Surface& surface, const HitPacket& hits, int lane) {
    const std::uint32_t primitive = hits.primitive[lane];
    if (surface.primitives.colors != nullptr) return decode(surface.primitives.of(primitive));
    if (surface.vertex_colors == nullptr) return surface.color;

    const Mesh::Triangle& corners = surface.triangles[primitive];
    const Color a = decode(surface.vertex_colors[corners[0]]);
    const Color b = decode(surface.vertex_colors[corners[1]]);
    const Color c = decode(surface.vertex_colors[corners[2]]);
    const float u = hits.u[lane];
    const float v = hits.v[lane];
    const float w = 1.0F - u - v;
    return {w * a.r + u * b.r + v * c.r, w * a.g + u * b.g + v * c.g, w * a.b + u * b.b + v * c.b};
}

namespace {

/// In registers as wide as those that read it: a wide load waits for narrow stores.
INKTRACE_MULTIVERSION
void fill(Color color, ColorLanes& colors) {
    for (int i = 0; i < kLanes; ++i) {
        colors.r[i] = color.r;
        colors.g[i] = color.g;
        colors.b[i] = color.b;
    }
}

}  // namespace

void Shader::look_up_colors(const HitPacket& hits, std::uint32_t object, ColorLanes& colors) const {
    if (object != kSeveralObjects && surfaces_[object].vertex_colors == nullptr) {
        const Surface& surface = surfaces_[object];
        if (surface.primitives.colors == nullptr) return fill(surface.color, colors);
        return look_up(surface.primitives, hits, colors);
    }
    // Neighbours mostly hit the same primitive.
    std::uint32_t last_object = kNoObject;
    std::uint32_t last_primitive = kNoObject;
    Color color;
    for (int i = 0; i < kLanes; ++i) {
        const std::uint32_t own = hits.object[i];
        const bool varies = own != kNoObject && surfaces_[own].vertex_colors != nullptr;
        if (varies || own != last_object || hits.primitive[i] != last_primitive) {
            color = own == kNoObject ? Color{} : surface_color(surfaces_[own], hits, i);
            last_object = own;
            last_primitive = hits.primitive[i];
        }
        colors.r[i] = color.r;
        colors.g[i] = color.g;
        colors.b[i] = color.b;
    }
}

void Shader::interpolate(const HitPacket& hits, const std::uint32_t* Surface::*source,
                         NormalPacket& normals) const {
    const std::uint32_t object = shared_object(hits);
    const bool several = object == kSeveralObjects;
    if (object != kNoObject && !several && surfaces_[object].*source != nullptr) {
        // Straight from the hits: what has just been copied could not be read at once.
        const NormalLanes geometric{hits.normal_x, hits.normal_y, hits.normal_z};
        return interpolate_normals(surfaces_[object].*source, object, hits, geometric, normals);
    }
    normals = {hits.normal_x, hits.normal_y, hits.normal_z};
    if (!several) return;
    for (std::uint32_t k = 0; k < surfaces_.size(); ++k) {
        const std::uint32_t* packed = surfaces_[k].*source;
        const bool seen = std::ranges::find(hits.object, k) != hits.object.end();
        if (!seen || packed == nullptr) continue;
        interpolate_normals(packed, k, hits, {normals.x, normals.y, normals.z}, normals);
    }
}

void Shader::look_up_gloss(const HitPacket& hits, Gloss& gloss) const {
    for (int i = 0; i < kLanes; ++i) {
        const Surface surface = hits.object[i] == kNoObject ? Surface{} : surfaces_[hits.object[i]];
        gloss.specular[i] = surface.specular;
        gloss.roughness[i] = surface.roughness;
        gloss.metal[i] = surface.metal;
    }
}

/// Surface colour times the light that is scattered, and what is reflected.
void Shader::illuminate(const SurfacePacket& surface, const ColorLanes& base,
                        ColorLanes& lit) const {
    if (open_ && ambient_ == nullptr) {
        return shade_open(lights_, surface.normals, nullptr, base, lit);
    }
    Lanes<float> open = Lanes<float>::filled(1.0F);
    if (ambient_ != nullptr) ambient_->openness(surface, open);
    if (open_) return shade_open(lights_, surface.normals, &open, base, lit);
    if (mode_ == ShadeMode::flat) return shade_flat(base, open, lit);
    if (mode_ == ShadeMode::gooch) {
        return shade_gooch(lights_.sources.front(), surface, base, open, lit);
    }
    // Tones follow the light alone; clefts are laid over them, without steps.
    Lanes<float> clefts = Lanes<float>::filled(1.0F);
    if (mode_ == ShadeMode::toon && ambient_ != nullptr) {
        for (int i = 0; i < kLanes; ++i) clefts[i] = 1.0F - kToonClefts * (1.0F - open[i]);
        open.fill(1.0F);
    }
    Gloss gloss;
    if (any_gloss_) look_up_gloss(surface.hits, gloss);

    ColorLanes scattered{};
    ColorLanes reflected{};
    add_sky(lights_.sky, surface, open, scattered);
    if (any_gloss_) add_surroundings(lights_.sky, surface, gloss, base, open, reflected);
    for (const LightSource& light : lights_.sources) {
        Lanes<float> visible = Lanes<float>::filled(1.0F);
        if (light.shadows && shadows_.any()) {
            shadows_.visible(light, surface, visible);
        } else if (ambient_ != nullptr) {
            for (int i = 0; i < kLanes; ++i) visible[i] = cleft_light(open[i]);
        }
        add_diffuse(light, surface, visible, scattered);
        if (any_gloss_) add_highlight(light, surface, gloss, base, visible, reflected);
    }
    if (mode_ == ShadeMode::toon) {
        posterize(surface, scattered);
        darken(clefts, scattered);
    }
    if (any_gloss_) {
        return add_reflected(base, scattered, gloss, reflected, lit);
    }
    multiply(base, scattered, lit);
}

namespace {

/// Of linear Rec. 709, which sRGB is.
float luminance(Color color) { return 0.2126F * color.r + 0.7152F * color.g + 0.0722F * color.b; }

}  // namespace

void Shader::brightness(const SurfacePacket& surface, Lanes<float>& bright) const {
    bright.fill(1.0F);
    if (mode_ == ShadeMode::flat || mode_ == ShadeMode::none) return;
    Lanes<float> open = Lanes<float>::filled(1.0F);
    if (ambient_ != nullptr) ambient_->openness(surface, open);
    ColorLanes scattered{};
    add_sky(lights_.sky, surface, open, scattered);
    float brightest = 0.0F;
    for (const LightSource& light : lights_.sources) {
        Lanes<float> visible = Lanes<float>::filled(1.0F);
        if (light.shadows && shadows_.any()) shadows_.visible(light, surface, visible);
        add_diffuse(light, surface, visible, scattered);
        brightest = std::max(brightest, luminance(light.color));
    }
    const float full = luminance(lights_.sky.middle) + brightest;
    if (full <= 0.0F) return;
    for (int i = 0; i < kLanes; ++i) {
        bright[i] = luminance({scattered.r[i], scattered.g[i], scattered.b[i]}) / full;
    }
}

void Shader::add_fog(const SurfacePacket& surface, ColorLanes& lit) const {
    for (int i = 0; i < kLanes; ++i) {
        const float t = surface.hits.object[i] == kNoObject ? 0.0F : surface.hits.t[i];
        const float share =
            fog_ * depth_cue_({surface.rays.origin_x[i] + t * surface.rays.dir_x[i],
                               surface.rays.origin_y[i] + t * surface.rays.dir_y[i],
                               surface.rays.origin_z[i] + t * surface.rays.dir_z[i]});
        lit.r[i] += share * (background_color_.r - lit.r[i]);
        lit.g[i] += share * (background_color_.g - lit.g[i]);
        lit.b[i] += share * (background_color_.b - lit.b[i]);
    }
}

INKTRACE_MULTIVERSION
void Shader::finish(const HitPacket& hits, const ColorLanes& lit, const ColorPacket& background,
                    ColorPacket& colors) {
    for (int i = 0; i < kLanes; ++i) {
        const bool miss = hits.object[i] == kNoObject;
        colors.r[i] = miss ? background.r[i] : lit.r[i];
        colors.g[i] = miss ? background.g[i] : lit.g[i];
        colors.b[i] = miss ? background.b[i] : lit.b[i];
        colors.a[i] = miss ? background.a[i] : 1.0F;
    }
}

}  // namespace ink
