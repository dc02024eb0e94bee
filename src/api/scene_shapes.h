#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "io/json_document.h"
#include "scene/scene.h"

namespace ink {

/// The keys that any object of a scene file may have.
const std::vector<std::string_view>& common_object_keys();

/// The shape that an object of a scene file describes, in a frame of its own: sphere, box, torus
/// and so on by its "type"; nothing where the type is none of a shape. Throws InputError.
std::optional<Object> read_shape(const JsonNode& node);

/// All types that `read_shape` knows.
std::vector<std::string_view> shape_types();

}  // namespace ink
