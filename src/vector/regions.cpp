#include "vector/regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "base/color.h"
#include "base/parallel.h"

namespace ink {

namespace {

/// A chain walked so that the region lies on its left.
struct Use {
    GeometryId id;
    std::uint32_t chain;
    bool reversed;
};

void append(Curve& outline, const Curve& next) {
    outline.pieces.insert(outline.pieces.end(), next.pieces.begin(), next.pieces.end());
}

void append_straight(Curve& outline, Vec2f to) {
    const Vec2f from = outline.end();
    if (from == to) return;
    outline.pieces.push_back(straight_piece(from, to));
}

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

/// The rectangle that was searched. Places on its border are counted the way that has the inside on
/// the left: down the left side from the upper left corner, then along the bottom, in [0, 4).
class Border {
  public:
    Border(Vec2f lower, Vec2f upper) : lower_(lower), upper_(upper) {}

    /// Nothing for a point inside.
    std::optional<float> place(Vec2f p) const {
        constexpr float kNear = 1e-2F;  // pixels
        const Vec2f size = upper_ - lower_;
        const float x = std::clamp((p.x - lower_.x) / size.x, 0.0F, 1.0F);
        const float y = std::clamp((p.y - lower_.y) / size.y, 0.0F, 1.0F);
        if (p.x < lower_.x + kNear) return y;
        if (p.y > upper_.y - kNear) return 1.0F + x;
        if (p.x > upper_.x - kNear) return 3.0F - y;
        if (p.y < lower_.y + kNear) return 4.0F - x;
        return std::nullopt;
    }
    std::array<Vec2f, 4> corners() const {
        return {lower_, {lower_.x, upper_.y}, upper_, {upper_.x, lower_.y}};
    }
    /// Goes along the border from one place to another.
    void follow(float from, float to, Curve& outline) const {
        const float end = to < from ? to + 4.0F : to;
        for (int corner = static_cast<int>(from) + 1; static_cast<float>(corner) < end; ++corner) {
            append_straight(outline, corners()[static_cast<std::size_t>(corner % 4)]);
        }
    }

  private:
    Vec2f lower_, upper_;
};

double twice_area(const Region& region) {
    double sum = 0.0;
    for (const Curve& outline : region.outlines) sum += twice_area(outline);
    return sum;
}

/// Joins the uses of one geometry into closed outlines.
class Outliner {
  public:
    Outliner(const ChainGraph& graph, std::span<const Curve> curves, const Border& border)
        : graph_(graph), curves_(curves), border_(border) {}

    std::vector<Curve> outlines(std::span<const Use> uses);
    /// Whether any geometry so far goes on beyond the border.
    bool touched_border() const { return touched_border_; }

  private:
    struct Open {
        Curve curve;
        std::optional<float> first, last;  ///< places on the border
    };

    std::uint32_t start(const Use& use) const {
        const Chain& chain = graph_.chains[use.chain];
        return use.reversed ? chain.last_vertex : chain.first_vertex;
    }
    std::uint32_t finish(const Use& use) const { return start({use.id, use.chain, !use.reversed}); }
    Curve curve(const Use& use) const {
        return use.reversed ? reversed(curves_[use.chain]) : curves_[use.chain];
    }
    std::optional<std::size_t> unused_from(std::uint32_t vertex) const;
    void join(std::size_t first);
    std::vector<std::size_t> follow_ups() const;
    void close_open_runs();

