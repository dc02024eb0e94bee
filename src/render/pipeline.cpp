#include "render/pipeline.h"

namespace ink {

Pipeline::Pipeline(const Scene& all_objects, const Tracer& scene_tracer, const Settings& all,
                   Film& target, const LineOutput& line_output, const RenderControl& control,
                   Rays rays)
    : scene(all_objects),
      tracer(scene_tracer),
      settings(all),
      camera(scene, all.view, all.size),
      frame(rays == Rays::traced ? tracer.frame(camera.projection(), all.threads) : nullptr),
      shading(shading_of(all, scene)),
      shader(scene, tracer, camera, shading),
      ids(scene, all.ids),
      optics(scene),
      unit(static_cast<float>(scene.frame().unit)),
      film(target),
      lines(line_output) {
    if (rays == Rays::traced) {
        light_from_all_around(control);
        if (settings.smoothing().kind == AntiAliasing::Kind::edges) {
            const float spacing = 1.0F / static_cast<float>(settings.lattice_points());
            shader.smooth_sticks(scene, camera, spacing, ids.levels());
        }
    }
    if (!settings.aovs.empty()) aovs.emplace(scene, camera, settings.aovs, locates(), film);
}

void Pipeline::light_from_all_around(const RenderControl& control) {
    const bool shows = settings.compose != Compose::lines && shading.mode != ShadeMode::none;
    if (!shows || *shading.ambient <= 0.0F) return;
    AmbientCache own;
    AmbientCache& cache = control.ambient != nullptr ? *control.ambient : own;
    bake = cache.get(scene, tracer, shading.ambient_quality, control.cancel);
    const bool is_draft = lines.enlargement != nullptr;
    ambient = bake->seen_by(camera, is_draft ? SmallBalls::by_nodes : SmallBalls::by_point);
    shader.use(ambient.get());
}

bool Pipeline::locates() const {
    return settings.method == Method::edges &&
           (settings.draws_lines() || lines.drawing != nullptr || goes_on() ||
            settings.smoothing().kind == AntiAliasing::Kind::edges);
}

FilmSettings film_settings(const Settings& settings, const PixelFormats& formats) {
    const bool linear = settings.line_blend == LineBlend::linear ||
                        (settings.line_blend == LineBlend::automatic && !formats.display);
    return {.compose = settings.compose,
            .blend = linear ? BlendSpace::linear : BlendSpace::display,
            .line_color = settings.line_color,
            .background = settings.shading.background,
            .transparent_background = settings.shading.transparent_background,
            .display = formats.display,
            .linear = formats.linear};
}

}  // namespace ink
