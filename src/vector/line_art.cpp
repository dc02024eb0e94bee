#include "vector/line_art.h"

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
    std::vector<Curve> curves =
        fit_chains(graph, {.tolerance = settings.curve_tolerance_px}, settings.threads);

    const Fill fill = settings.compose == Compose::lines ? Fill::none : settings.fill;
    if (fill == Fill::flat) {
        art.regions = make_regions(graph, curves, drawing.lower, drawing.upper);
        color_regions(art.regions, image, settings.threads);
    }
    if (fill == Fill::image) art.image = image;

    if (!settings.draws_lines()) return art;
    const double shortest = settings.min_length.pixels(settings.dpi, settings.size.height);
    for (std::size_t k = 0; k < graph.chains.size(); ++k) {
        Chain& chain = graph.chains[k];
        if (!settings.lines.has(chain.type)) continue;
        if (shortest > 0.0 && length_of(chain) < shortest) continue;
        const GeometryId owner = front(chain) != kBackground ? front(chain) : behind(chain);
        const auto object = static_cast<int>(art.names.object_of(owner)) + 1;
        art.styles.push_back(settings.line_style(chain.type, object));
        art.chains.push_back(std::move(chain));
        art.curves.push_back(std::move(curves[k]));
    }
    return art;
}

}  // namespace ink
