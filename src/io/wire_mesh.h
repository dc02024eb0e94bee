#pragma once

#include "scene/mesh.h"
#include "scene/scene.h"

namespace ink {

/// The edges of a mesh as thin round wires, each once: what there is to see of faces without area.
/// Nothing where no edge has a length.
Glyphs wires_of(const Mesh& mesh);

}  // namespace ink
