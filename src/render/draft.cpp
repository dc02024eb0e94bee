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
#include "camera/views.h"
#include "render/edges_method.h"
#include "render/enlarge.h"
#include "render/pipeline.h"
#include "render/scaled.h"

namespace ink {

namespace {

/// The same view in fewer pixels.
Settings fewer_pixels(const Settings& settings, const Enlargement& enlargement) {
    Settings few = scaled(settings, 1.0 / enlargement.factor());
    few.size = enlargement.small();
    few.lattice = 1;
    few.aa = AntiAliasing{AntiAliasing::Kind::none, 1};
    return few;
}

/// Segments of the small picture become those of the large one, in the tiles in which its
/// `LineDrawer` looks for them.
FoundLines enlarged(FoundLines& found, const Enlargement& enlargement, const Edges& large) {
    FoundLines result;
    result.tiles.resize(large.search_tiles.size());
    for (const TileLines& tile : found.tiles) {
        for (Segment line : tile.segments) {
            if (!large.wanted.has(line.type)) continue;
            line.a = enlargement.enlarged(line.a);
            line.b = enlargement.enlarged(line.b);
            const Vec2f middle = (line.a + line.b) * 0.5F;
            result.tiles[large.search_tile_at(middle)].strokes.push_back(
                make_ink_stroke(line, large.style_of(line)));
        }
    }
    result.thinning = found.thinning;
    for (LineDensity* density : {&result.thinning.all, &result.thinning.direct}) {
        density->enlarge(enlargement.factor(), enlargement.small_middle(),
                         enlargement.large_middle());
    }
    result.tiling = std::move(found.tiling);
    return result;
}

/// Enlarges the shaded pixels, and sharpens them along the lines.
void enlarge_film(const Film& small, std::span<const Tile> tiles,
                  const std::vector<TileLines>& lines, const Enlargement& enlargement,
                  WorkLoop& loop, FaceTiling* faces, Film& large) {
    const PixelEnlarger enlarger(enlargement, small.display());
    constexpr std::size_t kRows = 32;
    const auto height = static_cast<std::size_t>(enlargement.large().height);
    loop.run((height + kRows - 1) / kRows, [&](std::size_t band, std::size_t) {
        for (std::size_t y = band * kRows; y < std::min(height, (band + 1) * kRows); ++y) {
            enlarger.enlarge_row(static_cast<int>(y), large);
        }
    });
    // Each cell of the lattice belongs to one tile, so threads write different pixels.
    loop.run(tiles.size(), [&](std::size_t i, std::size_t) {
        enlarger.sharpen(tiles[i], lines[i].segments, large, faces);
    });
}

RenderStats render_fewer_rays(const Pipeline& few, const Pipeline& full,
                              const Enlargement& enlargement, const RenderControl& control) {
    const Edges small(few);
    const Edges large(full);
    const int threads = few.settings.threads > 0 ? few.settings.threads : hardware_threads();
    WorkLoop loop(threads, control, 2 * small.search_tiles.size() + large.draw_tiles.size());
    RenderStats stats;
    FoundLines found = find_lines(small, loop, stats);
    {
        const Timer timer(stats.shade_ms);
        enlarge_film(few.film, small.search_tiles, found.tiles, enlargement, loop,
                     found.tiling ? &*found.tiling : nullptr, full.film);
    }
    add_hidden_strokes(small, found);
    FoundLines lines = enlarged(found, enlargement, large);
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
        const Pipeline small(scene, tracer, few, small_film, kept, true, control.ambient,
                             control.cancel);
        if (small.locates()) {
            const Pipeline large(scene, tracer, wanted, film, inked, false);
            result = render_fewer_rays(small, large, enlargement, control);
            return;
        }
        result = render_stencils(small, control);
        WorkLoop loop(result.threads, control, 1);
        enlarge_film(small_film, {}, {}, enlargement, loop, nullptr, film);
    });
    timer.reset();
    result.render_ms = render_ms;
    if (stats != nullptr) *stats = result;
    return film;
}

}  // namespace ink
