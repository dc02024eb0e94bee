#include "render/line_search.h"

#include "base/team.h"
#include "base/timer.h"
#include "render/line_mask.h"
#include "render/mend_lines.h"

namespace ink {

namespace {

/// Where there are lines on surfaces seen directly, but not between faces.
struct LineMasks {
    LineMask touching;  ///< so near that a ridge beside them would touch them
    LineMask near;      ///< `radius` pixels farther away
};

LineMasks masks_of(const EdgesPlan& edges, const std::vector<TileLines>& found, float radius) {
    LineMasks masks{LineMask(edges.search_area()), LineMask(edges.search_area())};
    const auto mark = [&](Vec2f a, Vec2f b, std::size_t style) {
        constexpr float kBetween = 0.5F;  // what the eye does not tell from none, pixels
        const float ridge = edges.ink.styles[edges.style_of(LineType::ridge, 0)].width_px;
        const float touching = 0.5F * (edges.ink.styles[style].width_px + ridge) + kBetween;
        masks.touching.mark((a + b) * 0.5F, touching);
        masks.near.mark((a + b) * 0.5F, touching + radius);
    };
    for (const TileLines& tile : found) {
        for (const Segment& segment : tile.segments) {
            if (segment.level > 0 || segment.type == LineType::mesh) continue;
            if (edges.wanted.has(segment.type)) mark(segment.a, segment.b, edges.style_of(segment));
        }
        if (edges.keeps_segments()) continue;
        for (const InkStroke& stroke : tile.strokes) {
            const auto type = static_cast<LineType>(stroke.style % kLineTypes);
            if (stroke.direct && type != LineType::mesh) mark(stroke.a, stroke.b, stroke.style);
        }
    }
    return masks;
}

/// False only if the tile's lattice sees nothing.
bool may_see(const EdgesPlan& edges, const Tile& tile) {
    // As far as tiles trace beyond their borders, and no less.
    return edges.pipeline.frame->may_see({static_cast<float>(tile.x0), static_cast<float>(tile.y0),
                                          static_cast<float>(tile.x1 + kBlockSide),
                                          static_cast<float>(tile.y1 + kBlockSide)});
}

/// Puts a line that was found in the whole picture where tiles that draw look for it; those of a
/// draft are enlarged first.
void keep(const EdgesPlan& edges, const Segment& line, FoundLines& found) {
    if (edges.pipeline.lines.enlargement != nullptr) {
        found.of_no_tile.push_back(line);
        return;
    }
    TileLines& tile = found.tiles[edges.search_tile_at((line.a + line.b) * 0.5F)];
    if (edges.wants_segments()) tile.segments.push_back(line);
    if (edges.draw_lines) tile.strokes.push_back(make_ink_stroke(line, edges.style_of(line)));
}

/// From what all workers have counted, and the ridges.
LineThinning thinning_of(const EdgesPlan& edges,
                         const std::vector<std::unique_ptr<LineFinder>>& finders,
                         const LineDensity& ridges) {
    LineThinning thinning{ridges, ridges, static_cast<float>(edges.pipeline.settings.line_density)};
    const bool goes_on = edges.pipeline.goes_on();
    for (const auto& finder : finders) {
        if (!finder) continue;
        thinning.all += finder->density();
        if (goes_on) thinning.direct += finder->direct_density();
    }
    thinning.all.finish();
    if (goes_on) {
        thinning.direct.finish();
    } else {
        thinning.direct = thinning.all;
    }
    return thinning;
}

}  // namespace

LineSearch::LineSearch(const EdgesPlan& edges, WorkLoop& loop)
    : edges_(edges),
      loop_(loop),
      finders_(static_cast<std::size_t>(loop.threads())),
      behind_(finders_.size()) {
    const Pipeline& pipeline = edges.pipeline;
    found_.tiles.resize(edges.search_tiles.size());
    found_.toned.resize(edges.search_tiles.size());
    found_.hidden.resize(edges.search_tiles.size());
    if (edges.wants_faces() && pipeline.lines.enlargement != nullptr) {
        found_.tiling.emplace(pipeline.scene, pipeline.camera.projection(),
                              *pipeline.lines.enlargement);
    } else if (edges.draws_borders()) {
        found_.borders.emplace(pipeline.settings.size, edges.ink.reach(),
                               edges.ink.has_several_inks());
    } else if (edges.wants_faces()) {
        found_.faces.emplace(pipeline.scene, pipeline.settings.size, edges.q);
    }
    if (edges.wants_ridges()) {
        ridges_.emplace(pipeline, edges.viewpoint, edges.q, edges.search_area(), loop.threads());
    }
    // Ridges and drafts need all tiles before lines are mended.
    const bool puts_off = edges.mends_lines() && !ridges_ && pipeline.lines.enlargement == nullptr;
    for (std::size_t k = 0; k < edges.search_tiles.size(); ++k) {
        (puts_off && !may_see(edges, edges.search_tiles[k]) ? empty_ : seeing_).push_back(k);
    }
    if (edges.smooth_shading) {
        fringes_.reserve(found_.tiles.size());
        for (const TileLines& tile : found_.tiles) fringes_.push_back(&tile.fringe);
    }
    loop.expect(items());
}

/// Calls of the loop's body, but for work beside.
std::size_t LineSearch::items() const {
    const std::size_t ridges = ridges_ ? ridges_->strips() + ridges_->bands() : 0;
    const auto threads = static_cast<std::size_t>(loop_.threads());
    return seeing_.size() + ridges + threads + (fringes_.empty() ? 0 : seeing_.size()) +
           empty_.size();
}

LineFinder& LineSearch::finder(std::size_t worker) {
    std::unique_ptr<LineFinder>& own = finders_[worker];
    if (!own) {
        const FaceMaps maps{found_.faces ? &*found_.faces : nullptr,
                            found_.borders ? &*found_.borders : nullptr,
                            found_.tiling ? &*found_.tiling : nullptr};
        own = std::make_unique<LineFinder>(edges_, maps, ridges_ ? &*ridges_ : nullptr);
    }
    return *own;
}

void LineSearch::search_tiles() {
    loop_.run(seeing_.size(),
              [&](std::size_t k, std::size_t worker) { search(seeing_[k], worker); });
}

void LineSearch::search(std::size_t tile, std::size_t worker) {
    LineFinder& own = finder(worker);
    found_.tiles[tile] = own.search(edges_.search_tiles[tile]);
    if (edges_.tones) found_.toned[tile] = own.take_toned();
    if (edges_.behind.empty()) return;
    if (!behind_[worker]) behind_[worker] = std::make_unique<HiddenLineFinder>(edges_);
    found_.hidden[tile] = behind_[worker]->search(edges_.search_tiles[tile], own);
}

/// From now on all finders see nothing but points, and empty tiles.
void LineSearch::end_search() {
    for (std::size_t worker = 0; worker < finders_.size(); ++worker) finder(worker).end_search();
}

/// There is nothing to be found, but there are pixels to put.
void LineSearch::fill_empty(std::size_t tile, std::size_t worker) {
    finder(worker).search(edges_.search_tiles[tile]);
    if (!fringes_.empty()) finish_fringe(tile);
}

/// Puts the pixels on the film to which lines of several tiles add.
void LineSearch::finish_fringe(std::size_t tile) const {
    const ColorPacket& empty = edges_.pipeline.shader.background();
    const PixelColor background{empty.r[0], empty.g[0], empty.b[0], empty.a[0]};
    ink::finish_fringe(edges_.search_tiles, fringes_, edges_.search_tiles_across(), tile,
                       background, edges_.pipeline.film);
}

/// Mending is for one thread for most of the time. The others find ridges, put the pixels to which
/// lines of several tiles add, and fill the empty tiles. What asks for rays and what fills tiles
/// share the finders, of which each thread has its own.
void LineSearch::mend(const SideWork& beside) {
    if (ridges_) {
        loop_.run(ridges_->strips(),
                  [&](std::size_t k, std::size_t worker) { ridges_->trace_strip(k, worker); });
    }
    const std::size_t bands = ridges_ ? ridges_->bands() : 0;
    const std::size_t fringes = fringes_.empty() ? 0 : seeing_.size();
    const auto do_beside = [&](std::size_t i, std::size_t worker) {
        if (i < bands) {
            ridges_->search_band(i, worker);
        } else if (i -= bands; i < fringes) {
            finish_fringe(seeing_[i]);
        } else if (i -= fringes; i < empty_.size()) {
            fill_empty(empty_[i], worker);
        } else {
            beside.body(i - empty_.size());
        }
    };
    Team team(
        bands + fringes + empty_.size() + beside.items,
        [&](std::size_t i, std::size_t worker) { loop_.item([&] { do_beside(i, worker); }); });
    LineMender mender(edges_, finders_, found_.tiles, found_.toned, team);
    const bool mends = edges_.mends_lines();
    if (mends) end_search();
    loop_.run(static_cast<std::size_t>(loop_.threads()), [&](std::size_t k, std::size_t worker) {
        team.work(k, worker, [&] {
            if (mends) mender.mend();
        });
    });
    serial_ += mender.stats();
}

/// Returns what they add to the density of lines.
LineDensity LineSearch::take_ridges() {
    LineDensity density = edges_.no_lines;
    if (!ridges_) return density;
    double ms = 0.0;
    {
        const Timer timer(ms);
        const LineMasks lines = masks_of(edges_, found_.tiles, ridges_->radius_px());
        ridges_->take(lines.touching, lines.near, [&](Segment& ridge) {
            if (edges_.attenuates_lines()) edges_.attenuate(ridge);
            const InkStroke stroke = make_ink_stroke(ridge, edges_.style_of(ridge));
            density.add(stroke, edges_.ink.styles[stroke.style].width_px * stroke.width_scale);
            keep(edges_, ridge, found_);
        });
    }
    const bool others_wait = edges_.pipeline.lines.enlargement == nullptr;
    serial_.lines_ms += others_wait ? ms * loop_.threads() : ms;
    serial_.ridges_ms += others_wait ? ms * loop_.threads() : ms;
    return density;
}

/// What threads have worked with is given back at once, and not when the picture is done and the
/// others have left.
void LineSearch::finish() {
    found_.thinning = thinning_of(edges_, finders_, take_ridges());
    serial_ = stats();
    finders_.clear();
    behind_.clear();
    ridges_.reset();
}

RenderStats LineSearch::stats() const {
    RenderStats total = serial_;
    for (const auto& finder : finders_) {
        if (finder) total += finder->stats();
    }
    for (const auto& finder : behind_) {
        if (finder) total += finder->stats();
    }
    if (ridges_) total += ridges_->stats();
    return total;
}

void add_hidden_strokes(const EdgesPlan& edges, FoundLines& found) {
    if (!edges.draw_lines || edges.behind.empty()) return;
    std::vector<Segment> lines;
    for (const std::vector<Segment>& tile : found.hidden) {
        lines.insert(lines.end(), tile.begin(), tile.end());
    }
    for (const Segment& stroke : hidden_strokes(edges, lines)) keep(edges, stroke, found);
}

}  // namespace ink
