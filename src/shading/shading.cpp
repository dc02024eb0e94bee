#include "shading/shading.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "base/multiversion.h"

namespace ink {

namespace {

/// Every 8-bit sRGB value as linear light.
Color decode(Rgb8 color) {
    static const auto kTable = [] {
        std::array<float, 256> table{};
        for (std::size_t v = 0; v < table.size(); ++v) {
            table[v] = srgb_decode(static_cast<float>(v) / 255.0F);
        }
        return table;
    }();
    return {kTable[color.r], kTable[color.g], kTable[color.b]};
}

constexpr std::uint32_t kSeveralObjects = kNoObject - 1;

/// The object that all rays of a packet hit, if they hit anything.
std::uint32_t shared_object(const HitPacket& hits) {
    std::uint32_t least = kNoObject;
    std::uint32_t most = 0;
    for (int i = 0; i < kLanes; ++i) {
        const std::uint32_t object = hits.object[i];
        least = std::min(least, object);
        most = std::max(most, object == kNoObject ? 0 : object);
    }
    return least == kNoObject || least == most ? least : kSeveralObjects;
}

Vec3f view_direction(const Camera& camera, float right, float up, float back) {
    return normalize(camera.right() * right + camera.up() * up + camera.back() * back);
}

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

Shader::Shader(const Scene& scene, const Camera& camera, const ShadingSettings& settings)
    : mode_(settings.mode) {
    for (const Object& object : scene.objects()) {
        Surface surface;
        surface.color = srgb_decode(object.material.color);
        if (!std::holds_alternative<Mesh>(object.shape)) {
            const auto& colors = std::visit(
                [](const auto& s) -> auto& { return s.colors; }, object.shape);
            if (!colors.empty()) surface.primitive_colors = colors.data();
        } else {
            const auto& mesh = std::get<Mesh>(object.shape);
            surface.triangles = mesh.triangles.data();
            if (!mesh.colors.empty()) surface.vertex_colors = mesh.colors.data();
            if (!mesh.corner_normals.empty())
                surface.corner_normals = mesh.corner_normals[0].data();
            const NormalSource source = object.normals.value_or(settings.normals);
            const bool own = source == NormalSource::automatic && !mesh.line_normals.empty();
            surface.line_normals = own ? mesh.line_normals[0].data() : surface.corner_normals;
            if (source == NormalSource::geometric) surface.line_normals = nullptr;
        }
        any_smooth_ |= surface.corner_normals != nullptr || surface.line_normals != nullptr;
        any_line_normals_ |= surface.line_normals != surface.corner_normals;
        surfaces_.push_back(surface);
    }

    const Color color = srgb_decode(settings.background);
    const float alpha = settings.transparent_background ? 0.0F : 1.0F;
    background_.r.fill(color.r * alpha);
    background_.g.fill(color.g * alpha);
    background_.b.fill(color.b * alpha);
    background_.a.fill(alpha);

    // Together a little below 1 where the key light falls straight on, so that no colour clips.
    const bool lit = mode_ == ShadeMode::lambert || mode_ == ShadeMode::toon;
    lighting_.key_dir = view_direction(camera, -0.45F, 0.65F, 0.75F);
    lighting_.fill_dir = view_direction(camera, 0.75F, -0.1F, 0.65F);
    lighting_.up = camera.up();
    lighting_.key = lit ? 0.66F : 0.0F;
    lighting_.fill = lit ? 0.16F : 0.0F;
    lighting_.ambient_middle = lit ? 0.17F : 1.0F;
    lighting_.ambient_slope = lit ? 0.06F : 0.0F;
    lighting_.toon_steps = mode_ == ShadeMode::toon ? 4.0F : 0.0F;
}

bool Shader::shade(const HitPacket& hits, ColorPacket& colors) const {
    NormalPacket normals;
    smooth(hits, normals);
    return shade(hits, normals, colors);
}

bool Shader::shade(const HitPacket& hits, const NormalPacket& normals, ColorPacket& colors) const {
    const std::uint32_t object = shared_object(hits);
    if (object == kNoObject || mode_ == ShadeMode::none) {
        colors = background_;
        return object != kNoObject;
    }
    look_up_colors(hits, object, colors);
    illuminate(hits, normals, lighting_, background_, colors);
    return true;
}

void Shader::smooth(const HitPacket& hits, NormalPacket& normals) const {
    normals = {hits.normal_x, hits.normal_y, hits.normal_z};
    if (any_smooth_) interpolate(hits, &Surface::corner_normals, normals);
}

void Shader::line_normals(const HitPacket& hits, NormalPacket& normals) const {
    normals = {hits.normal_x, hits.normal_y, hits.normal_z};
    if (any_smooth_) interpolate(hits, &Surface::line_normals, normals);
}

void Shader::prefetch(const HitPacket& hits) const {
    if (!any_smooth_) return;
    for (int i = 0; i < kLanes; ++i) {
        const auto* normals =
            hits.object[i] == kNoObject ? nullptr : surfaces_[hits.object[i]].corner_normals;
        if (normals != nullptr) __builtin_prefetch(normals + std::size_t{3} * hits.primitive[i]);
    }
}

Color Shader::surface_color(const Surface& surface, const HitPacket& hits, int lane) {
    const std::uint32_t primitive = hits.primitive[lane];
    if (surface.primitive_colors != nullptr) return decode(surface.primitive_colors[primitive]);
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

void Shader::look_up_colors(const HitPacket& hits, std::uint32_t object,
                            ColorPacket& colors) const {
    if (object != kSeveralObjects && surfaces_[object].primitive_colors == nullptr &&
        surfaces_[object].vertex_colors == nullptr) {
        colors.r.fill(surfaces_[object].color.r);
        colors.g.fill(surfaces_[object].color.g);
        colors.b.fill(surfaces_[object].color.b);
        return;
    }
    for (int i = 0; i < kLanes; ++i) {
        const bool miss = hits.object[i] == kNoObject;
        const Color color = miss ? Color{} : surface_color(surfaces_[hits.object[i]], hits, i);
        colors.r[i] = color.r;
        colors.g[i] = color.g;
        colors.b[i] = color.b;
    }
}

void Shader::interpolate(const HitPacket& hits, const std::uint32_t* Surface::*source,
                         NormalPacket& normals) const {
    const std::uint32_t object = shared_object(hits);
    if (object == kNoObject) return;
    if (object != kSeveralObjects) {
        const std::uint32_t* packed = surfaces_[object].*source;
        if (packed != nullptr) interpolate_normals(packed, object, hits, normals);
        return;
    }
    for (std::uint32_t k = 0; k < surfaces_.size(); ++k) {
        const std::uint32_t* packed = surfaces_[k].*source;
        const bool seen = std::ranges::find(hits.object, k) != hits.object.end();
        if (seen && packed != nullptr) interpolate_normals(packed, k, hits, normals);
    }
}

/// Corner normals interpolated over the triangle, on the side of the geometric normal. They are
/// unpacked (unpack_normal, scene/mesh.h) but not scaled to unit length first: that shifts the
/// weights of corners a little, alike on both sides of an edge, and saves three square roots.
INKTRACE_MULTIVERSION
void Shader::interpolate_normals(const std::uint32_t* corner_normals, std::uint32_t object,
                                 const HitPacket& hits, NormalPacket& normals) {
    std::array<Lanes<std::uint32_t>, 3> packed;
    for (int i = 0; i < kLanes; ++i) {
        const std::size_t first =
            hits.object[i] == object ? std::size_t{3} * hits.primitive[i] : std::size_t{0};
        for (std::size_t k = 0; k < 3; ++k) packed[k][i] = corner_normals[first + k];
    }
    NormalPacket sum{};
    for (std::size_t k = 0; k < 3; ++k) {
        for (int i = 0; i < kLanes; ++i) {
            constexpr float kOne = 32767.0F;
            const auto low = static_cast<std::int32_t>(packed[k][i] & 0xFFFFU);
            const auto high = static_cast<std::int32_t>(packed[k][i] >> 16U);
            const float x = static_cast<float>(low) - kOne;
            const float y = static_cast<float>(high) - kOne;
            const float z = kOne - std::abs(x) - std::abs(y);
            const float fold = std::max(-z, 0.0F);
            const float u = hits.u[i];
            const float v = hits.v[i];
            const float weight = k == 0 ? 1.0F - u - v : k == 1 ? u : v;
            sum.x[i] += weight * (x - std::copysign(fold, x));
            sum.y[i] += weight * (y - std::copysign(fold, y));
            sum.z[i] += weight * z;
        }
    }
    for (int i = 0; i < kLanes; ++i) {
        const float x = sum.x[i];
        const float y = sum.y[i];
        const float z = sum.z[i];
        const float side = x * normals.x[i] + y * normals.y[i] + z * normals.z[i];
        // Opposite corner normals can cancel; the geometric normal stands in.
        const float squared = x * x + y * y + z * z;
        const bool use = squared > 1e3F && hits.object[i] == object;
        const float scale = std::copysign(1.0F, side) / std::sqrt(use ? squared : 1.0F);
        normals.x[i] = use ? x * scale : normals.x[i];
        normals.y[i] = use ? y * scale : normals.y[i];
        normals.z[i] = use ? z * scale : normals.z[i];
    }
}

/// Surface colour times the light that reaches it; misses take the background.
INKTRACE_MULTIVERSION
void Shader::illuminate(const HitPacket& hits, const NormalPacket& normals,
                        const Lighting& lighting, const ColorPacket& background,
                        ColorPacket& colors) {
    Lanes<float> light;
    for (int i = 0; i < kLanes; ++i) {
        const auto along = [&](Vec3f d) {
            return normals.x[i] * d.x + normals.y[i] * d.y + normals.z[i] * d.z;
        };
        const float ambient = lighting.ambient_middle + lighting.ambient_slope * along(lighting.up);
        const float key = lighting.key * std::max(along(lighting.key_dir), 0.0F);
        const float fill = lighting.fill * std::max(along(lighting.fill_dir), 0.0F);
        light[i] = ambient + key + fill;
    }
    if (lighting.toon_steps > 0.0F) {
        for (float& value : light) {
            value = (std::floor(value * lighting.toon_steps) + 0.5F) / lighting.toon_steps;
        }
    }
    for (int i = 0; i < kLanes; ++i) {
        const bool miss = hits.object[i] == kNoObject;
        colors.r[i] = miss ? background.r[i] : colors.r[i] * light[i];
        colors.g[i] = miss ? background.g[i] : colors.g[i] * light[i];
        colors.b[i] = miss ? background.b[i] : colors.b[i] * light[i];
        colors.a[i] = miss ? background.a[i] : 1.0F;
    }
}

}  // namespace ink
