#include "vector/line_layers.h"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

namespace ink {

namespace {

/// From the bottom up: outlines are the strongest statement and go on top.
constexpr std::array<LineType, kLineTypes> kOrder{
    LineType::mesh,           LineType::ridge,    LineType::crease,    LineType::intersection,
    LineType::self_occlusion, LineType::boundary, LineType::silhouette};

bool same_ink(const StrokeStyle& a, const StrokeStyle& b) {
    return a.color == b.color && a.opacity == b.opacity;
}

template <class Belongs>
LineLayer make_layer(const LineArt& art, std::string_view name, const Belongs& belongs) {
    LineLayer layer;
    layer.name = name;
    for (std::size_t k = 0; k < art.strokes.size(); ++k) {
        if (belongs(art.chains[art.strokes[k].chain])) layer.strokes.push_back(k);
    }
    if (layer.strokes.empty()) return layer;
    const auto style = [&](std::size_t k) { return art.styles[art.strokes[k].chain]; };
    layer.usual = style(layer.strokes.front());
    if (std::ranges::all_of(layer.strokes,
                            [&](std::size_t k) { return same_ink(style(k), layer.usual); })) {
        layer.opacity = layer.usual.opacity;
    }
    std::ranges::stable_sort(layer.strokes, std::ranges::greater{}, [&](std::size_t k) {
        return art.chains[art.strokes[k].chain].t.front();
    });
    return layer;
}

}  // namespace

LineLayers layers_of(const LineArt& art) {
    LineLayers all;
    const auto add = [&](LineLayer layer) {
        if (!layer.strokes.empty()) all.layers.push_back(std::move(layer));
    };
    add(make_layer(art, "hidden", [](const Chain& chain) { return chain.hidden; }));
    for (const LineType type : kOrder) {
        add(make_layer(art, name_of(type),
                       [type](const Chain& chain) { return chain.type == type && !chain.hidden; }));
    }
    const bool alike = std::ranges::all_of(all.layers, [&](const LineLayer& layer) {
        return layer.opacity && same_ink(layer.usual, all.layers.front().usual);
    });
    if (alike && !all.layers.empty()) {
        all.opacity = all.layers.front().usual.opacity;
        for (LineLayer& layer : all.layers) layer.opacity = 1.0;
    }
    return all;
}

}  // namespace ink
