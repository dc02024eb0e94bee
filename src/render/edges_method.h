#pragma once

#include "render/edges_plan.h"
#include "render/line_search.h"
#include "render/pipeline.h"
#include "render/work_loop.h"

namespace ink {

/// Draws what was found on the film.
void draw_lines(const EdgesPlan& edges, const FoundLines& found, WorkLoop& loop,
                RenderStats& stats);

}  // namespace ink
