#include "vector/line_art.h"

#include <algorithm>
#include <utility>

#include "lines/fit_chains.h"
#include "lines/junctions.h"
#include "vector/regions.h"

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

/// Moves the lines that were asked for into the drawing, with their styles.
void add_lines(const Settings& settings, ChainGraph& graph, std::vector<Curve>& curves,
               LineArt& art) {
    const double shortest = settings.min_length.pixels(settings.dpi, settings.size.height);
    for (std::size_t k = 0; k < graph.chains.size(); ++k) {
        Chain& chain = graph.chains[k];
        if (!settings.lines.has(chain.type)) continue;
        const double least = chain.hidden ? std::max(shortest, kShortestHidden) : shortest;
        const double size = least > 0.0 ? length_of(chain) : 0.0;
        if (size < least) continue;
        const GeometryId owner = front(chain) != kBackground ? front(chain) : behind(chain);
        const auto object = static_cast<int>(art.names.object_of(owner)) + 1;
        const StrokeStyle style =
            chain.hidden ? settings.hidden_style(object) : settings.line_style(chain.type, object);
        art.styles.push_back(style);
        art.dashes.push_back(chain.hidden
                                 ? settings.hidden_dashes(style.width_px, size, chain.closed)
                                 : std::nullopt);
        art.chains.push_back(std::move(chain));
        art.curves.push_back(std::move(curves[k]));
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

    ChainGraph graph = chain_segments(drawing.segments, drawing.spacing);
    place_junctions(graph, drawing.spacing);
    const FitSettings fit{.tolerance = settings.curve_tolerance_px};
    std::vector<Curve> curves = fit_chains(graph, fit, settings.threads);

    const Fill fill = settings.compose == Compose::lines ? Fill::none : settings.fill;
    if (fill == Fill::flat) {
        art.regions = make_regions(graph, curves, drawing.lower, drawing.upper);
        color_regions(art.regions, image, settings.threads);
    }
    if (fill == Fill::image) art.image = image;

    if (!settings.draws_lines()) return art;
    add_lines(settings, graph, curves, art);
    if (drawing.hidden.empty()) return art;
    ChainGraph hidden = chain_segments(drawing.hidden, drawing.spacing);
    place_junctions(hidden, drawing.spacing);
    std::vector<Curve> hidden_curves = fit_chains(hidden, fit, settings.threads);
    add_lines(settings, hidden, hidden_curves, art);
    return art;
}

}  // namespace ink
