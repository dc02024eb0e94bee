#include "render/ridge_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "base/multiversion.h"
#include "base/timer.h"
#include "lines/short_ridges.h"

namespace ink {

namespace {

/// Rows of cells that a thread searches at a time. Discs reach over a band's ends, so that few
/// large ones are less work; threads share several each.
int band_rows_of(int cells, int threads) {
    constexpr int kLeast = 16;
    constexpr int kMost = 128;
    constexpr int kBandsOfThread = 4;
    return std::clamp(cells / (kBandsOfThread * threads), kLeast, kMost);
}

int floor_of(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }
int ceiling_of(int a, int b) { return -floor_of(-a, b); }

int radius_of(const Pipeline& pipeline, int per_pixel) {
    return std::max(2,
                    static_cast<int>(std::lround(pipeline.settings.ridge_scale_px() * per_pixel)));
}

/// Nodes two pixels apart, or fewer lattice points if the neighbourhood would be less than three
/// nodes in radius; there are four in a pixel at most.
int step_of(int radius, int per_pixel) {
    int step = 2 * per_pixel;
    while (step > 1 && radius < 3 * step && step > per_pixel / 2) step /= 2;
    return step;
}

/// Of a tile's lattice points along an axis, the first node at or after each, within `range`.
/// Looked up, as blocks ask often and to divide takes long.
class FirstNodes {
  public:
    FirstNodes(int first_point, int first_node, int step, std::pair<int, int> range)
        : first_point_(first_point), end_(range.second) {
        const int last_point = (first_node + range.second) * step;
        nodes_.reserve(static_cast<std::size_t>(std::max(last_point - first_point, 0)));
        for (int point = first_point; point < last_point; ++point) {
            nodes_.push_back(std::max(range.first, ceiling_of(point, step) - first_node));
        }
    }
    int from(int point) const {
        const auto k = static_cast<std::size_t>(point - first_point_);
        return k < nodes_.size() ? nodes_[k] : end_;
    }

  private:
    int first_point_, end_;
    std::vector<int> nodes_;
};

bool is_whole(const Block& block) {
    return block.across == kBlockSide && block.columns == kBlockSide && block.rows == kBlockSide;
}

}  // namespace

RidgeSettings ridge_settings(const Settings& settings) {
    // Degrees for each hundredth of the picture's height.
    const double pixels = 0.01 * settings.size.height;
    const double turn = settings.ridge_turn_deg * std::numbers::pi / 180.0 / pixels;
    return {static_cast<float>(turn), static_cast<float>(2.0 * turn)};
}

struct RidgeSearch::Worker {
    explicit Worker(const RidgeSearch& search)
        : sampler(*search.pipeline_.frame, search.pipeline_.camera),
          field(search.grid_, search.viewpoint_, search.pattern_,
                ridge_settings(search.pipeline_.settings)) {}

