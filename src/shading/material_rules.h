#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/material.h"
#include "scene/scene.h"

namespace ink {

/// How the material of one object, or of all, differs from what the scene says. What is left open
/// stays as it is.
struct MaterialRule {
    std::string object;         ///< number, counted from 1, or name; empty: every object
    std::optional<Rgb8> color;  ///< also instead of what primitives bring
    std::optional<double> specular, roughness, metal;
};

/// What an object is made of after all rules.
struct ResolvedMaterial : Material {
    bool uniform = false;  ///< `color` goes before the colours of primitives
};

/// One material an object of the scene; later rules win. Throws UsageError where a rule names an
/// object that does not exist.
std::vector<ResolvedMaterial> resolve_materials(const Scene& scene,
                                                const std::vector<MaterialRule>& rules);

}  // namespace ink
