#include "render/edges_method.h"

#include <memory>
#include <optional>

#include "base/parallel.h"
#include "render/line_drawer.h"

namespace ink {

namespace {

/// Hands out what the drawing needs of the segments of all tiles.
void keep_lines(const EdgesPlan& edges, const std::vector<TileLines>& found,
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

}  // namespace

void draw_lines(const EdgesPlan& edges, const FoundLines& found, WorkLoop& loop,
                RenderStats& stats) {
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
    for (const auto& drawer : drawers) {
        if (drawer) stats += drawer->stats();
    }
}

RenderStats render_edges(const Pipeline& pipeline, const RenderControl& control) {
    const EdgesPlan edges(pipeline);
    const int threads =
        pipeline.settings.threads > 0 ? pipeline.settings.threads : hardware_threads();
    WorkLoop loop(threads, control, edges.draw_tiles.size());
    RenderStats stats;
    LineSearch search(edges, loop);
    search.search_tiles();
    search.mend();
    search.finish();
    stats += search.stats();
    FoundLines& found = search.found();
    if (pipeline.lines.drawing != nullptr) {
        keep_lines(edges, found.tiles, found.toned, found.hidden, *pipeline.lines.drawing);
        pipeline.lines.drawing->thinning = found.thinning;
    }
    add_hidden_strokes(edges, found);
    draw_lines(edges, found, loop, stats);
    return stats.mean_over(threads);
}

}  // namespace ink
