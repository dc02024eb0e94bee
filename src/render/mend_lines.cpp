#include "render/mend_lines.h"

#include <algorithm>
#include <set>
#include <utility>
#include <variant>

#include "base/timer.h"
#include "lines/fold_joints.h"
#include "lines/line_gaps.h"
#include "lines/tones.h"

namespace ink {

void LineMender::mend() {
    const Timer timer(stats_.lines_ms);
    if (!has_breaks()) return;
    gather();
    mend_folds();
    lines_.insert(lines_.end(), repairs_.bridges.begin(), repairs_.bridges.end());
    close_gaps();
    ease_joints();
    if (edges_.tones) repair_toned();
    change();
}

namespace {

/// Whether every piece of an object is convex, so that none has a fold of its own: what looks like
/// one is the outline of one piece before another of the same part, and whole as it is.
bool is_of_convex_pieces(const Object& object) {
    if (std::holds_alternative<Spheres>(object.shape)) return true;
    const auto* const glyphs = std::get_if<Glyphs>(&object.shape);
    if (glyphs == nullptr) return false;
    const GlyphKind kind = glyphs->shape.kind;
    return kind != GlyphKind::torus && kind != GlyphKind::gaussian && kind != GlyphKind::waves;
}

}  // namespace

LineMender::LineMender(const EdgesPlan& edges,
                       const std::vector<std::unique_ptr<LineFinder>>& finders,
                       std::vector<TileLines>& found, std::vector<std::vector<Segment>>& toned,
                       Team& team)
    : edges_(edges), finders_(finders), found_(found), toned_(toned), team_(team) {
    for (const Object& object : edges.pipeline.scene.objects()) {
        convex_.push_back(is_of_convex_pieces(object));
    }
}

bool LineMender::is_fold(const Segment& segment) const {
    return segment.type == LineType::self_occlusion && segment.owner != kBackground &&
           !convex_[edges_.pipeline.ids.object_of(segment.owner)];
}

bool LineMender::has_breaks() const {
    const auto may_break = [&](const Segment& segment) {
        return segment.level == 0 &&
               (is_fold(segment) || (segment.type == LineType::crease && edges_.has_meshes));
    };
    return std::ranges::any_of(found_, [&](const TileLines& tile) {
        return std::ranges::any_of(tile.segments, may_break);
    });
}

void LineMender::gather() {
    std::size_t most = 0;
    for (const TileLines& tile : found_) most += tile.segments.size();
    lines_.reserve(most + most / 4);  // and what joins them
    places_.reserve(most);
    for (std::uint32_t tile = 0; tile < found_.size(); ++tile) {
        for (std::uint32_t k = 0; k < found_[tile].segments.size(); ++k) {
            const Segment& segment = found_[tile].segments[k];
            if (segment.level != 0 || segment.type == LineType::mesh) continue;
            lines_.push_back(segment);
            if (segment.type == LineType::self_occlusion && !is_fold(segment)) {
                lines_.back().type = LineType::silhouette;
            }
            places_.push_back({tile, k});
        }
    }
    squares_.emplace(lines_);
}

float LineMender::width() const {
    return edges_.ink.styles[edges_.style_of(LineType::self_occlusion, 0)].width_px;
}

/// As wide as lines are by default in a picture of the default size. Thinner ones are judged as if
/// they were as wide, so that a larger picture has the same lines, not more and shorter ones.
float LineMender::least_width() const {
    constexpr float kOfHeight = 3.0F / 1024.0F;
    return kOfHeight * static_cast<float>(edges_.pipeline.settings.size.height);
}

void LineMender::mend_folds() {
    FoldTeam fold_team;
    for (const std::unique_ptr<LineFinder>& finder : finders_) {
        fold_team.workers.push_back({finder->more_samples(), [&](Vec2f low, Vec2f high) {
                                         finder->enter({low.x, low.y, high.x, high.y});
                                     }});
    }
    fold_team.loop = [&](std::size_t count, const auto& body) { team_.loop(count, body); };
    repairs_ = ink::mend_folds(lines_, *squares_, edges_.viewpoint, spacing(), width(), fold_team,
                               {.least_width = least_width()});
}

void LineMender::close_gaps() {
    const std::vector<Segment> pieces =
        ink::close_gaps({lines_, places_.size(), *squares_}, repairs_.crumbs, spacing(), width());
    lines_.insert(lines_.end(), pieces.begin(), pieces.end());
}

void LineMender::ease_joints() {
    const std::size_t first_joining = places_.size();
    const FoldJoints joints =
        ink::ease_joints({lines_, first_joining, *squares_}, repairs_.crumbs, spacing(), judged());
    std::vector<bool> eased(lines_.size());
    for (const std::size_t k : joints.dropped) {
        eased[k] = true;
        if (k < first_joining) repairs_.crumbs.push_back(k);
    }
    std::ranges::sort(repairs_.crumbs);
    repairs_.bridges = joints.curves;
    for (std::size_t k = first_joining; k < lines_.size(); ++k) {
        if (!eased[k]) repairs_.bridges.push_back(lines_[k]);
    }
}

/// The same in the lines that light and shade are told apart by. A crumb may hang on another line,
/// so that only a segment both of whose ends are a crumb's is part of one.
void LineMender::repair_toned() {
    std::set<std::pair<float, float>> ends;
    for (const std::size_t k : repairs_.crumbs) {
        for (const Vec2f end : {lines_[k].a, lines_[k].b}) ends.insert({end.x, end.y});
    }
    const auto is_crumb = [&](const Segment& segment) {
        return segment.type == LineType::self_occlusion &&
               ends.contains({segment.a.x, segment.a.y}) &&
               ends.contains({segment.b.x, segment.b.y});
    };
    for (std::vector<Segment>& tile : toned_) std::erase_if(tile, is_crumb);
    for (Segment bridge : repairs_.bridges) {
        Tones::double_ids(bridge);
        toned_[edges_.search_tile_at((bridge.a + bridge.b) * 0.5F)].push_back(bridge);
    }
}

namespace {

/// Makes a tile's strokes anew from its segments.
void make_strokes(const EdgesPlan& edges, TileLines& tile) {
    tile.strokes.clear();
    tile.inner = 0;
    for (const Segment& segment : tile.segments) {
        if (!edges.draw_lines || !edges.wanted.has(segment.type) || segment.for_data) continue;
        tile.strokes.push_back(make_ink_stroke(segment, edges.style_of(segment)));
    }
}

}  // namespace

void LineMender::change() {
    std::vector<bool> changed(found_.size());
    // Last first, so that the places of the others stay what they are.
    for (auto k = repairs_.crumbs.rbegin(); k != repairs_.crumbs.rend(); ++k) {
        const auto [tile, index] = places_[*k];
        found_[tile].segments.erase(found_[tile].segments.begin() + index);
        changed[tile] = true;
    }
    for (const Segment& bridge : repairs_.bridges) {
        const std::size_t tile = edges_.search_tile_at((bridge.a + bridge.b) * 0.5F);
        found_[tile].segments.push_back(bridge);  // with the distance of the line that it is like
        changed[tile] = true;
    }
    for (std::size_t tile = 0; tile < found_.size(); ++tile) {
        if (changed[tile]) make_strokes(edges_, found_[tile]);
    }
}

}  // namespace ink
