#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "base/parallel.h"
#include "base/timer.h"
#include "lines/ridges.h"
#include "lines/stencil_features.h"
#include "lines/strength.h"
#include "render/pipeline.h"
#include "render/ridge_search.h"
#include "render/tiles.h"
#include "render/work_loop.h"
#include "sampling/sampler.h"
#include "sampling/stencil.h"

namespace ink {

namespace {

/// The method's fixed parts, shared by all tiles.
struct Stencils {
    explicit Stencils(const Pipeline& shared)
        : pipeline(shared),
          samples(multisample_offsets(shared.settings.smoothing().samples)),
          outlines(shared.settings.lines.has(LineType::silhouette) ||
                   shared.settings.lines.has(LineType::intersection)),
          creases(shared.settings.lines.has(LineType::crease)),
          occlusions(shared.settings.lines.has(LineType::self_occlusion)),
          ridges(shared.settings.lines.has(LineType::ridge)),
          draw_lines(shared.settings.draws_lines() &&
                     (outlines || creases || occlusions || ridges)),
          shaded(shared.settings.smoothing().kind == AntiAliasing::Kind::stencil) {
        const Settings& settings = shared.settings;
        if (!draw_lines && !shaded) return;
        const auto radius = static_cast<float>(settings.line_width_px() * 0.5);
        points = ring_stencil(radius, settings.rings);
        axes = stencil_axes(settings.rings);
        const float crease = settings.thresholds.crease_gradient * 2.0F * radius;
        crease_squared = crease * crease;
        half_width = radius;
        reach = radius + 1.0F;
        if (draw_lines && ridges) {
            // The sample itself stands first: it is the centre of the fit.
            constexpr int kRidgeRings = 2;
            ridge_reach = static_cast<float>(settings.ridge_scale_px()) + 1.0F;
            ridge_points = ring_stencil(ridge_reach - 1.0F, kRidgeRings);
            std::vector<Vec2f> all{{0.0F, 0.0F}};
            all.insert(all.end(), ridge_points.begin(), ridge_points.end());
            ridge_estimator.emplace(all, ridge_settings(settings));
        }
        const int M = static_cast<int>(points.size());
        const Metric metric = settings.profile();
        for (int m = 0; m <= M; ++m) strengths.push_back(edge_strength(metric, m, M));
    }

    /// One sample a pixel and no lines: its colour is the pixel.
    bool plain() const { return samples.size() == 1 && !draw_lines; }
    bool traces_pixels() const { return plain() && !shaded && !pipeline.aovs; }

    const Pipeline& pipeline;
    std::vector<Vec2f> samples;       ///< a pixel's sample rays, offsets from its centre
    std::vector<Vec2f> points;        ///< of a stencil, offsets from the sample; empty: not needed
    std::vector<float> strengths;     ///< e_M(m) for m = 0..M
    StencilAxes axes{};               ///< among `points`
    float crease_squared = 0.0F;      ///< least square of the normal's difference across a stencil
    float half_width = 0.0F;          ///< of a line, pixels
    float ridge_reach = 0.0F;         ///< of the stencil that ridges are found by, pixels
    std::vector<Vec2f> ridge_points;  ///< of the stencil that ridges are found by
    std::optional<RidgeEstimator> ridge_estimator;
    float reach = 0.0F;  ///< of the stencils of a pixel's samples beyond it, pixels
    bool outlines, creases, occlusions, ridges;  ///< which lines are wanted
    bool draw_lines;
    bool shaded;  ///< stencil anti-aliasing
};

/// What one thread reuses from tile to tile. Arrays have one entry a block.
struct Workspace {
    explicit Workspace(const Stencils& stencils)
        : sampler(*stencils.pipeline.frame, stencils.pipeline.camera),
          takes_shades(stencils.traces_pixels() && stencils.pipeline.shader.needs_normals_only() &&
                       sampler.want_shades()),
          stencil_hits(stencils.points.size()),
          ridge_hits(stencils.ridge_points.size()) {}

