#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "scene/color_scale.h"
#include "scene/field.h"

namespace ink {

/// Names that a field of kinds of particles goes by: type, material.
bool is_kind_name(std::string_view name);

/// The colours of particles of several kinds, one each, by the field that goes by such a name and
/// holds whole numbers or words; nothing where there is none, or all are of one kind.
std::optional<Coloring> color_kinds(std::span<const Field> fields);

}  // namespace ink
