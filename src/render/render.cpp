#include "render/render.h"

#include <array>
#include <optional>

#include "base/parallel.h"
#include "base/timer.h"
#include "render/pipeline.h"

namespace ink {

namespace {

constexpr std::array kPhases{&RenderStats::trace_ms,  &RenderStats::lines_ms,
                             &RenderStats::shade_ms,  &RenderStats::detect_ms,
                             &RenderStats::locate_ms, &RenderStats::connect_ms,
                             &RenderStats::ridges_ms, &RenderStats::ink_ms,
                             &RenderStats::blend_ms,  &RenderStats::film_ms};

}  // namespace

RenderStats& RenderStats::operator+=(const RenderStats& other) {
    for (const auto phase : kPhases) this->*phase += other.*phase;
    rays += other.rays;
    crossings += other.crossings;
    return *this;
}

RenderStats RenderStats::mean_over(int thread_count) const {
    RenderStats mean = *this;
    for (const auto phase : kPhases) mean.*phase /= thread_count;
    mean.threads = thread_count;
    return mean;
}

Film render(const Scene& scene, const Tracer& tracer, const Settings& settings,
            const PixelFormats& formats, const RenderControl& control, RenderStats* stats,
            Drawing* drawing) {
    double render_ms = 0.0;
    std::optional<Timer> timer(render_ms);
    validate(settings);
    Film film(settings.size, film_settings(settings, formats));
    RenderStats result;
    // From first to last, so that threads that come for one loop are there for the next.
    with_threads(settings.threads, [&] {
        const LineOutput lines{.ink = formats.lines && settings.draws_lines(), .drawing = drawing};
        const Pipeline pipeline(scene, tracer, settings, film, lines, control);
        result = pipeline.locates() ? render_edges(pipeline, control)
                                    : render_stencils(pipeline, control);
    });
    timer.reset();
    result.render_ms = render_ms;
    if (stats != nullptr) *stats = result;
    return film;
}

}  // namespace ink
