#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include "accel/tracer.h"
#include "film/film.h"
#include "render/drawing.h"
#include "render/settings.h"
#include "scene/scene.h"
#include "shading/ambient.h"

namespace ink {

/// How the caller follows a render and ends it early.
struct RenderControl {
    /// Called with the share of the picture that is done, in (0, 1], from the rendering threads,
    /// one at a time.
    std::function<void(double)> progress;
    /// Looked at before each tile; once true, `render` throws Cancelled.
    const std::atomic<bool>* cancel = nullptr;
    /// Keeps ambient occlusion for other pictures of the same scene; null: it is not kept.
    AmbientCache* ambient = nullptr;
};

/// What a render took. Times are wall time; those of phases are summed over threads and divided by
/// their number.
struct RenderStats {
    double render_ms = 0.0;  ///< from the built scene to the finished pixels
    double trace_ms = 0.0;   ///< sample rays
    double lines_ms = 0.0;   ///< stencil rays and edge strengths; finding and drawing lines
    double shade_ms = 0.0;   ///< shading, compositing, pixels
    /// Of lines_ms, by method "edges".
    double detect_ms = 0.0, locate_ms = 0.0, connect_ms = 0.0, ridges_ms = 0.0;
    double ink_ms = 0.0;    ///< laying ink over each other, coverage of pixels
    double blend_ms = 0.0;  ///< of lines_ms: mixing ink with the picture
    double film_ms = 0.0;   ///< of shade_ms: colours to pixels
    std::uint64_t rays = 0;
    std::uint64_t crossings = 0;  ///< located by method "edges"
    int threads = 0;

    /// Adds another thread's times and counts.
    RenderStats& operator+=(const RenderStats& other);
    /// Times of phases divided by the number of threads that share them.
    RenderStats mean_over(int threads) const;
};

/// Which pixels to make: for a screen or an 8-bit file, and for an EXR.
struct PixelFormats {
    bool display = true;
    bool linear = false;
    bool lines = true;  ///< draw the lines with them
};

/// Renders the scene, of which `tracer` must have been made. The same arguments give the same
/// bytes, whatever the number of threads and the size of tiles. Method "edges" hands out its lines
/// through `drawing` as well, if it is not null.
Film render(const Scene& scene, const Tracer& tracer, const Settings& settings,
            const PixelFormats& formats = {}, const RenderControl& control = {},
            RenderStats* stats = nullptr, Drawing* drawing = nullptr);

}  // namespace ink
