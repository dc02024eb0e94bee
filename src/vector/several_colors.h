#pragma once

#include "sampling/line_ids.h"
#include "scene/scene.h"

namespace ink {

/// Whether any geometry is of more than one colour, as the sticks of a molecule are that count as
/// one, or a painted mesh: one colour alone cannot stand for it.
bool has_geometry_of_several_colors(const Scene& scene, const LineIds& ids);

}  // namespace ink
