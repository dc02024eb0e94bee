#include "render/edges_method.h"

#include <memory>
#include <optional>

#include "base/parallel.h"
#include "render/hidden_lines.h"
#include "render/line_drawer.h"
#include "render/line_finder.h"
#include "render/line_mask.h"
#include "render/mend_lines.h"

namespace ink {

namespace {

/// Hands out what the drawing needs of the segments of all tiles.
void keep_lines(const Edges& edges, const std::vector<TileLines>& found,
                const std::vector<std::vector<Segment>>& toned,
                const std::vector<std::vector<Segment>>& hidden, Drawing& drawing) {
    drawing.spacing = 1.0F / static_cast<float>(edges.q);
    const Vec2f half{0.5F * drawing.spacing, 0.5F * drawing.spacing};
    const Tile& first = edges.search_tiles.front();
    const Tile& last = edges.search_tiles.back();
    // For any odd lattice the same: half a pixel within what was searched.
    const Vec2f inside = Vec2f{0.5F, 0.5F} + (edges.q % 2 == 0 ? half : Vec2f{});
    drawing.lower = Vec2f{static_cast<float>(first.x0), static_cast<float>(first.y0)} + inside;
    drawing.upper = Vec2f{static_cast<float>(last.x1), static_cast<float>(last.y1)} - inside;
    drawing.segments.clear();
    for (const TileLines& tile : found) {
        for (Segment segment : tile.segments) {
            const bool divides = segment.left != segment.right && segment.level == 0;
            if (!divides && !edges.wanted.has(segment.type)) continue;
            if (edges.tones) {
                const bool again = segment.level == 0 && segment.type != LineType::ridge;
                if (again) continue;  // they come with tones
                Tones::double_ids(segment);
            }
            drawing.segments.push_back(segment);
        }
    }
    drawing.tones = edges.tones;
    for (const std::vector<Segment>& tile : toned) {
        for (const Segment& segment : tile) {
            if (segment.left != segment.right || edges.wanted.has(segment.type)) {
                drawing.segments.push_back(segment);
            }
        }
    }
    drawing.hidden.clear();
    for (const std::vector<Segment>& tile : hidden) {
        drawing.hidden.insert(drawing.hidden.end(), tile.begin(), tile.end());
    }
    const auto is_outside = [&](const Segment& line) {
        const Vec2f middle = (line.a + line.b) * 0.5F;
        return middle.x < drawing.lower.x || middle.y < drawing.lower.y ||
               middle.x > drawing.upper.x || middle.y > drawing.upper.y;
    };
    for (std::vector<Segment>* lines : {&drawing.segments, &drawing.hidden}) {
        std::erase_if(*lines, is_outside);
        for (Segment& line : *lines) {
            line.t = edges.pipeline.camera.distance_from_eye(line.a, line.t) * edges.pipeline.unit;
        }
    }
}

/// Where there are lines on surfaces seen directly, but not between faces, so near that a ridge
/// beside them would touch them.
LineMask mask_of(const Edges& edges, const std::vector<TileLines>& found) {
    LineMask mask(edges.search_area());
    const auto mark = [&](Vec2f a, Vec2f b, std::size_t style) {
        constexpr float kBetween = 0.5F;  // what the eye does not tell from none, pixels
        const float ridge = edges.ink.styles[edges.style_of(LineType::ridge, 0)].width_px;
        mask.mark((a + b) * 0.5F, 0.5F * (edges.ink.styles[style].width_px + ridge) + kBetween);
    };
    for (const TileLines& tile : found) {
        for (const Segment& segment : tile.segments) {
            if (segment.level > 0 || segment.type == LineType::mesh) continue;
            if (edges.wanted.has(segment.type)) mark(segment.a, segment.b, edges.style_of(segment));
        }
        if (edges.keeps_segments()) continue;
        for (const InkStroke& stroke : tile.strokes) {
            const auto type = static_cast<LineType>(stroke.style % kLineTypes);
            if (stroke.direct && type != LineType::mesh) mark(stroke.a, stroke.b, stroke.style);
        }
    }
    return mask;
}

/// Once all tiles have kept what ridges are found from, and the other lines are there. Returns what
/// they add to the density of lines.
LineDensity add_ridges(const Edges& edges, RidgeSearch& search, WorkLoop& loop, FoundLines& found,
                       RenderStats& stats) {
    LineDensity density = edges.no_lines;
    RenderStats serial;
    search.find(loop, stats);
    {
        const Timer timer(serial.lines_ms);
        const Timer phase(serial.ridges_ms);
        const LineMask others = mask_of(edges, found.tiles);
        const bool wants_segments = edges.wants_segments();
        search.take(others, [&](Segment& ridge) {
            edges.apply_distance(ridge);
            TileLines& tile = found.tiles[edges.search_tile_at((ridge.a + ridge.b) * 0.5F)];
            const InkStroke stroke = make_ink_stroke(ridge, edges.style_of(ridge));
            density.add(stroke, edges.ink.styles[stroke.style].width_px * stroke.width_scale);
            if (wants_segments) tile.segments.push_back(ridge);
            if (edges.draw_lines) tile.strokes.push_back(stroke);
        });
    }
    for (double RenderStats::*const ms : {&RenderStats::lines_ms, &RenderStats::ridges_ms}) {
        stats.*ms += serial.*ms * loop.threads();  // the others wait
    }
    return density;
}

/// From what all workers have counted, and the ridges.
LineThinning thinning_of(const Edges& edges,
                         const std::vector<std::unique_ptr<LineFinder>>& finders,
                         const LineDensity& ridges) {
    LineThinning thinning{ridges, ridges, static_cast<float>(edges.pipeline.settings.line_density)};
    const bool goes_on = edges.pipeline.goes_on();
    for (const auto& finder : finders) {
        if (!finder) continue;
        thinning.all += finder->density();
        thinning.direct += goes_on ? finder->direct_density() : finder->density();
    }
    thinning.all.finish();
    thinning.direct.finish();
    return thinning;
}

/// Puts the pixels on the film to which lines of several tiles add, and mends lines: much of that
/// is for one thread, while the others have pixels to put.
RenderStats finish_tiles(const Edges& edges, std::vector<std::unique_ptr<LineFinder>>& finders,
                         FoundLines& found, WorkLoop& loop) {
    std::vector<const Fringe*> fringes;
    if (edges.smooth_shading) {
        fringes.reserve(found.tiles.size());
        for (const TileLines& tile : found.tiles) fringes.push_back(&tile.fringe);
    }
    const ColorPacket& empty = edges.pipeline.shader.background();
    const PixelColor background{empty.r[0], empty.g[0], empty.b[0], empty.a[0]};
    RenderStats mending;
    const std::size_t mends = edges.mends_lines() ? 1 : 0;
    loop.expect(mends);
    loop.run(mends + fringes.size(), [&](std::size_t i, std::size_t) {
        if (i < mends) {
            mending = mend_lines(edges, finders, found.tiles, found.toned);
        } else {
            finish_fringe(edges.search_tiles, fringes, edges.search_tiles_across(), i - mends,
                          background, edges.pipeline.film);
        }
    });
    return mending;
}

template <class Worker>
RenderStats total_of(const std::vector<std::unique_ptr<Worker>>& workers) {
    RenderStats total;
    for (const auto& worker : workers) {
        if (worker) total += worker->stats();
    }
    return total;
}

}  // namespace

FoundLines find_lines(const Edges& edges, WorkLoop& loop, RenderStats& stats) {
    const Pipeline& pipeline = edges.pipeline;
    const auto pool = static_cast<std::size_t>(loop.threads());
    FoundLines found;
    found.tiles.resize(edges.search_tiles.size());
    found.toned.resize(edges.search_tiles.size());
    found.hidden.resize(edges.search_tiles.size());
    if (edges.wants_faces() && pipeline.lines.enlargement != nullptr) {
        found.tiling.emplace(pipeline.scene, pipeline.camera.projection(),
                             *pipeline.lines.enlargement);
    } else if (edges.draws_borders()) {
        found.borders.emplace(pipeline.settings.size, edges.ink.reach(),
                              edges.ink.has_several_inks());
    } else if (edges.wants_faces()) {
        found.faces.emplace(pipeline.scene, pipeline.settings.size, edges.q);
    }
    const FaceMaps maps{found.faces ? &*found.faces : nullptr,
                        found.borders ? &*found.borders : nullptr,
                        found.tiling ? &*found.tiling : nullptr};
    std::optional<RidgeSearch> ridges;
    if (edges.wants_ridges()) {
        ridges.emplace(pipeline, edges.viewpoint, edges.q, edges.search_area(), loop.threads());
        loop.expect(ridges->items());
    }
    std::vector<std::unique_ptr<LineFinder>> finders(pool);
    std::vector<std::unique_ptr<HiddenLineFinder>> behind(pool);
    loop.run(edges.search_tiles.size(), [&](std::size_t i, std::size_t worker) {
        if (!finders[worker]) {
            finders[worker] =
                std::make_unique<LineFinder>(edges, maps, ridges ? &*ridges : nullptr);
        }
        found.tiles[i] = finders[worker]->search(edges.search_tiles[i]);
        if (edges.tones) found.toned[i] = finders[worker]->take_toned();
        if (edges.behind.empty()) return;
        if (!behind[worker]) behind[worker] = std::make_unique<HiddenLineFinder>(edges);
        found.hidden[i] = behind[worker]->search(edges.search_tiles[i], *finders[worker]);
    });

    stats += finish_tiles(edges, finders, found, loop);
    const LineDensity ridge_density =
        ridges ? add_ridges(edges, *ridges, loop, found, stats) : edges.no_lines;
    found.thinning = thinning_of(edges, finders, ridge_density);
    stats += total_of(finders);
    stats += total_of(behind);
    return found;
}

void add_hidden_strokes(const Edges& edges, FoundLines& found) {
    if (!edges.draw_lines || edges.behind.empty()) return;
    std::vector<Segment> lines;
    for (const std::vector<Segment>& tile : found.hidden) {
        lines.insert(lines.end(), tile.begin(), tile.end());
    }
    for (const Segment& stroke : hidden_strokes(edges, lines)) {
        // Where the tiles that draw look for lines.
        const Vec2f middle = (stroke.a + stroke.b) * 0.5F;
        TileLines& tile = found.tiles[edges.search_tile_at(middle)];
        tile.strokes.push_back(make_ink_stroke(stroke, edges.style_of(stroke)));
        if (edges.wants_segments()) tile.segments.push_back(stroke);
    }
}

void draw_lines(const Edges& edges, const FoundLines& found, WorkLoop& loop, RenderStats& stats) {
    std::optional<ScreenVertices> vertices;
    if (found.faces) {
        const Pipeline& pipeline = edges.pipeline;
        vertices.emplace(pipeline.scene, pipeline.camera.projection(), pipeline.settings.size,
                         loop.threads());
    }
    std::vector<std::unique_ptr<LineDrawer>> drawers(static_cast<std::size_t>(loop.threads()));
    loop.run(edges.draw_tiles.size(), [&](std::size_t i, std::size_t worker) {
        if (!drawers[worker]) {
            drawers[worker] = std::make_unique<LineDrawer>(
                edges, found.thinning, found.faces ? &*found.faces : nullptr,
                vertices ? &*vertices : nullptr, found.borders ? &*found.borders : nullptr,
                found.tiling ? &*found.tiling : nullptr);
        }
        drawers[worker]->draw(edges.draw_tiles[i], found.tiles);
    });
    stats += total_of(drawers);
}

RenderStats render_edges(const Pipeline& pipeline, const RenderControl& control) {
    const Edges edges(pipeline);
    const int threads =
        pipeline.settings.threads > 0 ? pipeline.settings.threads : hardware_threads();
    const std::size_t fringes = edges.smooth_shading ? edges.search_tiles.size() : 0;
    WorkLoop loop(threads, control, edges.search_tiles.size() + fringes + edges.draw_tiles.size());
    RenderStats stats;
    FoundLines found = find_lines(edges, loop, stats);
    if (pipeline.lines.drawing != nullptr) {
        keep_lines(edges, found.tiles, found.toned, found.hidden, *pipeline.lines.drawing);
        pipeline.lines.drawing->thinning = found.thinning;
    }
    add_hidden_strokes(edges, found);
    draw_lines(edges, found, loop, stats);
    return stats.mean_over(threads);
}

}  // namespace ink
