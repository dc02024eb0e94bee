#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
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

/// What every method works with.
struct Pipeline {
    /// `traces`: whether rays are wanted, or only what is found already is to be drawn. `kept`:
    /// where ambient occlusion is kept from picture to picture; null if it is not. Throws Cancelled
    /// once `cancel` is true (null: never).
    Pipeline(const Scene& all_objects, const Tracer& scene_tracer, const Settings& all,
             Film& target, const LineOutput& line_output, bool traces = true,
             AmbientCache* kept = nullptr, const std::atomic<bool>* cancel = nullptr)
        : scene(all_objects),
          tracer(scene_tracer),
          settings(all),
          camera(scene, all.view, all.size),
          frame(traces ? scene_tracer.frame(camera.projection(), all.threads) : nullptr),
          shading(shading_of(all, scene)),
          shader(scene, scene_tracer, camera, shading),
          ids(scene, all.ids),
          optics(scene),
          unit(static_cast<float>(scene.frame().unit)),
          film(target),
          lines(line_output) {
        if (traces && *shading.ambient > 0.0F && all.compose != Compose::lines &&
            shading.mode != ShadeMode::none) {
            AmbientCache own;
            bake =
                (kept != nullptr ? *kept : own).get(scene, tracer, shading.ambient_quality, cancel);
            ambient = bake->seen_by(camera);
            shader.use(ambient.get());
        }
        if (traces && all.smoothing().kind == AntiAliasing::Kind::edges) {
            shader.smooth_sticks(scene, camera, 1.0F / static_cast<float>(all.lattice_points()),
                                 ids.levels());
        }
        if (!all.aovs.empty()) aovs.emplace(scene, camera, all.aovs, locates(), target);
    }

    /// Whether lines are located (method "edges"). Without lines, smoothing and mirrors, both
    /// methods are one ray a pixel.
    bool locates() const {
        return settings.method == Method::edges &&
               (settings.draws_lines() || lines.drawing != nullptr || goes_on() ||
                settings.smoothing().kind == AntiAliasing::Kind::edges);
    }
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
};

/// What the settings say about the film.
FilmSettings film_settings(const Settings& settings, const PixelFormats& formats);

/// Runs a picture's work items in parallel, watches for cancellation and reports progress.
class WorkLoop {
  public:
    /// `items` in all, over every call of `run`.
    WorkLoop(int threads, const RenderControl& control, std::size_t items)
        : threads_(threads), control_(control), items_(items) {}

    int threads() const { return threads_; }
    /// There will be so many more.
    void expect(std::size_t items) { items_ += items; }
    /// Calls `body(item, worker)` as parallel_for does. Throws Cancelled when told to stop.
    void run(std::size_t count,
             const std::function<void(std::size_t item, std::size_t worker)>& body);
    /// A single item, on a thread that is there already. Likewise.
    void item(const std::function<void()>& body);

  private:
    int threads_;
    const RenderControl& control_;
    std::size_t items_;
    std::size_t done_ = 0;
    std::mutex mutex_;
};

/// Adds the time of its life to a counter.
class Timer {
  public:
    using Clock = std::chrono::steady_clock;

    explicit Timer(double& total_ms) : total_ms_(total_ms), start_(Clock::now()) {}
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;
    ~Timer() {
        total_ms_ += std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
    }

  private:
    double& total_ms_;
    Clock::time_point start_;
};

/// Divides a stretch of time among counters.
class LapTimer {
  public:
    /// Adds the time since the last lap, or the beginning.
    void lap(double& total_ms) {
        const Timer::Clock::time_point now = Timer::Clock::now();
        total_ms += std::chrono::duration<double, std::milli>(now - last_).count();
        last_ = now;
    }

  private:
    Timer::Clock::time_point last_ = Timer::Clock::now();
};

/// Method "stencil": Choudhury and Parker 2009, section 3. Renders the whole film.
RenderStats render_stencils(const Pipeline& pipeline, const RenderControl& control);

/// Method "edges": discontinuities found on a lattice, located by bisection and drawn with exact
/// coverage. Renders the whole film.
RenderStats render_edges(const Pipeline& pipeline, const RenderControl& control);

}  // namespace ink
