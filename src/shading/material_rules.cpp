#include "shading/material_rules.h"

#include <fmt/format.h>

#include "base/error.h"

namespace ink {

namespace {

void apply(const MaterialRule& rule, ResolvedMaterial& material) {
    const auto set = [](const std::optional<double>& from, float& to) {
        if (from) to = static_cast<float>(*from);
    };
    if (rule.color) {
        material.color = *rule.color;
        material.uniform = true;
    }
    set(rule.specular, material.specular);
    set(rule.roughness, material.roughness);
    set(rule.metal, material.metal);
}

}  // namespace

std::vector<ResolvedMaterial> resolve_materials(const Scene& scene,
                                                const std::vector<MaterialRule>& rules) {
    const std::vector<Object>& objects = scene.objects();
    std::vector<ResolvedMaterial> materials;
    for (const Object& object : objects) materials.push_back({object.material});
    for (const MaterialRule& rule : rules) {
        bool found = false;
        for (std::size_t k = 0; k < objects.size(); ++k) {
            if (!rule.object.empty() && rule.object != std::to_string(k + 1) &&
                rule.object != objects[k].name) {
                continue;
            }
            apply(rule, materials[k]);
            found = true;
        }
        if (!found) {
            throw UsageError(
                fmt::format("--material: there is no object '{}'; the scene has {}, each of which "
                            "goes by its number, from 1, or its name",
                            rule.object, objects.size()));
        }
    }
    return materials;
}

}  // namespace ink
