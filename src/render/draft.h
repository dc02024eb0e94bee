#pragma once

#include "accel/tracer.h"
#include "film/film.h"
#include "render/render.h"
#include "render/settings.h"
#include "scene/scene.h"

namespace ink {

/// A picture for a camera that moves, from fewer rays than `render` takes: `share` of a ray along a
/// pixel's side, in (0, 1]. It is shaded and searched for lines at that resolution and enlarged;
/// lines, whose places are known to a fraction of a pixel, are then drawn at full size. So types
/// and widths are those of the picture in full; what is thinner than 1 / share pixels may be
/// missed. Colours do not run across lines. Makes display pixels only, and no AOVs.
///
/// Method "stencil" does not know where lines are: it draws the whole picture smaller.
Film render_draft(const Scene& scene, const Tracer& tracer, const Settings& settings, double share,
                  const RenderControl& control = {}, RenderStats* stats = nullptr);

}  // namespace ink
