#include <memory>
#include <vector>

#include "base/parallel.h"
#include "lines/strength.h"
#include "render/pipeline.h"
#include "render/tiles.h"
#include "sampling/sampler.h"
#include "sampling/stencil.h"

namespace ink {

namespace {

/// The method's fixed parts, shared by all tiles.
struct Stencils {
    explicit Stencils(const Pipeline& shared)
        : pipeline(shared),
          samples(multisample_offsets(shared.settings.smoothing().samples)),
          draw_lines(shared.settings.draws_lines() &&
                     (shared.settings.lines.has(LineType::silhouette) ||
                      shared.settings.lines.has(LineType::intersection))),
          shaded(shared.settings.smoothing().kind == AntiAliasing::Kind::stencil) {
        const Settings& settings = shared.settings;
        if (!draw_lines && !shaded) return;
        const auto radius = static_cast<float>(settings.line_width_px() * 0.5);
        points = ring_stencil(radius, settings.rings);
        reach = radius + 1.0F;
        const int M = static_cast<int>(points.size());
        const Metric metric = settings.profile();
        for (int m = 0; m <= M; ++m) strengths.push_back(edge_strength(metric, m, M));
    }

    /// One sample a pixel and no lines: its colour is the pixel.
    bool plain() const { return samples.size() == 1 && !draw_lines; }

    const Pipeline& pipeline;
    std::vector<Vec2f> samples;    ///< a pixel's sample rays, offsets from its centre
    std::vector<Vec2f> points;     ///< of a stencil, offsets from the sample; empty: not needed
    std::vector<float> strengths;  ///< e_M(m) for m = 0..M
    float reach = 1.0F;            ///< of a pixel's samples and their stencils, pixels
    bool draw_lines;
    bool shaded;  ///< stencil anti-aliasing
};

/// What one thread reuses from tile to tile. Arrays have one entry a block.
struct Workspace {
    explicit Workspace(const Stencils& stencils)
        : sampler(stencils.pipeline.tracer, stencils.pipeline.camera),
          stencil_hits(stencils.points.size()) {}

