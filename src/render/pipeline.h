#pragma once

#include <memory>
#include <optional>

#include "accel/tracer.h"
#include "camera/camera.h"
#include "film/film.h"
#include "render/aovs.h"
#include "render/render.h"
#include "render/settings.h"
#include "sampling/line_ids.h"
#include "sampling/optics.h"
#include "shading/ambient.h"
#include "shading/shading.h"

namespace ink {

class Enlargement;

/// What becomes of the lines that method "edges" finds.
struct LineOutput {
    bool ink = true;             ///< drawn on the film
    Drawing* drawing = nullptr;  ///< null: not kept
    bool segments = false;       ///< kept in full with the lines found, whoever needs them
    /// To the larger picture that they are drawn on, see render_draft; null: to this one.
    const Enlargement* enlargement = nullptr;
};

/// Whether rays are wanted, or only what another picture found is to be drawn.
enum class Rays : bool { none, traced };

/// What every method works with.
struct Pipeline {
    /// Throws Cancelled once `control` says so.
    Pipeline(const Scene& all_objects, const Tracer& scene_tracer, const Settings& all,
             Film& target, const LineOutput& line_output, const RenderControl& control,
             Rays rays = Rays::traced);

    /// Whether lines are located (method "edges"). Without lines, smoothing and mirrors, both
    /// methods are one ray a pixel.
    bool locates() const;
    /// Whether rays go on from any surface.
    bool goes_on() const { return optics.any() && settings.specular_depth > 0; }

    const Scene& scene;
    const Tracer& tracer;
    const Settings& settings;
    Camera camera;
    std::unique_ptr<FrameTracer> frame;  ///< null if there are no rays
    ShadingSettings shading;
    Shader shader;
    std::shared_ptr<const AmbientBake> bake;
    std::unique_ptr<AmbientOcclusion> ambient;
    LineIds ids;
    Optics optics;
    float unit;  ///< length of the scene's unit in those of the file
    Film& film;
    LineOutput lines;
    std::optional<AovWriter> aovs;

  private:
    void light_from_all_around(const RenderControl& control);
};

/// What the settings say about the film.
FilmSettings film_settings(const Settings& settings, const PixelFormats& formats);

/// Method "stencil": Choudhury and Parker 2009, section 3. Renders the whole film.
RenderStats render_stencils(const Pipeline& pipeline, const RenderControl& control);

/// Method "edges": discontinuities found on a lattice, located by bisection and drawn with exact
/// coverage. Renders the whole film.
RenderStats render_edges(const Pipeline& pipeline, const RenderControl& control);

}  // namespace ink
