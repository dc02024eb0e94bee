#include "render/render.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "camera/camera.h"
#include "lines/strength.h"
#include "render/aovs.h"
#include "render/tiles.h"
#include "sampling/line_ids.h"
#include "sampling/sampler.h"
#include "sampling/stencil.h"

namespace ink {

namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Adds the time of its life to a counter.
class Timer {
  public:
    explicit Timer(double& total_ms) : total_ms_(total_ms), start_(Clock::now()) {}
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;
    ~Timer() { total_ms_ += ms_since(start_); }

  private:
    double& total_ms_;
    Clock::time_point start_;
};

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

/// The render's fixed parts, shared by all tiles.
struct Pipeline {
    Pipeline(const Scene& scene, const Tracer& scene_tracer, const Settings& settings, Film& target)
        : tracer(scene_tracer),
          camera(scene, settings.view, settings.size),
          shader(scene, camera, settings.shading),
          ids(scene, settings.ids),
          film(target),
          samples(multisample_offsets(settings.aa.samples)),
          draw_lines(settings.draws_lines()),
          shade_stencil(settings.aa.kind == AntiAliasing::Kind::stencil) {
        if (!settings.aovs.empty()) aovs.emplace(scene, camera, settings.aovs, target);
        if (!draw_lines && !shade_stencil) return;
        const auto radius = static_cast<float>(settings.line_width_px() * 0.5);
        stencil = ring_stencil(radius, settings.rings);
        reach = radius + 1.0F;
        const int M = static_cast<int>(stencil.size());
        for (int m = 0; m <= M; ++m) strengths.push_back(edge_strength(settings.metric, m, M));
    }

    const Tracer& tracer;
    Camera camera;
    Shader shader;
    LineIds ids;
    Film& film;
    std::optional<AovWriter> aovs;
    std::vector<Vec2f> samples;    ///< a pixel's sample rays, offsets from its centre
    std::vector<Vec2f> stencil;    ///< offsets from a sample; empty where nothing needs it
    std::vector<float> strengths;  ///< e_M(m) for m = 0..M
    float reach = 1.0F;            ///< of a pixel's samples and their stencils, pixels
    bool draw_lines;
    bool shade_stencil;
    /// One sample a pixel and no lines: its colour is the pixel.
    bool plain() const { return samples.size() == 1 && !draw_lines; }
};

/// What one thread reuses from tile to tile. Arrays have one entry a block.
struct Workspace {
    explicit Workspace(const Pipeline& pipeline)
        : sampler(pipeline.tracer, pipeline.camera), stencil_hits(pipeline.stencil.size()) {}

