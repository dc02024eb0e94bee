#include "render/draft.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/timer.h"
#include "camera/views.h"
#include "render/edges_method.h"
#include "render/enlarge.h"
#include "render/pipeline.h"
#include "render/scaled.h"
#include "render/work_loop.h"

namespace ink {

namespace {

/// The same view in fewer pixels.
Settings fewer_pixels(const Settings& settings, const Enlargement& enlargement) {
    Settings few = scaled(settings, 1.0 / enlargement.factor());
    few.size = enlargement.small();
    few.lattice = 1;
    few.aa = AntiAliasing{AntiAliasing::Kind::none, 1};
    // Each sees as much of the scene as several of the large picture's: small ones keep what they
    // need of it in the cache, and share out evenly.
    constexpr int kTile = 32;
    few.tile = std::min(few.tile, kTile);
    return few;
}

/// Lines of the small picture become strokes of the large one, in the tiles in which its
/// `LineDrawer` looks for them.
void enlarge_lines(const FoundLines& found, const Enlargement& enlargement, const EdgesPlan& large,
                   std::vector<TileLines>& tiles) {
    std::vector<InkStroke> strokes;
    std::vector<std::size_t> places;  // tiles
    std::size_t most = found.of_no_tile.size();
    for (const TileLines& tile : found.tiles) most += tile.segments.size();
    strokes.reserve(most);
    places.reserve(most);
    std::vector<std::size_t> counts(tiles.size());
    const auto add = [&](Segment line) {
        if (!large.wanted.has(line.type)) return;
        line.a = enlargement.enlarged(line.a);
        line.b = enlargement.enlarged(line.b);
        strokes.push_back(make_ink_stroke(line, large.style_of(line)));
        places.push_back(large.search_tile_at((line.a + line.b) * 0.5F));
        ++counts[places.back()];
    };
    for (const TileLines& tile : found.tiles) std::ranges::for_each(tile.segments, add);
    std::ranges::for_each(found.of_no_tile, add);
    for (std::size_t k = 0; k < tiles.size(); ++k) tiles[k].strokes.reserve(counts[k]);
    for (std::size_t k = 0; k < strokes.size(); ++k) tiles[places[k]].strokes.push_back(strokes[k]);
}

LineThinning enlarged(LineThinning thinning, const Enlargement& enlargement) {
    for (LineDensity* density : {&thinning.all, &thinning.direct}) {
        density->enlarge(enlargement.factor(), enlargement.small_middle(),
                         enlargement.large_middle());
    }
    return thinning;
}

/// Enlarges the shaded pixels in bands of rows. `faces`: null if there are none.
SideWork enlarging(const PixelEnlarger& enlarger, FaceTiling* faces, Film& large) {
    constexpr int kRows = 32;
    const int height = large.size().height;
    const auto bands = static_cast<std::size_t>((height + kRows - 1) / kRows);
    return {bands, [&enlarger, &large, faces, height](std::size_t band) {
                const int first = static_cast<int>(band) * kRows;
                const int last = std::min(height, first + kRows);
                for (int y = first; y < last; ++y) enlarger.enlarge_row(y, large);
                if (faces != nullptr) faces->look_nowhere(first, last);
            }};
}

/// What is for one thread, to mend lines, to take ridges and to enlarge both, is done while the
/// others enlarge pixels or sharpen them along the lines. Ridges are found while lines are mended.
RenderStats render_fewer_rays(const Pipeline& few, const Pipeline& full,
                              const Enlargement& enlargement, const RenderControl& control) {
    const EdgesPlan small(few);
    const EdgesPlan large(full);
    const int threads = few.settings.threads > 0 ? few.settings.threads : hardware_threads();
    const PixelEnlarger enlarger(enlargement, few.film.display());
    const std::size_t tiles = small.search_tiles.size();
    WorkLoop loop(threads, control, tiles + 1 + large.draw_tiles.size());
    LineSearch search(small, loop);
    FoundLines& found = search.found();
    FaceTiling* const faces = found.tiling ? &*found.tiling : nullptr;
    const SideWork rows = enlarging(enlarger, faces, full.film);
    // Each cell of the lattice belongs to one tile, so threads sharpen different pixels.
    const SideWork cells{tiles, [&](std::size_t k) {
                             enlarger.sharpen(small.search_tiles[k], found.tiles[k].segments,
                                              full.film, faces);
                         }};
    loop.expect(rows.items);
    search.search_tiles();
    const bool finds_ridges = small.wants_ridges();
    search.mend(finds_ridges ? SideWork{} : rows);

    FoundLines lines;
    lines.tiles.resize(large.search_tiles.size());
    const SideWork& beside = finds_ridges ? rows : cells;
    loop.run(1 + beside.items, [&](std::size_t i, std::size_t) {
        if (i > 0) return beside.body(i - 1);
        search.finish();
        add_hidden_strokes(small, found);
        enlarge_lines(found, enlargement, large, lines.tiles);
        lines.thinning = enlarged(std::move(found.thinning), enlargement);
    });
    if (finds_ridges) {
        loop.run(cells.items, [&](std::size_t k, std::size_t) { cells.body(k); });
    }
    lines.tiling = std::move(found.tiling);
    RenderStats stats = search.stats();
    draw_lines(large, lines, loop, stats);
    return stats.mean_over(threads);
}

}  // namespace

Film render_draft(const Scene& scene, const Tracer& tracer, const Settings& settings, double share,
                  const RenderControl& control, RenderStats* stats) {
    double render_ms = 0.0;
    std::optional<Timer> timer(render_ms);
    Settings wanted = settings;
    wanted.aovs.clear();
    wanted.lattice = 1;
    wanted.aa = AntiAliasing{AntiAliasing::Kind::none, 1};
    validate(wanted);
    // What the camera chooses by the picture's shape must not depend on how many pixels it has.
    wanted.view = explicit_view(Camera(scene, wanted.view, wanted.size), scene, wanted.view);
    const Enlargement enlargement(wanted.size, share);
    const Settings few = fewer_pixels(wanted, enlargement);

    Film film(wanted.size, film_settings(wanted, {}));
    Film small_film(few.size, film_settings(few, {}));
    const LineOutput inked{.ink = wanted.draws_lines(), .drawing = nullptr};
    const LineOutput kept{.ink = wanted.draws_lines(),
                          .drawing = nullptr,
                          .segments = true,
                          .enlargement = &enlargement};
    RenderStats result;
    // From first to last, so that threads that come for one loop are there for the next.
    with_threads(wanted.threads, [&] {
        const Pipeline small(scene, tracer, few, small_film, kept, control);
        if (small.locates()) {
            const Pipeline large(scene, tracer, wanted, film, inked, control, Rays::none);
            result = render_fewer_rays(small, large, enlargement, control);
            return;
        }
        result = render_stencils(small, control);
        const PixelEnlarger enlarger(enlargement, small_film.display());
        const SideWork rows = enlarging(enlarger, nullptr, film);
        WorkLoop loop(result.threads, control, rows.items);
        loop.run(rows.items, [&](std::size_t band, std::size_t) { rows.body(band); });
    });
    timer.reset();
    result.render_ms = render_ms;
    if (stats != nullptr) *stats = result;
    return film;
}

}  // namespace ink
