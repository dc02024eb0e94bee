#include "render/render.h"

#include <array>

#include "base/error.h"
#include "base/parallel.h"
#include "render/pipeline.h"

namespace ink {

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
        const Pipeline pipeline(
            scene, tracer, settings, film,
            LineOutput{.ink = formats.lines && settings.draws_lines(), .drawing = drawing}, true,
            control.ambient, control.cancel);
        result = pipeline.locates() ? render_edges(pipeline, control)
                                    : render_stencils(pipeline, control);
    });
    timer.reset();
    result.render_ms = render_ms;
    if (stats != nullptr) *stats = result;
    return film;
}

void WorkLoop::run(std::size_t count, const std::function<void(std::size_t, std::size_t)>& body) {
    parallel_for(count, threads_,
                 [&](std::size_t k, std::size_t worker) { item([&] { body(k, worker); }); });
}

void WorkLoop::item(const std::function<void()>& body) {
    if (control_.cancel != nullptr && control_.cancel->load(std::memory_order_relaxed)) {
        throw Cancelled();
    }
    body();
    if (!control_.progress) return;
    const std::scoped_lock lock(mutex_);
    ++done_;
    control_.progress(static_cast<double>(done_) / static_cast<double>(items_));
}

}  // namespace ink
