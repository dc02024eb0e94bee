#include "render/hidden_lines.h"

#include <algorithm>
#include <bit>

#include "lines/chain_lines.h"
#include "lines/dashes.h"

namespace ink {

namespace {

/// Crossings of one lattice edge this near to each other are one line, in lattice spacings: each is
/// known to 1/64.
constexpr float kSamePlace = 0.08F;

std::uint64_t edge_key(const SuspectEdge& edge) {
    return std::uint64_t{edge.j} << 32U | std::uint64_t{edge.i} << 1U | (edge.down ? 1U : 0U);
}

std::uint64_t bits(Vec2f point) {
    return std::uint64_t{std::bit_cast<std::uint32_t>(point.y)} << 32U |
           std::bit_cast<std::uint32_t>(point.x);
}

/// Where along its lattice edge a crossing lies, in spacings.
float along(const Crossing& crossing, const SuspectEdge& edge, float per_pixel) {
    const float at = edge.down ? crossing.point.y : crossing.point.x;
    return at * per_pixel;
}

}  // namespace

HiddenLineFinder::HiddenLineFinder(const EdgesPlan& edges) : edges_(edges) {
    for (const auto& behind : edges.behind) {
        layers_.push_back(std::make_unique<LineFinder>(edges, *behind));
    }
}

std::vector<Segment> HiddenLineFinder::search(const Tile& tile, const LineFinder& front) {
    places_.clear();
    keep_places(front);
    std::vector<Segment> hidden;
    for (const auto& layer : layers_) {
        const TileLines found = layer->search(tile);
        if (!layer->saw_anything()) break;
        mark_known(*layer);
        for (Segment segment : found.segments) {
            if (!edges_.wanted.has(segment.type)) continue;
            if (is_known(segment.a) && (!segment.spans_cell || is_known(segment.b))) continue;
            segment.hidden = true;
            hidden.push_back(segment);
        }
        keep_places(*layer);
    }
    return hidden;
}

void HiddenLineFinder::keep_places(const LineFinder& layer) {
    for (const Crossing& crossing : layer.crossings()) {
        const SuspectEdge& edge = layer.crossed_edges()[crossing.edge];
        places_.emplace_back(edge_key(edge), along(crossing, edge, static_cast<float>(edges_.q)));
    }
    std::ranges::sort(places_);
}

void HiddenLineFinder::mark_known(const LineFinder& layer) {
    known_.clear();
    for (const Crossing& crossing : layer.crossings()) {
        const SuspectEdge& edge = layer.crossed_edges()[crossing.edge];
        const std::uint64_t key = edge_key(edge);
        const float at = along(crossing, edge, static_cast<float>(edges_.q));
        const auto near = std::ranges::lower_bound(places_, Place{key, at - kSamePlace});
        if (near == places_.end() || near->first != key || near->second > at + kSamePlace) continue;
        known_.push_back(bits(crossing.point));
    }
    std::ranges::sort(known_);
}

bool HiddenLineFinder::is_known(Vec2f point) const {
    return std::ranges::binary_search(known_, bits(point));
}

RenderStats HiddenLineFinder::stats() const {
    RenderStats total;
    for (const auto& layer : layers_) total += layer->stats();
    return total;
}

std::vector<Segment> hidden_strokes(const EdgesPlan& edges, std::span<const Segment> lines) {
    const float spacing = 1.0F / static_cast<float>(edges.q);
    const Settings& settings = edges.pipeline.settings;
    const ChainGraph graph = chain_lines(lines, spacing, settings.threads);
    std::vector<Segment> strokes;
    for (const Chain& chain : graph.chains) {
        const double size = length_of(chain);
        if (std::max(size, chain.whole.length) < kShortestHidden) continue;
        const std::size_t first = strokes.size();
        cut_into_strokes(chain, nullptr, strokes);
        const LineStyle& style = edges.ink.styles[edges.style_of(strokes[first])];
        const auto dashes =
            settings.hidden_dashes(static_cast<double>(style.width_px), size, chain.closed);
        if (!dashes) continue;
        strokes.resize(first);
        cut_into_strokes(chain, &*dashes, strokes);
    }
    return strokes;
}

}  // namespace ink
