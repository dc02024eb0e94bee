#include "vector/regions.h"

#include <algorithm>
#include <utility>

#include "vector/outlines.h"

namespace ink {

namespace {

/// Area times two of the polygon through the ends and controls; negative where the inside is on the
/// left of the way (y points down).
double twice_area(const Curve& outline) {
    double sum = 0.0;
    Vec2d at = to_double(outline.start);
    for (const CurvePiece& piece : outline.pieces) {
        for (const Vec2f point : {piece.control1, piece.control2, piece.end}) {
            sum += cross(at, to_double(point));
            at = to_double(point);
        }
    }
    return sum + cross(at, to_double(outline.start));
}

double twice_area(const Region& region) {
    double sum = 0.0;
    for (const Curve& outline : region.outlines) sum += twice_area(outline);
    return sum;
}

}  // namespace

std::vector<Region> make_regions(const ChainGraph& graph, std::span<const Curve> curves,
                                 Vec2f lower, Vec2f upper) {
    std::vector<Use> uses;
    for (std::uint32_t k = 0; k < graph.chains.size(); ++k) {
        const Chain& chain = graph.chains[k];
        if (chain.left == chain.right || curves[k].pieces.empty()) continue;
        uses.push_back({chain.left, k, false});
        uses.push_back({chain.right, k, true});
    }
    std::ranges::stable_sort(uses, {}, &Use::id);
    const Border border(lower, upper);
    Outliner outliner(graph, curves, border);
    std::vector<Region> regions;
    for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
        while (end < uses.size() && uses[end].id == uses[begin].id) ++end;
        regions.push_back(
            {uses[begin].id, outliner.outlines(std::span(uses).subspan(begin, end - begin)), {}});
    }
    // If no line leaves the rectangle, one geometry or the background goes all round it: the one
    // whose outlines are holes and nothing else.
    const auto around = std::ranges::max_element(
        regions, {}, [](const Region& region) { return twice_area(region); });
    if (!outliner.touched_border() && around != regions.end()) {
        const auto corners = border.corners();
        Curve whole{corners[0], {}};
        for (const std::size_t k : {1U, 2U, 3U, 0U}) append_straight(whole, corners[k]);
        around->outlines.insert(around->outlines.begin(), std::move(whole));
    }
    std::erase_if(regions, [](const Region& region) { return region.id == kBackground; });
    return regions;
}

}  // namespace ink