    Sampler sampler;
    bool takes_shades;  ///< normals to shade by come with the hits
    std::vector<Block> blocks, empty;
    std::vector<HitPacket> hits;             ///< of the sample rays
    std::vector<NormalPacket> normals;       ///< if they do
    std::vector<PointPacket> sample_points;  ///< if self-occlusions or ridges are looked for
    std::vector<ColorPacket> colors;         ///< c_s
    std::vector<std::uint8_t> seen;          ///< 0: nothing but background
    std::vector<Lanes<float>> strengths;     ///< e_s
    std::vector<PixelSums> sums;
    std::vector<HitPacket> stencil_hits;  ///< of the block at hand, one entry a stencil point
    std::vector<HitPacket> ridge_hits;    ///< likewise, of the ridge stencil
    std::vector<std::array<Sample, kLanes>> ridge_samples;  ///< of the sample, then its stencil
    std::vector<Vec3f> ridge_normals;
    RenderStats stats;
};

void trace_samples(const Stencils& stencils, Workspace& work, Vec2f offset) {
    const Timer timer(work.stats.trace_ms);
    work.hits.resize(work.blocks.size());
    work.sampler.trace_blocks(work.blocks, offset, work.hits);
    if (stencils.draw_lines && (stencils.occlusions || stencils.ridges)) {
        const auto points = work.sampler.points();
        work.sample_points.assign(points.begin(), points.end());
    }
}

void shade_samples(const Stencils& stencils, Workspace& work) {
    const Timer timer(work.stats.shade_ms);
    work.colors.resize(work.blocks.size());
    work.seen.resize(work.blocks.size());
    constexpr std::size_t kAhead = 4;
    const Shader& shader = stencils.pipeline.shader;
    for (std::size_t k = 0; k < work.blocks.size(); ++k) {
        if (k + kAhead < work.blocks.size()) shader.prefetch(work.hits[k + kAhead]);
        work.seen[k] = shader.shade(work.sampler.packets()[k], work.sampler.points()[k],
                                    work.hits[k], work.colors[k])
                           ? 1
                           : 0;
    }
}

/// Where a pixel is its one sample, straight from the ray to the film, a few blocks at a time: they
/// do not leave the nearest cache.
void trace_pixels(const Stencils& stencils, Workspace& work) {
    constexpr std::size_t kRun = 16;
    const Shader& shader = stencils.pipeline.shader;
    LapTimer timer;
    work.hits.resize(kRun);
    work.normals.resize(kRun);
    work.sampler.find_blocks(work.blocks, stencils.samples[0]);
    ColorPacket colors;
    for (std::size_t first = 0; first < work.blocks.size(); first += kRun) {
        const std::size_t count = std::min(kRun, work.blocks.size() - first);
        const auto hits = std::span(work.hits).first(count);
        if (work.takes_shades) {
            work.sampler.take_shades(first, hits, std::span(work.normals).first(count));
        } else {
            work.sampler.take_hits(first, hits);
        }
        timer.lap(work.stats.trace_ms);
        if (!work.takes_shades) {
            for (std::size_t k = 0; k < count; ++k) shader.prefetch(work.hits[k]);
        }
        for (std::size_t k = 0; k < count; ++k) {
            const Block block = work.blocks[first + k];
            const bool seen =
                work.takes_shades
                    ? shader.shade(work.hits[k], work.normals[k], block.is_strip(), colors)
                    : shader.shade(work.sampler.packets()[first + k],
                                   work.sampler.points()[first + k], work.hits[k], colors);
            if (seen) {
                stencils.pipeline.film.put(block.x, block.y, colors);
            } else {
                stencils.pipeline.film.put_background(block.x, block.y);
            }
        }
        timer.lap(work.stats.shade_ms);
    }
}

/// Section 3.1, case 1: m, the number of stencil rays that hit other geometry than s. True where
/// case 2 is left to look at: s hit something on which there can be a line, and m = 0.
bool count_foreign(const Stencils& stencils, const HitPacket& samples,
                   const std::vector<HitPacket>& stencil, Lanes<std::int32_t>& m) {
    const LineIds& ids = stencils.pipeline.ids;
    Lanes<GeometryId> own;
    Lanes<GeometryId> other;
    m.fill(0);
    ids.resolve(samples, own);
    for (const HitPacket& hits : stencil) {
        ids.resolve(hits, other);
        count_foreign(own, other, m);
    }
    bool any_alike = false;
    for (int i = 0; i < kLanes; ++i) {
        any_alike |= m[i] == 0 && own[i] != kBackground && !ids.is_ball(samples.object[i]);
    }
    return any_alike;
}

/// Section 3.1, case 2: |n_right - n_left|^2 + |n_up - n_down|^2 over the outer ring.
void measure_normal_gradient(const Stencils& stencils, Workspace& work, Lanes<float>& squared) {
    const auto normals = [&](std::size_t k) {
        // Stencils that are shaded have their normals already.
        if (!stencils.shaded) work.sampler.complete(k, work.stencil_hits[k]);
        NormalPacket packet;
        stencils.pipeline.shader.line_normals(work.stencil_hits[k], packet);
        return AxisNormals{packet.x, packet.y, packet.z};
    };
    squared.fill(0.0F);
    add_normal_difference(normals(stencils.axes.right), normals(stencils.axes.left), squared);
    add_normal_difference(normals(stencils.axes.up), normals(stencils.axes.down), squared);
}

/// Section 3.1, case 2: d, the number of stencil rays with |t_r - t_s| > T.
void count_depth_jumps(const Stencils& stencils, const Workspace& work, std::size_t block,
                       Lanes<std::int32_t>& d) {
    const Camera& camera = stencils.pipeline.camera;
    const float share = stencils.pipeline.settings.thresholds.depth_share;
    Lanes<float> own;
    Lanes<float> other;
    Lanes<float> threshold;
    camera.distances_from_eye(work.sample_points[block], work.hits[block].t, own);
    for (int i = 0; i < kLanes; ++i) threshold[i] = share * own[i];
    d.fill(0);
    for (std::size_t k = 0; k < work.stencil_hits.size(); ++k) {
        camera.distances_from_eye(work.sampler.points()[k], work.stencil_hits[k].t, other);
        count_depth_jumps(own, other, threshold, d);
    }
}

/// Section 3.1: the strength e_s of every sample of a block, whose stencils have just been traced.
void measure_strength(const Stencils& stencils, Workspace& work, std::size_t block,
                      Lanes<float>& strength) {
    const auto e = [&](std::int32_t rays) {
        return stencils.strengths[static_cast<std::size_t>(rays)];
    };
    Lanes<std::int32_t> m;
    const bool any_alike = count_foreign(stencils, work.hits[block], work.stencil_hits, m);
    for (int i = 0; i < kLanes; ++i) strength[i] = stencils.outlines ? e(m[i]) : 0.0F;
    if (!any_alike || !(stencils.creases || stencils.occlusions)) return;

    Lanes<float> gradient{};
    Lanes<std::int32_t> d{};
    if (stencils.creases) measure_normal_gradient(stencils, work, gradient);
    if (stencils.occlusions) count_depth_jumps(stencils, work, block, d);
    for (int i = 0; i < kLanes; ++i) {
        const std::uint32_t object = work.hits[block].object[i];
        if (m[i] != 0 || object == kNoObject || stencils.pipeline.ids.is_ball(object)) continue;
        strength[i] = gradient[i] > stencils.crease_squared ? 1.0F : e(d[i]);
    }
}

/// What a packet saw, lane by lane.
std::array<Sample, kLanes> samples_of(const Stencils& stencils, const RayPacket& rays,
                                      const HitPacket& hits) {
    std::array<Sample, kLanes> samples;
    NormalPacket normals;
    Lanes<GeometryId> ids;
    stencils.pipeline.shader.smooth(hits, normals);
    stencils.pipeline.ids.resolve(hits, ids);
    for (int i = 0; i < kLanes; ++i) {
        const float t = hits.t[i];
        Sample& sample = samples[static_cast<std::size_t>(i)];
        sample.id = ids[i];
        sample.position = {rays.origin_x[i] + t * rays.dir_x[i],
                           rays.origin_y[i] + t * rays.dir_y[i],
                           rays.origin_z[i] + t * rays.dir_z[i]};
        sample.normal = {normals.x[i], normals.y[i], normals.z[i]};
    }
    return samples;
}

/// Section 5.4: the strength of an apparent ridge at every sample of a block, by its distance from
/// the sample. A line at distance u h is as strong as a straight edge there (figure 4(c)).
void measure_ridges(const Stencils& stencils, Workspace& work, std::size_t block, Vec2f offset,
                    Lanes<float>& strength) {
    const auto& objects = work.hits[block].object;
    if (std::ranges::all_of(objects, [](auto object) { return object == kNoObject; })) return;
    work.sampler.trace_stencils(work.blocks[block], offset, stencils.ridge_points, work.ridge_hits);
    auto& samples = work.ridge_samples;
    samples.clear();
    RayPacket own;
    stencils.pipeline.camera.make_rays(work.sample_points[block].x, work.sample_points[block].y,
                                       own);
    samples.push_back(samples_of(stencils, own, work.hits[block]));
    for (std::size_t k = 0; k < work.ridge_hits.size(); ++k) {
        samples.push_back(samples_of(stencils, work.sampler.packets()[k], work.ridge_hits[k]));
    }
    work.ridge_normals.resize(samples.size());
    for (std::size_t i = 0; i < kLanes; ++i) {
        const Sample& centre = samples[0][i];
        const bool smooth = std::all_of(samples.begin() + 1, samples.end(), [&](const auto& other) {
            return one_surface(centre, other[i]);
        });
        if (!smooth) continue;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            work.ridge_normals[k] = samples[k][i].normal;
        }
        const RidgeEstimate ridge = stencils.ridge_estimator->estimate(work.ridge_normals);
        const double u = ridge.distance() / stencils.half_width;
        if (!(u < 1.0)) continue;
        const float e =
            straight_edge_strength(stencils.pipeline.settings.profile(), u) * ridge.strength;
        const auto lane = static_cast<int>(i);
        strength[lane] = std::max(strength[lane], e);
    }
}

/// Section 4.2: the sample's colour becomes the mean over itself and its stencil.
void average_colors(const Stencils& stencils, const Workspace& work, ColorPacket& colors) {
    ColorPacket one;
    for (std::size_t k = 0; k < work.stencil_hits.size(); ++k) {
        stencils.pipeline.shader.shade(work.sampler.packets()[k], work.sampler.points()[k],
                                       work.stencil_hits[k], one);
        add(one, colors);
    }
    scale(colors, 1.0F / static_cast<float>(work.stencil_hits.size() + 1));
}

/// Whether no stencil of a block has a line, because all its rays hit one ball: then m = 0, and
/// case 2 does not apply. Known without tracing them.
bool lies_on_one_ball(const Stencils& stencils, Workspace& work, std::size_t block, Vec2f offset) {
    const HitPacket& hits = work.hits[block];
    const std::uint32_t object = hits.object[0];
    if (object == kNoObject || !stencils.pipeline.ids.is_ball(object)) return false;
    for (int i = 1; i < kLanes; ++i) {
        if (hits.object[i] != object || hits.primitive[i] != hits.primitive[0]) return false;
    }
    return work.sampler.covers(object, hits.primitive[0], work.blocks[block], offset,
                               stencils.points);
}

void trace_stencils(const Stencils& stencils, Workspace& work, Vec2f offset) {
    const Timer timer(work.stats.lines_ms);
    work.strengths.assign(work.blocks.size(), {});
    if (stencils.points.empty()) return;
    for (std::size_t k = 0; k < work.blocks.size(); ++k) {
        if (!stencils.shaded && lies_on_one_ball(stencils, work, k, offset)) {
            work.strengths[k].fill(stencils.outlines ? stencils.strengths[0] : 0.0F);
        } else {
            if (stencils.shaded) {
                work.sampler.trace_stencils(work.blocks[k], offset, stencils.points,
                                            work.stencil_hits);
            } else {
                work.sampler.identify_stencils(work.blocks[k], offset, stencils.points,
                                               work.stencil_hits);
            }
            if (stencils.draw_lines) measure_strength(stencils, work, k, work.strengths[k]);
        }
        if (stencils.shaded) {
            average_colors(stencils, work, work.colors[k]);
            work.seen[k] = 1;
        }
        // Last, because it traces anew.
        if (stencils.draw_lines && stencils.ridges) {
            measure_ridges(stencils, work, k, offset, work.strengths[k]);
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
    const float reach = std::max(stencils.reach, stencils.ridge_reach);
    // Blocks at the film's edge are whole.
    const auto end = [](int first, int last) {
        return static_cast<float>(first +
                                  (last - first + kBlockSide - 1) / kBlockSide * kBlockSide);
    };
    work.sampler.enter({static_cast<float>(tile.x0) - reach, static_cast<float>(tile.y0) - reach,
                        end(tile.x0, tile.x1) + reach, end(tile.y0, tile.y1) + reach});
    sort_blocks(tile, work.sampler, stencils.reach, work.blocks, work.empty);
    for (const Block block : work.empty) {
        stencils.pipeline.film.put_background(block.x, block.y);
    }
    if (stencils.traces_pixels()) return trace_pixels(stencils, work);
    work.sums.clear();
    for (const Vec2f offset : stencils.samples) {
        trace_samples(stencils, work, offset);
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
