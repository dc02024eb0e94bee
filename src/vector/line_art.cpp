#include "vector/line_art.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "lines/chain_lines.h"
#include "lines/fit_chains.h"
#include "sampling/line_ids.h"
#include "vector/region_colors.h"
#include "vector/regions.h"
#include "vector/several_colors.h"
#include "vector/tone_lines.h"

namespace ink {

GeometryId front(const Chain& chain) { return chain.left_in_front ? chain.left : chain.right; }
GeometryId behind(const Chain& chain) { return chain.left_in_front ? chain.right : chain.left; }

namespace {

std::string title_of(const Scene& scene) {
    std::string title;
    for (const Object& object : scene.objects()) {
        if (!object.name.empty()) title += (title.empty() ? "" : ", ") + object.name;
    }
    return title.empty() ? "Inktrace" : title;
}

std::optional<Rgb8> paper(const Settings& settings) {
    if (settings.shading.transparent_background) return std::nullopt;
    if (settings.compose == Compose::lines) return Rgb8{255, 255, 255};
    return settings.shading.background;
}

std::vector<Segment> of_level(const Drawing& drawing, int level) {
    std::vector<Segment> segments;
    std::ranges::copy_if(drawing.segments, std::back_inserter(segments),
                         [&](const Segment& segment) { return segment.level == level; });
    return segments;
}

int last_level(const Drawing& drawing) {
    int last = 0;
    for (const Segment& segment : drawing.segments) last = std::max<int>(last, segment.level);
    return last;
}

/// Share of the tolerance by which curves may miss the crossings. The rest is for what crossings
/// miss themselves, for rounding, and for renderers, which flatten curves.
constexpr double kFitShare = 0.5;

CurveGraph curves_of(const std::vector<Segment>& segments, float spacing,
                     const Settings& settings) {
    CurveGraph layer;
    layer.graph = chain_lines(segments, spacing, settings.threads);
    layer.curves = fit_chains(layer.graph, {.tolerance = kFitShare * settings.curve_tolerance_px},
                              settings.threads);
    return layer;
}

bool is_inner(const LineIds& ids, const Chain& chain) {
    return chain.left != kBackground && chain.right != kBackground &&
           ids.of_one_whole(chain.left, chain.right);
}

Fill fill_of(const Scene& scene, const Settings& settings, const LineIds& ids) {
    if (settings.compose == Compose::lines) return Fill::none;
    if (settings.fill != Fill::automatic) return settings.fill;
    return has_geometry_of_several_colors(scene, ids) ? Fill::image : Fill::flat;
}

/// Moves the lines that were asked for into the drawing, with their styles.
void add_lines(const Settings& settings, const LineIds& ids, const LineThinning& thinning,
               CurveGraph layer, LineArt& art) {
    const double shortest = settings.min_length.pixels(settings.dpi, settings.size.height);
    for (std::size_t k = 0; k < layer.graph.chains.size(); ++k) {
        Chain& chain = layer.graph.chains[k];
        if (!settings.lines.has(chain.type)) continue;
        const double least = chain.hidden ? std::max(shortest, kShortestHidden) : shortest;
        const double size = least > 0.0 ? length_of(chain) : 0.0;
        if (std::max(size, chain.whole.length) < least) continue;
        const GeometryId owner = front(chain) != kBackground ? front(chain) : behind(chain);
        const auto object = static_cast<int>(art.names.object_of(owner)) + 1;
        const StrokeStyle style =
            chain.hidden
                ? settings.hidden_style(object)
                : settings.line_style(chain.type, object, chain.level, is_inner(ids, chain));
        art.styles.push_back(style);
        art.dashes.push_back(chain.hidden
                                 ? settings.hidden_dashes(style.width_px, size, chain.closed)
                                 : std::nullopt);
        for (Stroke& stroke :
             make_strokes(chain, layer.curves[k], weigh(chain, style.width_px, thinning))) {
            stroke.chain = static_cast<std::uint32_t>(art.chains.size());
            art.strokes.push_back(std::move(stroke));
        }
        art.chains.push_back(std::move(chain));
        art.curves.push_back(std::move(layer.curves[k]));
    }
}

}  // namespace

LineArt make_line_art(const Scene& scene, const Settings& settings, const Drawing& drawing,
                      const DisplayImage& image) {
    LineArt art;
    art.size = settings.size;
    art.dpi = settings.dpi;
    art.title = title_of(scene);
    art.background = paper(settings);
    art.names = GeometryNames(scene, settings.ids);

    const int levels = last_level(drawing) + 1;
    CurveGraph direct =
        curves_of(levels == 1 ? drawing.segments : of_level(drawing, 0), drawing.spacing, settings);
    const LineIds ids(scene, settings.ids);
    const Fill fill = fill_of(scene, settings, ids);
    if (drawing.tones) drop_spots(direct);
    if (fill == Fill::flat || fill == Fill::two_tone) {
        art.regions = make_regions(direct.graph, direct.curves, drawing.lower, drawing.upper);
        color_regions(art.regions, image, settings.threads);
    }
    if (drawing.tones) {
        name_tones(art.regions);
        name_tones(direct);
    }
    if (fill == Fill::image) art.image = image;

    if (!settings.draws_lines()) return art;
    add_lines(settings, ids, drawing.thinning, std::move(direct), art);
    for (int level = 1; level < levels; ++level) {
        add_lines(settings, ids, drawing.thinning,
                  curves_of(of_level(drawing, level), drawing.spacing, settings), art);
    }
    if (drawing.hidden.empty()) return art;
    add_lines(settings, ids, drawing.thinning, curves_of(drawing.hidden, drawing.spacing, settings),
              art);
    return art;
}

}  // namespace ink
