#include "render/pick.h"

#include <array>
#include <variant>
#include <vector>

#include "camera/camera.h"
#include "sampling/sampler.h"
#include "scene/elements.h"

namespace ink {

namespace {

std::string_view kind_of(const Object& object) {
    if (std::holds_alternative<Mesh>(object.shape)) return "triangle";
    if (!std::holds_alternative<Spheres>(object.shape)) return "shape";
    return object.kind == ObjectKind::molecule ? "atom" : "particle";
}

/// What the file says, or else what the scene knows.
Facts facts_of(const Object& object, std::uint32_t primitive) {
    Facts facts;
    const CopyNumbering numbers = numbering(object.shape);
    const std::size_t source = numbers.source(primitive);
    if (object.facts) facts = object.facts(static_cast<std::uint32_t>(source));
    if (!numbers.copies.empty()) {
        for (auto& [name, value] : facts) {
            if (name == "chain") value += copy_suffix(numbers.copy(primitive).number);
        }
    }
    const auto knows = [&](std::string_view name) {
        for (const auto& [known, value] : facts) {
            if (known == name) return true;
        }
        return false;
    };
    if (source < object.elements.size() && !knows("element")) {
        facts.emplace_back("element", element(object.elements[source]).symbol);
    }
    if (has_parts(object.shape)) {
        const std::string name = object.part_name(part_of(object.shape, primitive));
        if (!name.empty() && !knows("chain")) facts.emplace_back("part", name);
    }
    return facts;
}

}  // namespace

std::optional<Picked> pick(const Scene& scene, const Tracer& tracer, const Settings& settings,
                           Vec2f point) {
    const Camera camera(scene, settings.view, settings.size);
    const auto frame = tracer.frame(camera.projection(), settings.threads);
    Sampler sampler(*frame, camera);
    std::vector<HitPacket> hits;
    sampler.trace_points(std::array{point}, hits);
    const HitPacket& hit = hits.front();
    if (hit.object[0] == kNoObject) return std::nullopt;

    const RayPacket& ray = sampler.packets().front();
    const Vec3f position{ray.origin_x[0] + hit.t[0] * ray.dir_x[0],
                         ray.origin_y[0] + hit.t[0] * ray.dir_y[0],
                         ray.origin_z[0] + hit.t[0] * ray.dir_z[0]};
    const Object& object = scene.objects()[hit.object[0]];
    Picked picked{.kind = kind_of(object),
                  .object = hit.object[0],
                  .primitive = hit.primitive[0],
                  .position = scene.frame().to_world(position),
                  .center = {},
                  .facts = facts_of(object, hit.primitive[0])};
    picked.center = picked.position;
    if (const auto* spheres = std::get_if<Spheres>(&object.shape)) {
        picked.center = scene.frame().to_world(spheres->at(picked.primitive).centre);
    }
    return picked;
}

}  // namespace ink
