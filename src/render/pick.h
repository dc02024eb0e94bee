#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "accel/tracer.h"
#include "base/vec.h"
#include "render/settings.h"
#include "scene/facts.h"
#include "scene/scene.h"

namespace ink {

/// What lies under a point of a picture.
struct Picked {
    std::string_view kind;        ///< "atom", "particle", "triangle" or "shape"
    std::size_t object = 0;       ///< index in the scene
    std::uint32_t primitive = 0;  ///< index in the object
    Vec3d position;               ///< on the surface, world
    Vec3d center;                 ///< of a sphere; else the position
    Facts facts;
};

/// Traces the ray through a screen point of the picture that the settings describe; none where it
/// misses. `tracer` must have been made of the scene.
std::optional<Picked> pick(const Scene& scene, const Tracer& tracer, const Settings& settings,
                           Vec2f point);

}  // namespace ink