    Sampler sampler;
    std::vector<Block> blocks, empty;
    std::vector<HitPacket> hits;           ///< of the sample rays
    std::vector<ColorPacket> colors;       ///< c_s
    std::vector<std::uint8_t> seen;        ///< 0: nothing but background
    std::vector<Lanes<float>> strengths;   ///< e_s
    std::vector<PixelSums> sums;
    std::vector<HitPacket> stencil_hits;  ///< of the block at hand, one entry a stencil point
    RenderStats stats;
};

void trace_samples(Workspace& work, Vec2f offset) {
    const Timer timer(work.stats.trace_ms);
    work.hits.resize(work.blocks.size());
    work.sampler.trace_blocks(work.blocks, offset, work.hits);
}

void shade_samples(const Pipeline& pipeline, Workspace& work) {
    const Timer timer(work.stats.shade_ms);
    work.colors.resize(work.blocks.size());
    work.seen.resize(work.blocks.size());
    for (std::size_t k = 0; k < work.blocks.size(); ++k) {
        work.seen[k] = pipeline.shader.shade(work.hits[k], work.colors[k]) ? 1 : 0;
    }
}

/// Section 3.1, case 1: m stencil rays hit other geometry than s; the edge strength is e_M(m).
void measure_strength(const Pipeline& pipeline, const HitPacket& samples,
                      const std::vector<HitPacket>& stencil, Lanes<float>& strength) {
    Lanes<GeometryId> own;
    Lanes<GeometryId> other;
    Lanes<std::int32_t> m{};
    pipeline.ids.resolve(samples, own);
    for (const HitPacket& hits : stencil) {
        pipeline.ids.resolve(hits, other);
        count_foreign(own, other, m);
    }
    for (int i = 0; i < kLanes; ++i) {
        strength[i] = pipeline.strengths[static_cast<std::size_t>(m[i])];
    }
}

/// Section 4.2: the sample's colour becomes the mean over itself and its stencil.
void average_colors(const Pipeline& pipeline, const std::vector<HitPacket>& stencil,
                    ColorPacket& colors) {
    ColorPacket one;
    for (const HitPacket& hits : stencil) {
        pipeline.shader.shade(hits, one);
        add(one, colors);
    }
    scale(colors, 1.0F / static_cast<float>(stencil.size() + 1));
}

void trace_stencils(const Pipeline& pipeline, Workspace& work, Vec2f offset) {
    const Timer timer(work.stats.lines_ms);
    work.strengths.assign(work.blocks.size(), {});
    if (pipeline.stencil.empty()) return;
    for (std::size_t k = 0; k < work.blocks.size(); ++k) {
        work.sampler.trace_stencils(work.blocks[k], offset, pipeline.stencil,
                                    pipeline.shade_stencil, work.stencil_hits);
        if (pipeline.draw_lines) {
            measure_strength(pipeline, work.hits[k], work.stencil_hits, work.strengths[k]);
        }
        if (pipeline.shade_stencil) average_colors(pipeline, work.stencil_hits, work.colors[k]);
    }
}

void mix_samples(const Pipeline& pipeline, Workspace& work) {
    if (pipeline.plain()) return;
    const Timer timer(work.stats.shade_ms);
    work.sums.resize(work.blocks.size());
    for (std::size_t k = 0; k < work.blocks.size(); ++k) {
        pipeline.film.add(work.colors[k], work.strengths[k], work.sums[k]);
    }
}

void write_pixels(const Pipeline& pipeline, Workspace& work) {
    const Timer timer(work.stats.shade_ms);
    for (std::size_t k = 0; k < work.blocks.size(); ++k) {
        const Block block = work.blocks[k];
        if (!pipeline.plain()) {
            pipeline.film.put(block.x, block.y, work.sums[k]);
        } else if (work.seen[k] != 0) {
            pipeline.film.put(block.x, block.y, work.colors[k]);
        } else {
            pipeline.film.put_background(block.x, block.y);
        }
    }
    for (const Block block : work.empty) {
        pipeline.film.put_background(block.x, block.y);
    }
}

void write_aovs(const Pipeline& pipeline, const Workspace& work, Vec2f offset) {
    static const HitPacket kMiss = HitPacket::miss();
    for (std::size_t k = 0; k < work.blocks.size(); ++k) {
        pipeline.aovs->put(work.blocks[k], offset, work.hits[k], work.strengths[k]);
    }
    for (const Block block : work.empty) pipeline.aovs->put(block, offset, kMiss, {});
}

/// Choudhury and Parker 2009, section 3.2, for the pixels of a tile: every sample ray s is traced
/// and shaded as normal with colour c_s; its ray stencil is traced and gives the edge strength e_s;
/// c_s is mixed with the line's colour by e_s; a pixel is the mean of its samples.
void render_tile(const Pipeline& pipeline, Workspace& work, const Tile& tile) {
    sort_blocks(tile, pipeline.camera, pipeline.reach, work.blocks, work.empty);
    work.sums.clear();
    for (const Vec2f offset : pipeline.samples) {
        trace_samples(work, offset);
        shade_samples(pipeline, work);
        trace_stencils(pipeline, work, offset);
        mix_samples(pipeline, work);
        if (pipeline.aovs && offset == pipeline.samples[0]) write_aovs(pipeline, work, offset);
    }
    write_pixels(pipeline, work);
}

/// Counts finished tiles and passes them on, one at a time.
class Progress {
  public:
    Progress(const RenderControl& control, std::size_t tiles) : control_(control), tiles_(tiles) {}

    void check_cancelled() const {
        if (control_.cancel != nullptr && control_.cancel->load(std::memory_order_relaxed)) {
            throw Cancelled();
        }
    }
    void tile_done() {
        if (!control_.progress) return;
        const std::scoped_lock lock(mutex_);
        ++done_;
        control_.progress(static_cast<double>(done_) / static_cast<double>(tiles_));
    }

  private:
    const RenderControl& control_;
    std::size_t tiles_;
    std::size_t done_ = 0;
    std::mutex mutex_;
};

RenderStats total(const std::vector<std::unique_ptr<Workspace>>& workers) {
    RenderStats sum;
    for (const auto& worker : workers) {
        if (!worker) continue;
        sum.trace_ms += worker->stats.trace_ms;
        sum.lines_ms += worker->stats.lines_ms;
        sum.shade_ms += worker->stats.shade_ms;
        sum.rays += worker->sampler.rays();
    }
    const auto threads = static_cast<double>(workers.size());
    sum.threads = static_cast<int>(workers.size());
    sum.trace_ms /= threads;
    sum.lines_ms /= threads;
    sum.shade_ms /= threads;
    return sum;
}

}  // namespace

Film render(const Scene& scene, const Tracer& tracer, const Settings& settings,
            const PixelFormats& formats, const RenderControl& control, RenderStats* stats) {
    const Clock::time_point start = Clock::now();
    validate(settings);
    Film film(settings.size, film_settings(settings, formats));
    const Pipeline pipeline(scene, tracer, settings, film);
    const std::vector<Tile> tiles = cut_into_tiles(settings.size, settings.tile);

    const int threads = settings.threads > 0 ? settings.threads : hardware_threads();
    std::vector<std::unique_ptr<Workspace>> workers(static_cast<std::size_t>(threads));
    Progress progress(control, tiles.size());
    parallel_for(tiles.size(), threads, [&](std::size_t i, std::size_t worker) {
        progress.check_cancelled();
        if (!workers[worker]) workers[worker] = std::make_unique<Workspace>(pipeline);
        render_tile(pipeline, *workers[worker], tiles[i]);
        progress.tile_done();
    });

    if (stats != nullptr) {
        *stats = total(workers);
        stats->render_ms = ms_since(start);
    }
    return film;
}

}  // namespace ink