    Sampler sampler;
    std::vector<Block> blocks, empty;
    std::vector<HitPacket> hits;          ///< of the sample rays
    std::vector<ColorPacket> colors;      ///< c_s
    std::vector<std::uint8_t> seen;       ///< 0: nothing but background
    std::vector<Lanes<float>> strengths;  ///< e_s
    std::vector<PixelSums> sums;
    std::vector<HitPacket> stencil_hits;  ///< of the block at hand, one entry a stencil point
    RenderStats stats;
};

void trace_samples(Workspace& work, Vec2f offset) {
    const Timer timer(work.stats.trace_ms);
    work.hits.resize(work.blocks.size());
    work.sampler.trace_blocks(work.blocks, offset, work.hits);
}

/// Shades block k of the tile, of which those before it have been shaded. False: only background.
bool shade_block(const Stencils& stencils, const Workspace& work, std::size_t k,
                 ColorPacket& colors) {
    constexpr std::size_t kAhead = 4;
    const Shader& shader = stencils.pipeline.shader;
    if (k + kAhead < work.blocks.size()) shader.prefetch(work.hits[k + kAhead]);
    return shader.shade(work.hits[k], colors);
}

void shade_samples(const Stencils& stencils, Workspace& work) {
    const Timer timer(work.stats.shade_ms);
    work.colors.resize(work.blocks.size());
    work.seen.resize(work.blocks.size());
    for (std::size_t k = 0; k < work.blocks.size(); ++k) {
        work.seen[k] = shade_block(stencils, work, k, work.colors[k]) ? 1 : 0;
    }
}

/// Where a pixel is its one sample, straight from the ray to the film.
void shade_pixels(const Stencils& stencils, Workspace& work) {
    const Timer timer(work.stats.shade_ms);
    ColorPacket colors;
    for (std::size_t k = 0; k < work.blocks.size(); ++k) {
        const Block block = work.blocks[k];
        if (shade_block(stencils, work, k, colors)) {
            stencils.pipeline.film.put(block.x, block.y, colors);
        } else {
            stencils.pipeline.film.put_background(block.x, block.y);
        }
    }
}

/// Section 3.1, case 1: m stencil rays hit other geometry than s; the edge strength is e_M(m).
void measure_strength(const Stencils& stencils, const HitPacket& samples,
                      const std::vector<HitPacket>& stencil, Lanes<float>& strength) {
    Lanes<GeometryId> own;
    Lanes<GeometryId> other;
    Lanes<std::int32_t> m{};
    stencils.pipeline.ids.resolve(samples, own);
    for (const HitPacket& hits : stencil) {
        stencils.pipeline.ids.resolve(hits, other);
        count_foreign(own, other, m);
    }
    for (int i = 0; i < kLanes; ++i) {
        strength[i] = stencils.strengths[static_cast<std::size_t>(m[i])];
    }
}

/// Section 4.2: the sample's colour becomes the mean over itself and its stencil.
void average_colors(const Stencils& stencils, const std::vector<HitPacket>& stencil,
                    ColorPacket& colors) {
    ColorPacket one;
    for (const HitPacket& hits : stencil) {
        stencils.pipeline.shader.shade(hits, one);
        add(one, colors);
    }
    scale(colors, 1.0F / static_cast<float>(stencil.size() + 1));
}

void trace_stencils(const Stencils& stencils, Workspace& work, Vec2f offset) {
    const Timer timer(work.stats.lines_ms);
    work.strengths.assign(work.blocks.size(), {});
    if (stencils.points.empty()) return;
    for (std::size_t k = 0; k < work.blocks.size(); ++k) {
        work.sampler.trace_stencils(work.blocks[k], offset, stencils.points, stencils.shaded,
                                    work.stencil_hits);
        if (stencils.draw_lines) {
            measure_strength(stencils, work.hits[k], work.stencil_hits, work.strengths[k]);
        }
        if (stencils.shaded) {
            average_colors(stencils, work.stencil_hits, work.colors[k]);
            work.seen[k] = 1;
        }
    }
}

void mix_samples(const Stencils& stencils, Workspace& work) {
    if (stencils.plain()) return;
    const Timer timer(work.stats.shade_ms);
    work.sums.resize(work.blocks.size());
    for (std::size_t k = 0; k < work.blocks.size(); ++k) {
        stencils.pipeline.film.add(work.colors[k], work.strengths[k], work.sums[k]);
    }
}

void write_pixels(const Stencils& stencils, Workspace& work) {
    const Timer timer(work.stats.shade_ms);
    for (std::size_t k = 0; k < work.blocks.size(); ++k) {
        const Block block = work.blocks[k];
        if (!stencils.plain()) {
            stencils.pipeline.film.put(block.x, block.y, work.sums[k]);
        } else if (work.seen[k] != 0) {
            stencils.pipeline.film.put(block.x, block.y, work.colors[k]);
        } else {
            stencils.pipeline.film.put_background(block.x, block.y);
        }
    }
}

void write_aovs(const Stencils& stencils, const Workspace& work, Vec2f offset) {
    static const HitPacket kMiss = HitPacket::miss();
    for (std::size_t k = 0; k < work.blocks.size(); ++k) {
        stencils.pipeline.aovs->put(work.blocks[k], offset, work.hits[k]);
        stencils.pipeline.aovs->put_strength(work.blocks[k], work.strengths[k]);
    }
    for (const Block block : work.empty) stencils.pipeline.aovs->put(block, offset, kMiss);
}

/// Choudhury and Parker 2009, section 3.2, for the pixels of a tile: every sample ray s is traced
/// and shaded as normal with colour c_s; its ray stencil is traced and gives the edge strength e_s;
/// c_s is mixed with the line's colour by e_s; a pixel is the mean of its samples.
void render_tile(const Stencils& stencils, Workspace& work, const Tile& tile) {
    sort_blocks(tile, stencils.pipeline.camera, stencils.reach, work.blocks, work.empty);
    for (const Block block : work.empty) {
        stencils.pipeline.film.put_background(block.x, block.y);
    }
    if (stencils.plain() && !stencils.shaded && !stencils.pipeline.aovs) {
        trace_samples(work, stencils.samples[0]);
        return shade_pixels(stencils, work);
    }
    work.sums.clear();
    for (const Vec2f offset : stencils.samples) {
        trace_samples(work, offset);
        shade_samples(stencils, work);
        trace_stencils(stencils, work, offset);
        mix_samples(stencils, work);
        if (stencils.pipeline.aovs && offset == stencils.samples[0])
            write_aovs(stencils, work, offset);
    }
    write_pixels(stencils, work);
}

}  // namespace

RenderStats render_stencils(const Pipeline& pipeline, const RenderControl& control) {
    const Stencils stencils(pipeline);
    const Settings& settings = pipeline.settings;
    const std::vector<Tile> tiles = cut_into_tiles(settings.size, settings.tile);
    const int threads = settings.threads > 0 ? settings.threads : hardware_threads();
    std::vector<std::unique_ptr<Workspace>> workers(static_cast<std::size_t>(threads));
    WorkLoop(threads, control, tiles.size()).run(tiles.size(), [&](std::size_t i, std::size_t w) {
        if (!workers[w]) workers[w] = std::make_unique<Workspace>(stencils);
        render_tile(stencils, *workers[w], tiles[i]);
    });

    RenderStats total;
    for (const auto& worker : workers) {
        if (!worker) continue;
        worker->stats.rays = worker->sampler.rays();
        total += worker->stats;
    }
    return total.mean_over(threads);
}

}  // namespace ink
