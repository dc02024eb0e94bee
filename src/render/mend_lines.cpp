#include "render/mend_lines.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <span>
#include <utility>

#include "base/parallel.h"
#include "lines/fold_joints.h"
#include "lines/folds.h"
#include "lines/line_gaps.h"
#include "lines/tones.h"

namespace ink {

namespace {

/// The same in the lines that light and shade are told apart by. A crumb may hang on another line,
/// so that only a segment both of whose ends are a crumb's is part of one.
void repair(const Edges& edges, const FoldRepairs& repairs, std::span<const Segment> lines,
            std::vector<std::vector<Segment>>& toned) {
    std::set<std::pair<float, float>> ends;
    for (const std::size_t k : repairs.crumbs) {
        for (const Vec2f end : {lines[k].a, lines[k].b}) ends.insert({end.x, end.y});
    }
    const auto is_crumb = [&](const Segment& segment) {
        return segment.type == LineType::self_occlusion &&
               ends.contains({segment.a.x, segment.a.y}) &&
               ends.contains({segment.b.x, segment.b.y});
    };
    for (std::vector<Segment>& tile : toned) std::erase_if(tile, is_crumb);
    for (Segment bridge : repairs.bridges) {
        Tones::double_ids(bridge);
        toned[edges.search_tile_at((bridge.a + bridge.b) * 0.5F)].push_back(bridge);
    }
}

/// Closes what gaps are left, and eases the joints.
void join(std::vector<Segment>& lines, const plane::SegmentSquares& squares, float spacing,
          float width, FoldRepairs& repairs) {
    const std::size_t first_joining = lines.size();
    lines.insert(lines.end(), repairs.bridges.begin(), repairs.bridges.end());
    const std::vector<Segment> pieces =
        close_gaps({lines, first_joining, squares}, repairs.crumbs, spacing, width);
    lines.insert(lines.end(), pieces.begin(), pieces.end());
    const FoldJoints joints =
        ease_joints({lines, first_joining, squares}, repairs.crumbs, spacing, width);
    std::vector<bool> eased(lines.size());
    for (const std::size_t k : joints.dropped) {
        eased[k] = true;
        if (k < first_joining) repairs.crumbs.push_back(k);
    }
    std::ranges::sort(repairs.crumbs);
    repairs.bridges = joints.curves;
    for (std::size_t k = first_joining; k < lines.size(); ++k) {
        if (!eased[k]) repairs.bridges.push_back(lines[k]);
    }
}

/// Makes a tile's strokes anew from its segments.
void make_strokes(const Edges& edges, TileLines& tile) {
    tile.strokes.clear();
    tile.inner = 0;
    for (const Segment& segment : tile.segments) {
        if (!edges.draw_lines || !edges.wanted.has(segment.type) || segment.for_data) continue;
        tile.strokes.push_back(make_ink_stroke(segment, edges.style_of(segment)));
    }
}

void mend(const Edges& edges, std::vector<std::unique_ptr<LineFinder>>& finders,
          std::vector<TileLines>& found, std::vector<std::vector<Segment>>& toned) {
    const auto may_break = [&](const Segment& segment) {
        return segment.level == 0 && (segment.type == LineType::self_occlusion ||
                                      (segment.type == LineType::crease && edges.has_meshes));
    };
    if (std::ranges::none_of(found, [&](const TileLines& tile) {
            return std::ranges::any_of(tile.segments, may_break);
        })) {
        return;
    }
    std::vector<Segment> lines;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> places;  // tile, and index within it
    std::size_t most = 0;
    for (const TileLines& tile : found) most += tile.segments.size();
    lines.reserve(most + most / 4);  // and what joins them
    places.reserve(most);
    for (std::uint32_t tile = 0; tile < found.size(); ++tile) {
        for (std::uint32_t k = 0; k < found[tile].segments.size(); ++k) {
            const Segment& segment = found[tile].segments[k];
            if (segment.level != 0 || segment.type == LineType::mesh) continue;
            lines.push_back(segment);
            places.emplace_back(tile, k);
        }
    }
    const float width = edges.ink.styles[edges.style_of(LineType::self_occlusion, 0)].width_px;
    std::vector<FoldWorker> workers;
    for (std::unique_ptr<LineFinder>& finder : finders) {
        if (!finder) finder = std::make_unique<LineFinder>(edges);
        finder->end_search();
        workers.push_back({finder->more_samples(), [&](Vec2f low, Vec2f high) {
                               finder->enter({low.x, low.y, high.x, high.y});
                           }});
    }
    const plane::SegmentSquares squares(lines);
    FoldRepairs repairs =
        mend_folds(lines, squares, edges.viewpoint, 1.0F / static_cast<float>(edges.q), width,
                   workers, [&](std::size_t count, const auto& body) {
                       parallel_for(count, static_cast<int>(workers.size()), body);
                   });
    join(lines, squares, 1.0F / static_cast<float>(edges.q), width, repairs);
    if (edges.tones) repair(edges, repairs, lines, toned);
    std::vector<bool> changed(found.size());
    // Last first, so that the places of the others stay what they are.
    for (auto k = repairs.crumbs.rbegin(); k != repairs.crumbs.rend(); ++k) {
        const auto [tile, index] = places[*k];
        found[tile].segments.erase(found[tile].segments.begin() + index);
        changed[tile] = true;
    }
    for (const Segment& bridge : repairs.bridges) {
        const std::size_t tile = edges.search_tile_at((bridge.a + bridge.b) * 0.5F);
        found[tile].segments.push_back(bridge);  // with the distance of the line that it is like
        changed[tile] = true;
    }
    for (std::size_t tile = 0; tile < found.size(); ++tile) {
        if (changed[tile]) make_strokes(edges, found[tile]);
    }
}

}  // namespace

RenderStats mend_lines(const Edges& edges, std::vector<std::unique_ptr<LineFinder>>& finders,
                       std::vector<TileLines>& found, std::vector<std::vector<Segment>>& toned) {
    RenderStats stats;
    {
        const Timer timer(stats.lines_ms);
        mend(edges, finders, found, toned);
    }
    stats.lines_ms *= static_cast<double>(finders.size());  // all threads are at it, or wait
    return stats;
}

}  // namespace ink