    Sampler sampler;
    RidgeField field;
    RenderStats stats;
};

RidgeSearch::RidgeSearch(const Pipeline& pipeline, const Viewpoint& viewpoint, int per_pixel,
                         const Tile& area, int threads)
    : pipeline_(pipeline),
      viewpoint_(viewpoint),
      per_pixel_(per_pixel),
      radius_(radius_of(pipeline, per_pixel)),
      step_(step_of(radius_, per_pixel)),
      pattern_(std::clamp((radius_ + step_ / 2) / step_, 2, 48),
               static_cast<float>(step_) / static_cast<float>(per_pixel)),
      apron_(static_cast<int>(pattern_.half_widths().size()) - 1),
      x0_(floor_of(area.x0 * per_pixel, step_) - apron_),
      y0_(floor_of(area.y0 * per_pixel, step_) - apron_),
      grid_(ceiling_of(area.x1 * per_pixel, step_) + apron_ + 1 - x0_,
            ceiling_of(area.y1 * per_pixel, step_) + apron_ + 1 - y0_,
            {(static_cast<float>(x0_ * step_) + 0.5F) / static_cast<float>(per_pixel),
             (static_cast<float>(y0_ * step_) + 0.5F) / static_cast<float>(per_pixel)},
            static_cast<float>(step_) / static_cast<float>(per_pixel)),
      band_rows_(band_rows_of(rows_of_cells(), threads)),
      kept_(nodes_of(area)),
      found_(static_cast<std::size_t>((rows_of_cells() + band_rows_ - 1) / band_rows_)),
      workers_(static_cast<std::size_t>(threads)) {
    cut_rim();
    const auto& objects = pipeline.scene.objects();
    for (std::uint32_t k = 0; k < objects.size(); ++k) {
        balls_.push_back(std::holds_alternative<Spheres>(objects[k].shape) &&
                         pipeline.ids.is_ball(k));
    }
    has_balls_ = std::ranges::count(balls_, 0) < std::ssize(balls_);
}

RidgeSearch::~RidgeSearch() = default;

/// Those on lattice points of the tile.
RidgeSearch::Nodes RidgeSearch::nodes_of(const Tile& pixels) const {
    const auto node = [&](int pixel) { return ceiling_of(pixel * per_pixel_, step_); };
    return {node(pixels.x0) - x0_, node(pixels.y0) - y0_, node(pixels.x1) - x0_,
            node(pixels.y1) - y0_};
}

/// What lies around the tiles, in pieces that do not depend on them.
void RidgeSearch::cut_rim() {
    constexpr int kLength = 32;
    const auto cut = [&](const Nodes& all) {
        for (int y = all.y0; y < all.y1; y += kLength) {
            for (int x = all.x0; x < all.x1; x += kLength) {
                strips_.push_back(
                    {x, y, std::min(x + kLength, all.x1), std::min(y + kLength, all.y1)});
            }
        }
    };
    cut({0, 0, grid_.width, kept_.y0});
    cut({0, kept_.y1, grid_.width, grid_.height});
    cut({0, kept_.y0, kept_.x0, kept_.y1});
    cut({kept_.x1, kept_.y0, grid_.width, kept_.y1});
}

void RidgeSearch::keep(const Tile& tile, const LatticeView& lattice) {
    const Nodes nodes = nodes_of(tile);
    const auto count = static_cast<std::size_t>(std::max(nodes.x1 - nodes.x0, 0));
    for (int j = nodes.y0; j < nodes.y1; ++j) {
        std::fill_n(grid_.id.data() + grid_.index(nodes.x0, j), count, kBackground);
    }
    if (!lattice.saw_anything) return;
    const FirstNodes columns(tile.x0 * per_pixel_, x0_, step_, {nodes.x0, nodes.x1});
    const FirstNodes rows(tile.y0 * per_pixel_, y0_, step_, {nodes.y0, nodes.y1});
    for (std::size_t k = 0; k < lattice.blocks.size(); ++k) {
        const Block& block = lattice.blocks[k];
        if (step_ == 1 && is_whole(block) && block.x - x0_ + kBlockSide <= nodes.x1 &&
            block.y - y0_ + kBlockSide <= nodes.y1) {
            put_block(lattice.hits[k], lattice.normals[k], block);
            continue;
        }
        for (int j = rows.from(block.y); j < rows.from(block.y + block.rows); ++j) {
            const int above = ((y0_ + j) * step_ - block.y) * block.across;
            for (int i = columns.from(block.x); i < columns.from(block.x + block.columns); ++i) {
                put(lattice.hits[k], lattice.normals[k], above + (x0_ + i) * step_ - block.x,
                    grid_.index(i, j));
            }
        }
    }
}

/// Where each lattice point is a node.
void RidgeSearch::put_block(const HitPacket& hits, const NormalPacket& normals,
                            const Block& block) {
    Lanes<GeometryId> ids;
    pipeline_.ids.resolve(hits, ids);
    for (int i = 0; i < kLanes && has_balls_; ++i) {
        if (hits.object[i] != kNoObject && balls_[hits.object[i]] != 0) ids[i] = kBackground;
    }
    const std::size_t first = grid_.index(block.x - x0_, block.y - y0_);
    const auto copy = [&](const auto& from, auto& to) {
        for (int j = 0; j < kBlockSide; ++j) {
            std::copy_n(from.data() + j * kBlockSide, kBlockSide,
                        to.data() + first + static_cast<std::size_t>(j * grid_.width));
        }
    };
    copy(ids, grid_.id);
    copy(normals.x, grid_.nx);
    copy(normals.y, grid_.ny);
    copy(normals.z, grid_.nz);
    copy(hits.t, grid_.t);
}

/// Balls have none: their view-dependent curvature grows all the way to their outlines.
INKTRACE_INLINE void RidgeSearch::put(const HitPacket& hits, const NormalPacket& normals, int lane,
                                      std::size_t node) {
    const std::uint32_t object = hits.object[lane];
    if (object == kNoObject || balls_[object] != 0) return;
    grid_.id[node] = pipeline_.ids.resolve(object, hits.primitive[lane]);
    grid_.nx[node] = normals.x[lane];
    grid_.ny[node] = normals.y[lane];
    grid_.nz[node] = normals.z[lane];
    grid_.t[node] = hits.t[lane];
}

void RidgeSearch::trace(const Nodes& strip, Sampler& sampler) {
    std::vector<Vec2f> points;
    std::vector<std::size_t> nodes;
    const auto count = static_cast<std::size_t>(strip.x1 - strip.x0) *
                       static_cast<std::size_t>(strip.y1 - strip.y0);
    points.reserve(count);
    nodes.reserve(count);
    for (int j = strip.y0; j < strip.y1; ++j) {
        for (int i = strip.x0; i < strip.x1; ++i) {
            points.push_back(grid_.point(i, j));
            nodes.push_back(grid_.index(i, j));
            grid_.id[nodes.back()] = kBackground;
        }
    }
    const ScreenBox box{points.front().x, points.front().y, points.back().x, points.back().y};
    sampler.enter(box);
    if (!sampler.reaches(box)) return;
    std::vector<HitPacket> hits;
    sampler.trace_points(points, hits);
    NormalPacket normals;
    for (std::size_t n = 0; n < points.size(); ++n) {
        const std::size_t k = n / kLanes;
        const auto lane = static_cast<int>(n % kLanes);
        if (lane == 0) pipeline_.shader.smooth(hits[k], normals);
        put(hits[k], normals, lane, nodes[sampler.order()[n]]);
    }
}

int RidgeSearch::rows_of_cells() const { return std::max(0, grid_.height - 2 * apron_ - 1); }

RidgeSearch::Worker& RidgeSearch::worker_of(std::size_t thread) {
    if (!workers_[thread]) workers_[thread] = std::make_unique<Worker>(*this);
    return *workers_[thread];
}

void RidgeSearch::trace_strip(std::size_t strip, std::size_t thread) {
    Worker& worker = worker_of(thread);
    const Timer timer(worker.stats.lines_ms);
    const Timer phase(worker.stats.ridges_ms);
    trace(strips_[strip], worker.sampler);
}

void RidgeSearch::search_band(std::size_t band, std::size_t thread) {
    Worker& worker = worker_of(thread);
    const Timer timer(worker.stats.lines_ms);
    const Timer phase(worker.stats.ridges_ms);
    const int first = apron_ + static_cast<int>(band) * band_rows_;
    const int last = std::min(first + band_rows_, grid_.height - apron_ - 1);
    worker.field.find(first, last, found_[band]);
}

RenderStats RidgeSearch::stats() const {
    RenderStats total;
    for (const auto& worker : workers_) {
        if (!worker) continue;
        total += worker->stats;
        total.rays += worker->sampler.rays();
    }
    return total;
}

std::vector<RidgePiece> RidgeSearch::pieces_beside(const LineMask& touching, const LineMask& near) {
    std::size_t most = 0;
    for (const std::vector<RidgePiece>& band : found_) most += band.size();
    std::vector<RidgePiece> pieces;
    std::vector<float> lengths;
    pieces.reserve(most);
    lengths.reserve(most);
    for (const std::vector<RidgePiece>& band : found_) {
        for (const RidgePiece& piece : band) {
            const Vec2f middle = (piece.a + piece.b) * 0.5F;
            if (touching.covers(middle)) continue;
            pieces.push_back(piece);
            lengths.push_back(near.covers(middle) ? 0.0F : length(piece.b - piece.a));
        }
    }
    drop_short_ridges(pieces, lengths, grid_.width, radius_px());
    return pieces;
}

Segment RidgeSearch::segment_of(const RidgePiece& piece) const {
    Segment segment;
    segment.a = piece.a;
    segment.b = piece.b;
    segment.type = segment.type_at_b = LineType::ridge;
    segment.strength = piece.strength;
    segment.t = grid_.t[piece.node];
    segment.left = segment.right = segment.owner = grid_.id[piece.node];
    segment.left_at_b = segment.right_at_b = segment.owner;
    segment.spans_cell = true;
    return segment;
}

}  // namespace ink
