#include "sampling/optics.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace ink {

namespace {

/// Rays start this far off the surface that they leave, in a scene of size 1: many times what the
/// rounding of a float does to them, and a few hundredths of a pixel of the largest pictures.
constexpr double kClearance = 0x1p-18;
/// And leave it by this sine at least, where an interpolated normal would send them back into it.
constexpr double kLeastSine = 1e-3;
/// Fainter shines are left out.
constexpr double kLeastShine = 1.0 / 1024.0;

bool has_no_inside(const Shape& shape) {
    if (const auto* glyphs = std::get_if<Glyphs>(&shape)) {
        switch (glyphs->shape.kind) {
            case GlyphKind::disc:
            case GlyphKind::rectangle:
            case GlyphKind::gaussian:
            case GlyphKind::waves: return true;
            case GlyphKind::frustum: return !glyphs->shape.capped;
            default: return false;
        }
    }
    const auto* mesh = std::get_if<Mesh>(&shape);
    if (mesh == nullptr) return false;
    return std::ranges::any_of(mesh->edge_flags, [](std::uint8_t flags) {
        return (flags & 7U * Mesh::kBoundaryEdge) != 0;
    });
}

Vec3d mirrored(Vec3d dir, Vec3d normal) { return dir - normal * (2.0 * dot(dir, normal)); }

/// `dir` turned, if need be, so that it leaves the surface on the side of `facet`.
Vec3d clear_of(Vec3d dir, Vec3d facet) {
    const double along = dot(dir, facet);
    return along >= kLeastSine ? dir : normalize(dir + facet * (kLeastSine - along));
}

}  // namespace

double fresnel(double cosine, double eta) {
    const double squared = 1.0 - eta * eta * (1.0 - cosine * cosine);
    if (squared <= 0.0) return 1.0;
    const double beyond = std::sqrt(squared);
    const double across = (eta * cosine - beyond) / (eta * cosine + beyond);
    const double along = (cosine - eta * beyond) / (cosine + eta * beyond);
    return 0.5 * (across * across + along * along);
}

bool Media::inside(std::uint32_t object, std::uint32_t primitive) const {
    return std::any_of(solids_.begin(), solids_.begin() + count_,
                       [&](const Solid& solid) { return solid.is(object, primitive); });
}

Media Media::entered(const Solid& solid) const {
    Media result = *this;
    if (count_ < kMost) result.solids_[result.count_++] = solid;
    return result;
}

Media Media::left(std::uint32_t object, std::uint32_t primitive) const {
    Media result = *this;
    const auto end = result.solids_.begin() + count_;
    const auto rest = std::remove_if(result.solids_.begin(), end, [&](const Solid& solid) {
        return solid.is(object, primitive);
    });
    result.count_ = static_cast<std::size_t>(rest - result.solids_.begin());
    return result;
}

Optics::Optics(const Scene& scene) : scene_(scene) {
    for (const Object& object : scene.objects()) {
        Surface surface;
        surface.specular = object.material.is_specular();
        any_ |= surface.specular;
        if (surface.specular) {
            surface.thin = has_no_inside(object.shape);
            surface.one_solid = std::holds_alternative<Mesh>(object.shape);
        }
        surfaces_.push_back(surface);
    }
}

