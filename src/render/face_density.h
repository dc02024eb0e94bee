#pragma once

#include "lines/density.h"
#include "render/edges.h"
#include "render/face_map.h"

namespace ink {

/// How dense the lines between faces are, from the faces themselves, where the lattice is too
/// coarse to tell it from how often its points see different ones: by Cauchy's way of counting,
/// half of a triangle's outline over its area, about each point that sees it. `enlarged` is how
/// much larger the picture is whose lines these are.
LineDensity face_density(const Edges& edges, const FaceMap& faces, float enlarged, WorkLoop& loop);

}  // namespace ink