    const ChainGraph& graph_;
    std::span<const Curve> curves_;
    const Border& border_;
    std::vector<Use> uses_;  ///< by the vertex at which they start
    std::vector<std::uint8_t> used_;
    std::vector<Curve> closed_;
    std::vector<Open> open_;
    bool touched_border_ = false;
};

std::optional<std::size_t> Outliner::unused_from(std::uint32_t vertex) const {
    const auto found =
        std::ranges::lower_bound(uses_, vertex, {}, [this](const Use& use) { return start(use); });
    for (auto use = found; use != uses_.end() && start(*use) == vertex; ++use) {
        const auto k = static_cast<std::size_t>(use - uses_.begin());
        if (used_[k] == 0) return k;
    }
    return std::nullopt;
}

void Outliner::join(std::size_t first) {
    const std::uint32_t goal = start(uses_[first]);
    Curve outline{curve(uses_[first]).start, {}};
    std::optional<std::size_t> next = first;
    std::uint32_t end = goal;
    while (next) {
        used_[*next] = 1;
        append(outline, curve(uses_[*next]));
        end = finish(uses_[*next]);
        if (end == goal) break;
        next = unused_from(end);
    }
    if (end == goal) {
        closed_.push_back(std::move(outline));
        return;
    }
    const Vec2f last = outline.pieces.back().end;
    const auto place = border_.place(outline.start);
    open_.push_back({std::move(outline), place, border_.place(last)});
}

/// Which run goes on where each one ends: along the border for those that leave the rectangle; for
/// those that end inside, at a line too thin to be found, one that starts near. Else itself.
std::vector<std::size_t> Outliner::follow_ups() const {
    constexpr float kNear = 4.0F;  // pixels
    struct Link {
        float way;
        std::size_t from, to;
    };
    std::vector<std::pair<float, std::size_t>> places, rows;  // of starts
    for (std::size_t k = 0; k < open_.size(); ++k) {
        if (open_[k].first) places.emplace_back(*open_[k].first, k);
        if (!open_[k].first) rows.emplace_back(open_[k].curve.start.y, k);
    }
    std::ranges::sort(places);
    std::ranges::sort(rows);
    std::vector<Link> links;
    for (std::size_t k = 0; k < open_.size(); ++k) {
        if (open_[k].last && !places.empty()) {
            const auto ahead = std::ranges::lower_bound(places, std::pair{*open_[k].last, k});
            links.push_back({0.0F, k, ahead == places.end() ? places[0].second : ahead->second});
        }
        if (open_[k].last) continue;
        const Vec2f end = open_[k].curve.pieces.back().end;
        auto row = std::ranges::lower_bound(rows, std::pair{end.y - kNear, std::size_t{0}});
        for (; row != rows.end() && row->first < end.y + kNear; ++row) {
            const float way = length(open_[row->second].curve.start - end);
            if (way < kNear) links.push_back({way, k, row->second});
        }
    }
    std::ranges::stable_sort(links, {}, &Link::way);
    constexpr auto kOpen = static_cast<std::size_t>(-1);
    std::vector<std::size_t> next(open_.size(), kOpen);
    std::vector<std::uint8_t> taken(open_.size(), 0);
    for (const Link& link : links) {
        if (next[link.from] != kOpen || taken[link.to] != 0) continue;
        next[link.from] = link.to;
        taken[link.to] = 1;
    }
    for (std::size_t k = 0; k < open_.size(); ++k) {
        if (next[k] == kOpen) next[k] = k;
    }
    return next;
}

void Outliner::close_open_runs() {
    const std::vector<std::size_t> next = follow_ups();
    std::vector<std::uint8_t> done(open_.size(), 0);
    for (std::size_t first = 0; first < open_.size(); ++first) {
        if (done[first] != 0) continue;
        Curve outline{open_[first].curve.start, {}};
        // May run into a cycle that does not come back to its start, and is closed then.
        for (std::size_t k = first; done[k] == 0; k = next[k]) {
            done[k] = 1;
            append_straight(outline, open_[k].curve.start);
            append(outline, open_[k].curve);
            const auto& goal = open_[next[k]].first;
            if (open_[k].last && goal) border_.follow(*open_[k].last, *goal, outline);
        }
        append_straight(outline, outline.start);
        closed_.push_back(std::move(outline));
    }
}

std::vector<Curve> Outliner::outlines(std::span<const Use> uses) {
    uses_.assign(uses.begin(), uses.end());
    std::ranges::stable_sort(uses_, {}, [this](const Use& use) { return start(use); });
    used_.assign(uses_.size(), 0);
    closed_.clear();
    open_.clear();
    std::vector<std::uint32_t> finishes;
    for (const Use& use : uses_) finishes.push_back(finish(use));
    std::ranges::sort(finishes);
    // Runs that start at the border first, or one could be entered in the middle.
    for (const bool open : {true, false}) {
        for (std::size_t k = 0; k < uses_.size(); ++k) {
            if (used_[k] != 0) continue;
            if (open && std::ranges::binary_search(finishes, start(uses_[k]))) continue;
            join(k);
        }
    }
    touched_border_ = touched_border_ || std::ranges::any_of(open_, [](const Open& run) {
                          return run.last.has_value();
                      });
    close_open_runs();
    return std::move(closed_);
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

namespace {

/// The pixels whose centres a region covers, row by row.
class RegionPixels {
  public:
    explicit RegionPixels(Size size) : size_(size) {}

    /// Calls `visit(y, x0, x1)` for runs of pixels [x0, x1).
    template <class Visit>
    void for_runs(const Region& region, const Visit& visit);

  private:
    void add_edge(Vec2d a, Vec2d b);
    void add_outline(const Curve& outline);

    struct Hit {
        int y;
        double x;
    };
    Size size_;
    std::vector<Hit> hits_;  ///< where outlines cross the middle of a row
};

void RegionPixels::add_edge(Vec2d a, Vec2d b) {
    const Vec2d top = a.y < b.y ? a : b;
    const Vec2d bottom = a.y < b.y ? b : a;
    const int first = std::max(static_cast<int>(std::ceil(top.y - 0.5)), 0);
    const int last = std::min(static_cast<int>(std::ceil(bottom.y - 0.5)), size_.height);
    for (int y = first; y < last; ++y) {
        const double share = (y + 0.5 - top.y) / (bottom.y - top.y);
        hits_.push_back({y, top.x + (bottom.x - top.x) * share});
    }
}

void RegionPixels::add_outline(const Curve& outline) {
    Vec2d at = to_double(outline.start);
    for (const CurvePiece& piece : outline.pieces) {
        const Vec2d p0 = at;
        const Vec2d p1 = to_double(piece.control1);
        const Vec2d p2 = to_double(piece.control2);
        const Vec2d p3 = to_double(piece.end);
        const double size = length(p1 - p0) + length(p2 - p1) + length(p3 - p2);
        const int steps = piece.straight ? 1 : std::clamp(static_cast<int>(size / 2.0), 2, 64);
        for (int k = 1; k <= steps; ++k) {
            const double u = static_cast<double>(k) / steps;
            const double v = 1.0 - u;
            const Vec2d next = k == steps ? p3
                                          : p0 * (v * v * v) + p1 * (3.0 * u * v * v) +
                                                p2 * (3.0 * u * u * v) + p3 * (u * u * u);
            add_edge(at, next);
            at = next;
        }
    }
}

template <class Visit>
void RegionPixels::for_runs(const Region& region, const Visit& visit) {
    hits_.clear();
    for (const Curve& outline : region.outlines) add_outline(outline);
    std::ranges::sort(
        hits_, [](const Hit& a, const Hit& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
    for (std::size_t k = 0; k + 1 < hits_.size(); k += 2) {
        const auto column = [&](double x) {
            return static_cast<int>(std::ceil(std::clamp(x - 0.5, 0.0, double{65536.0})));
        };
        const int first = column(hits_[k].x);
        const int last = std::min(column(hits_[k + 1].x), size_.width);
        if (hits_[k].y == hits_[k + 1].y && first < last) visit(hits_[k].y, first, last);
    }
}

std::array<float, 256> decoding_table() {
    std::array<float, 256> table{};
    for (std::size_t k = 0; k < table.size(); ++k) {
        table[k] = srgb_decode(static_cast<float>(k) / 255.0F);
    }
    return table;
}

std::uint8_t encode(double linear) {
    return static_cast<std::uint8_t>(std::lround(srgb_encode(static_cast<float>(linear)) * 255.0F));
}

/// A mean of pixels in linear light, weighted by alpha.
struct MeanColor {
    const std::array<float, 256>& decode;
    std::array<double, 3> sum{};
    double weight = 0.0;

    void add(std::uint32_t pixel) {
        const double alpha = (pixel >> 24U) / 255.0;
        for (std::size_t c = 0; c < 3; ++c) {
            sum[c] += alpha * static_cast<double>(decode[pixel >> (8U * c) & 255U]);
        }
        weight += alpha;
    }
    Rgb8 color() const {
        const double scale = weight > 0.0 ? 1.0 / weight : 0.0;
        return {encode(sum[0] * scale), encode(sum[1] * scale), encode(sum[2] * scale)};
    }
};

}  // namespace

void color_regions(std::span<Region> regions, const DisplayImage& image, int threads) {
    static const std::array<float, 256> kDecode = decoding_table();
    if (image.pixels.empty()) return;
    const auto pixel = [&](int x, int y) {
        return image
            .pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.size.width) +
                    static_cast<std::size_t>(x)];
    };
    constexpr std::size_t kGrain = 64;
    parallel_for(
        (regions.size() + kGrain - 1) / kGrain, threads, [&](std::size_t group, std::size_t) {
            RegionPixels pixels(image.size);
            const std::size_t end = std::min(regions.size(), (group + 1) * kGrain);
            for (std::size_t k = group * kGrain; k < end; ++k) {
                Region& region = regions[k];
                MeanColor mean{kDecode};
                pixels.for_runs(region, [&](int y, int x0, int x1) {
                    for (int x = x0; x < x1; ++x) mean.add(pixel(x, y));
                });
                if (mean.weight == 0.0 && !region.outlines.empty()) {
                    const Vec2f at = region.outlines.front().start;
                    mean.add(pixel(std::clamp(static_cast<int>(at.x), 0, image.size.width - 1),
                                   std::clamp(static_cast<int>(at.y), 0, image.size.height - 1)));
                }
                region.color = mean.color();
            }
        });
}

}  // namespace ink