/// The hit with the digits that single precision lost, where the surface's equation is at hand.
Incidence Optics::refined(const Incidence& incidence) const {
    Incidence at = incidence;
    const Shape& shape = scene_.objects()[at.object].shape;
    if (const auto* spheres = std::get_if<Spheres>(&shape)) {
        const Sphere sphere = spheres->at(at.primitive);
        const double radius = static_cast<double>(sphere.radius);
        const Vec3d from = at.origin - to_double(sphere.centre);
        const double middle = -dot(from, at.dir);
        const Vec3d foot = from + at.dir * middle;
        const double half = std::sqrt(std::max(radius * radius - dot(foot, foot), 0.0));
        at.t = std::abs(middle - half - at.t) <= std::abs(middle + half - at.t) ? middle - half
                                                                                : middle + half;
        const Vec3d outward = normalize(from + at.dir * at.t);
        at.facet = at.normal = dot(outward, at.dir) > 0.0 ? -outward : outward;
    } else if (const auto* mesh = std::get_if<Mesh>(&shape)) {
        const Mesh::Triangle& corners = mesh->triangles[at.primitive];
        const Vec3d a = to_double(mesh->vertices[corners[0]]);
        const Vec3d normal = cross(to_double(mesh->vertices[corners[1]]) - a,
                                   to_double(mesh->vertices[corners[2]]) - a);
        const double along = dot(at.dir, normal);
        // Not where the plane is seen edge on.
        if (std::abs(along) > 1e-6 * length(normal)) at.t = dot(a - at.origin, normal) / along;
    }
    // An interpolated normal may be turned away from a ray that the surface itself faces.
    if (dot(at.normal, at.dir) >= 0.0) at.normal = at.facet;
    return at;
}

Branch Optics::reflected(const Incidence& at, double share) const {
    const Vec3d dir = clear_of(mirrored(at.dir, at.normal), at.facet);
    const bool within =
        at.media.inside(at.object, surfaces_[at.object].one_solid ? 0 : at.primitive);
    return {within ? Bend::inside : Bend::mirrored, share,
            at.origin + at.dir * at.t + at.facet * kClearance, dir, at.media};
}

/// Snell's law; total reflection where it has no answer.
Branch Optics::transmitted(const Incidence& at, double share) const {
    const Surface& surface = surfaces_[at.object];
    const float ior = scene_.objects()[at.object].material.ior;
    const std::uint32_t primitive = surface.one_solid ? 0 : at.primitive;
    Branch branch{Bend::straight, share, at.origin + at.dir * at.t - at.facet * kClearance, at.dir,
                  at.media};
    if (surface.thin || ior == 1.0F) return branch;
    const bool leaves = at.media.inside(at.object, primitive);
    branch.media = leaves ? at.media.left(at.object, primitive)
                          : at.media.entered({at.object, primitive, ior});
    const double eta = at.media.ior() / branch.media.ior();
    const double cosine = -dot(at.dir, at.normal);
    const double squared = 1.0 - eta * eta * (1.0 - cosine * cosine);
    if (squared <= 0.0) return reflected(at, share);
    branch.bend = Bend::refracted;
    const Vec3d dir = normalize(at.dir * eta + at.normal * (eta * cosine - std::sqrt(squared)));
    branch.dir = -clear_of(-dir, at.facet);
    return branch;
}

Scattering Optics::scatter(const Incidence& incidence) const {
    const Incidence at = refined(incidence);
    const Material& material = scene_.objects()[at.object].material;
    const Surface& surface = surfaces_[at.object];
    const auto mirror = static_cast<double>(material.mirror);
    const auto through = static_cast<double>(material.transparency);
    const bool leaves = at.media.inside(at.object, surface.one_solid ? 0 : at.primitive);

    // From within, only total reflection counts: what else stays inside is faint, and would take a
    // ray at every turn.
    double shine = mirror;
    if (leaves) {
        shine = 0.0;
    } else if (through > 0.0 && material.ior != 1.0F) {
        const double cosine = std::min(-dot(at.dir, at.normal), 1.0);
        const double eta = surface.thin ? 1.0 / material.ior : at.media.ior() / material.ior;
        shine += (1.0 - mirror) * fresnel(cosine, eta);
    }
    Scattering result;
    result.own = (1.0 - shine) * (1.0 - through);
    const double transmitted_share = (1.0 - shine) * through;
    const bool goes_through = through > 0.0 && through >= mirror;
    result.main = goes_through ? transmitted(at, transmitted_share) : reflected(at, shine);
    if (goes_through && shine > kLeastShine) result.side = reflected(at, shine);
    if (!goes_through && transmitted_share > kLeastShine) {
        result.side = transmitted(at, transmitted_share);
    }
    if (result.side.bend == Bend::none) result.own = 1.0 - result.main.share;
    return result;
}

}  // namespace ink
