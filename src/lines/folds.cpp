#include "lines/folds.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "lines/bridges.h"
#include "lines/fold_crumbs.h"
#include "lines/fold_doubles.h"
#include "lines/fold_graph.h"
#include "lines/fold_probe.h"
#include "lines/segment_squares.h"

namespace ink {

using plane::SegmentSquares;

namespace {

using plane::dot;
using plane::length;
using plane::nearest_on;
using plane::unit;

constexpr std::uint32_t kNone = 0xFFFFFFFFU;

/// A self-occlusion that ends on its own, and the way on from there.
struct LooseEnd {
    Vec2f point, way;
    std::uint32_t fold = 0;
    bool at_b = false;
    bool open = true;
    Vec2f heading = way;            ///< of the line at the point; `way` is that at the path's end
    std::vector<Vec2f> path{};      ///< from the point on
    std::uint32_t reached = kNone;  ///< the segment that the path ends on
    bool leapt = false;             ///< reached by a leap, by one of its two ends

    Vec2f last() const { return path.empty() ? point : path.back(); }
};

class FoldMender {
  public:
    FoldMender(std::span<const Segment> lines, const SegmentSquares& squares,
               const Viewpoint& viewpoint, float spacing, float width, const FoldTeam& team,
               const FoldSettings& settings)
        : lines_(lines),
          squares_(squares),
          spacing_(spacing),
          stroke_(width),
          width_(std::max(width, settings.least_width)),
          loop_(team.loop),
          settings_(settings),
          probe_(lines, viewpoint, spacing, team.workers, settings),
          graph_(lines) {}

    FoldRepairs run() {
        if (graph_.folds().empty()) return {};
        pieces_ = graph_.roots();
        find_loose_ends();
        follow_valleys();
        leap_gaps();
        build_bridges();
        find_crumbs();
        drop_doubles();
        return std::move(repairs_);
    }

  private:
    std::uint32_t root(std::uint32_t k) const { return graph_.root(k); }
    bool is_fold(std::uint32_t k) const { return graph_.is_fold(k); }

    /// Of an end of a fold.
    template <class End>
    static std::size_t number(const End& end) {
        return FoldGraph::number({end.fold, end.at_b});
    }

    /// The nearest line of another piece, no farther away than most of a lattice cell.
    std::uint32_t line_near(Vec2f point, std::uint32_t piece) const {
        float least = 0.75F * spacing_;
        std::uint32_t best = kNone;
        squares_.near(point, 2.0F * least, [&](std::uint32_t k) {
            if (is_fold(k) && pieces_[k] == piece) return;
            const float distance = length(nearest_on(lines_[k], point) - point);
            // Two segments may share the nearest point.
            if (distance > least || (distance == least && best != kNone && !before(k, best)))
                return;
            least = distance;
            best = k;
        });
        return best;
    }

    bool before(std::uint32_t k, std::uint32_t n) const {
        const auto key = [](const Segment& s) {
            return std::tuple(s.type, s.a.y, s.a.x, s.b.y, s.b.x);
        };
        return key(lines_[k]) < key(lines_[n]);
    }

    void find_loose_ends() {
        whole_.assign(lines_.size(), 0);
        for (const auto [fold, at_b] : graph_.loose_ends()) {
            const Vec2f point = graph_.point({fold, at_b});
            const std::uint32_t near = line_near(point, pieces_[fold]);
            if (near != kNone) {
                endings_.hangs.push_back({fold, near, at_b});
                tails_.push_back({fold, at_b});
                if (goes_on_as_another(point)) whole_[pieces_[fold]] = 1;
                const bool shared = point == lines_[near].a || point == lines_[near].b;
                if (!shared && (!at_b || lines_[fold].spans_cell)) endings_.stubs.push_back(fold);
                continue;
            }
            ends_.push_back(
                {point, unit(point - graph_.back_from({fold, at_b}, 3.0F * spacing_)), fold, at_b});
        }
        pass_on();
    }

    /// Whether just one line of another kind ends there, too: one line, whose type changes.
    bool goes_on_as_another(Vec2f point) const {
        int count = 0;
        squares_.near(point, spacing_, [&](std::uint32_t k) {
            count += !is_fold(k) && (lines_[k].a == point || lines_[k].b == point) ? 1 : 0;
        });
        return count == 1;
    }

    /// What hangs on another fold, a step from that one's end, goes on as that one does: it hangs
    /// on what that hangs on, or both are one.
    void pass_on() {
        carried_.assign(lines_.size(), kNone);
        constexpr std::uint32_t kOnNothing = kNone - 1;
        std::vector<std::uint32_t> lines_at(2 * lines_.size(), kNone);
        for (const FoldHang& hang : endings_.hangs) lines_at[number(hang)] = hang.line;
        for (const LooseEnd& end : ends_) lines_at[number(end)] = kOnNothing;
        for (FoldHang& hang : endings_.hangs) {
            if (!is_fold(hang.line)) continue;
            const Vec2f from = hang.at_b ? lines_[hang.fold].b : lines_[hang.fold].a;
            FoldGraph::NearEnd near = graph_.end_near({hang.line, false}, from);
            const FoldGraph::NearEnd other = graph_.end_near({hang.line, true}, from);
            if (other.away < near.away) near = other;
            if (near.end / 2 == hang.fold) continue;
            if (near.away > 2.0F * spacing_) {
                carry(hang, from);
                continue;
            }
            const std::uint32_t line = lines_at[near.end];
            if (line == kNone) continue;
            if (line == kOnNothing || pieces_[line] == pieces_[hang.fold]) {
                endings_.followers.push_back(hang);
            } else {
                hang.line = line;
            }
        }
    }

    /// What hangs on another fold and goes on as that one does to a line close by hangs on this
    /// line. The way to it stays, even if the rest of the other fold is a crumb.
    void carry(FoldHang& hang, Vec2f from) {
        const std::uint32_t other = hang.line;
        const Vec2f way = unit(from - graph_.back_from({hang.fold, hang.at_b}, 3.0F * spacing_));
        FoldEnd end{other, dot(lines_[other].b - lines_[other].a, way) > 0.0F};
        std::vector<std::uint32_t> walked;
        Vec2f at = nearest_on(lines_[other], from);
        for (float gone = 0.0F; gone <= settings_.shortest * width_;) {
            const Vec2f to = graph_.point(end);
            gone += length(to - at);
            at = to;
            walked.push_back(end.fold);
            if (dot(unit(at - from), way) < 0.7F && gone > spacing_) return;
            const std::uint32_t line = line_near(at, pieces_[other]);
            const std::optional<FoldEnd> next = graph_.next(end);
            if (line != kNone && pieces_[line] != pieces_[hang.fold]) {
                const bool is_on = at == lines_[line].a || at == lines_[line].b;
                if (next && !is_on) walked.push_back(next->fold);  // up to the line
                hang.line = line;
                for (const std::uint32_t k : walked) carried_[k] = hang.fold;
                return;
            }
            if (!next) return;
            end = {next->fold, !next->at_b};
        }
    }

    // Valleys of the angle between surface and ray

    static constexpr int kStepsInArea = 8;

    /// Of two ends that lie on one valley, each would come to the other. So first those that go to
    /// the right, then those that nothing has come to.
    void follow_valleys() {
        const auto goes_right = [](const LooseEnd& end) {
            return end.way.x > 0.0F || (end.way.x == 0.0F && end.way.y > 0.0F);
        };
        std::vector<std::uint32_t> first;
        std::vector<std::uint32_t> second;
        for (std::uint32_t k = 0; k < ends_.size(); ++k) {
            (goes_right(ends_[k]) ? first : second).push_back(k);
        }
        follow(first);
        take_arrivals(first);
        std::erase_if(second, [&](std::uint32_t k) { return ends_[k].reached != kNone; });
        follow(second);
        take_arrivals(second);
    }

    /// End by end: a packet of rays that lie close together meets little of the scene.
    void follow(std::span<const std::uint32_t> ends) {
        loop_(ends.size(), [&](std::size_t n, std::size_t worker) {
            LooseEnd& end = ends_[ends[n]];
            for (int gone = 0; end.open; ++gone) {
                if (gone % kStepsInArea == 0) look_ahead(end, worker);
                step(end, worker);
            }
        });
    }

    /// An end that a way has come to is where that line goes on.
    void take_arrivals(std::span<const std::uint32_t> followed) {
        std::vector<std::uint32_t> ends_at(2 * lines_.size(), kNone);
        for (std::uint32_t k = 0; k < ends_.size(); ++k) ends_at[number(ends_[k])] = k;
        for (const std::uint32_t k : followed) {
            const std::uint32_t target = ends_[k].reached;
            if (target == kNone || !is_fold(target)) continue;
            if (ends_[k].path.empty()) continue;  // it is itself where another way has come to
            for (const std::uint32_t met : {ends_at[2 * target], ends_at[2 * target + 1]}) {
                if (met == kNone || ends_[met].reached != kNone) continue;
                if (length(ends_[met].point - ends_[k].path.back()) >= spacing_) continue;
                ends_[met].reached = ends_[k].fold;
                ends_[met].path.clear();
            }
        }
    }

    /// Enters what the next few steps see, so that they share what is found there.
    void look_ahead(const LooseEnd& end, std::size_t worker) const {
        const float reach = 0.5F * kStepsInArea * spacing_;
        probe_.enter(end.last() + end.way * reach, reach + 3.0F * spacing_, worker);
    }

    void step(LooseEnd& end, std::size_t worker) const {
        const Vec2f from = end.last();
        const std::optional<Vec2f> lowest =
            probe_.find_valley(from + end.way * spacing_, end.way, lines_[end.fold].owner, worker);
        end.open = lowest.has_value();
        if (lowest) go_on(end, *lowest);
    }

    void go_on(LooseEnd& end, Vec2f point) const {
        const Vec2f way = unit(point - end.last());
        if (dot(way, end.way) < 0.7F) {
            end.open = false;
            return;
        }
        end.way = unit(end.way + way);
        end.path.push_back(point);
        const float gone = spacing_ * static_cast<float>(end.path.size());
        const std::uint32_t near = line_near(point, pieces_[end.fold]);
        if (near != kNone) {
            end.open = false;
            if (is_fold(near) || gone <= settings_.longest_to_other * width_) end.reached = near;
        } else if (gone > settings_.longest_bridge * width_) {
            end.open = false;
        }
    }

    // Leaps

    /// Two ends that look at each other over a short gap are one line, whatever the valley between
    /// them does, if the surface is steep all the way; so are two whose ways on come to each other,
    /// or so near. The nearest pairs first.
    void leap_gaps() {
        struct Pair {
            float apart;
            std::uint32_t first, second;
            auto operator<=>(const Pair&) const = default;
        };
        std::ranges::sort(ends_, {}, [](const LooseEnd& e) {
            return std::tuple(e.point.y, e.point.x, e.heading.y, e.heading.x);
        });
        const float most = settings_.longest_bridge * width_;
        std::vector<Pair> pairs;
        for (std::uint32_t k = 0; k < ends_.size(); ++k) {
            if (ends_[k].reached != kNone) continue;
            for (std::uint32_t n = k + 1; n < ends_.size(); ++n) {
                if (ends_[n].point.y - ends_[k].point.y > most) break;
                const float apart = length(ends_[n].point - ends_[k].point);
                if (ends_[n].reached == kNone && apart <= most && may_be_one(ends_[k], ends_[n])) {
                    pairs.push_back({apart, k, n});
                }
            }
        }
        std::ranges::sort(pairs);
        for (const auto [apart, k, n] : pairs) {
            if (ends_[k].reached != kNone || ends_[n].reached != kNone) continue;
            std::vector<Vec2f> path = way_between(ends_[k], ends_[n]);
            if (path.empty()) continue;
            ends_[k].path = std::move(path);
            ends_[k].reached = ends_[n].fold;
            ends_[n].reached = ends_[k].fold;
            ends_[k].leapt = ends_[n].leapt = true;
            ends_[n].path.clear();
        }
    }

    /// Whether two ends are of one surface, of two pieces, and have the nearer side in common.
    bool may_be_one(const LooseEnd& a, const LooseEnd& b) const {
        const Segment& s = lines_[a.fold];
        const Segment& t = lines_[b.fold];
        const bool a_front = s.left_in_front == a.at_b;
        const bool b_front = t.left_in_front == b.at_b;
        return s.owner == t.owner && a_front != b_front && root(a.fold) != root(b.fold);
    }

    /// A point on the way on from an end, and the direction there.
    struct OnWay {
        std::size_t steps;
        Vec2f point, way;
    };
    static OnWay on_way(const LooseEnd& end, std::size_t steps) {
        if (steps == 0) return {0, end.point, end.heading};
        const Vec2f at = end.path[steps - 1];
        return {steps, at, unit(at - (steps == 1 ? end.point : end.path[steps - 2]))};
    }

    /// From one end to the other, without the former; nothing if that is no way.
    std::vector<Vec2f> way_between(const LooseEnd& a, const LooseEnd& b) const {
        const auto [from, to] = where_nearest(a, b);
        const float apart = length(to.point - from.point);
        const float most = settings_.longest_leap * width_;
        if (apart > most || !face_each_other(from, to)) return {};
        std::vector<Vec2f> path(a.path.begin(),
                                a.path.begin() + static_cast<std::ptrdiff_t>(from.steps));
        const std::vector<Vec2f> leap =
            plane::curve_between(from.point, from.way, to.point, to.way, spacing_);
        if (!is_steep(leap, lines_[a.fold].owner, from.point, most)) return {};
        path.insert(path.end(), leap.begin(), leap.end());
        for (std::size_t n = to.steps; n-- > 0;) path.push_back(on_way(b, n).point);
        return path;
    }

    /// Of two ways on; as short as may be.
    static std::pair<OnWay, OnWay> where_nearest(const LooseEnd& a, const LooseEnd& b) {
        std::tuple<float, std::size_t, std::size_t> best{std::numeric_limits<float>::infinity(), 0,
                                                         0};
        for (std::size_t k = 0; k <= a.path.size(); ++k) {
            const Vec2f from = on_way(a, k).point;
            for (std::size_t n = 0; n <= b.path.size(); ++n) {
                best = std::min(best, std::tuple(length(on_way(b, n).point - from), k, n));
            }
        }
        return {on_way(a, std::get<1>(best)), on_way(b, std::get<2>(best))};
    }

    /// Whether each lies ahead of the other, or beside it where ways meet.
    bool face_each_other(const OnWay& a, const OnWay& b) const {
        constexpr float kAhead = 0.85F;
        const Vec2f apart = b.point - a.point;
        if (a.steps + b.steps > 0 && length(apart) < 2.0F * spacing_) {
            return dot(a.way, b.way) < -kAhead;
        }
        const Vec2f way = unit(apart);
        return dot(a.way, way) > kAhead && dot(b.way, way) < -kAhead;
    }

    /// Whether the surface is steep all along a path.
    bool is_steep(std::span<const Vec2f> path, GeometryId owner, Vec2f from, float reach) const {
        bool steep = false;
        loop_(1, [&](std::size_t, std::size_t worker) {
            probe_.enter(from, reach, worker);
            steep = probe_.is_steep(path, owner, worker);
        });
        return steep;
    }

    // Bridges

    void build_bridges() {
        for (LooseEnd& end : ends_) {
            if (end.reached == kNone || end.path.empty()) continue;
            const bool fold = is_fold(end.reached);
            // The other side may have come here first.
            if (fold && root(end.reached) == root(end.fold)) continue;
            bridge(end);
            if (fold && meets_end(end)) {
                graph_.unite(end.fold, end.reached);
            } else {
                endings_.hangs.push_back({end.fold, end.reached, end.at_b});
            }
        }
    }

    void bridge(const LooseEnd& end) {
        const Segment& target = lines_[end.reached];
        Vec2f foot = nearest_on(target, end.path.back());
        for (const Vec2f tip : {target.a, target.b}) {
            if (length(tip - foot) < 0.5F * spacing_) foot = tip;
        }
        std::vector<Vec2f> path{end.point};
        path.insert(path.end(), end.path.begin(), end.path.end());
        path.back() = foot;
        std::vector<Vec2f> smooth = path;
        for (std::size_t n = 1; n + 1 < path.size(); ++n) {
            smooth[n] = path[n] * 0.5F + (path[n - 1] + path[n + 1]) * 0.25F;
        }
        for (std::size_t n = 0; n + 1 < smooth.size(); ++n) {
            add_pieces(end, smooth[n], smooth[n + 1], n + 2 == smooth.size());
        }
    }

    /// Whether the way on leads to the end of another fold, not to its middle.
    bool meets_end(const LooseEnd& end) const {
        const Segment& target = lines_[end.reached];
        return std::ranges::any_of(std::array{target.a, target.b}, [&](Vec2f tip) {
            return length(tip - end.path.back()) < spacing_ && graph_.ends_at(tip);
        });
    }

    /// Segments lie within cells and share their ends on the cells' sides.
    void add_pieces(const LooseEnd& end, Vec2f a, Vec2f b, bool is_last) {
        const std::vector<Vec2f> points = plane::cut_by_cells(a, b, spacing_);
        for (std::size_t n = 1; n < points.size(); ++n) {
            Segment piece = plane::piece_like(lines_[end.fold], end.at_b, points[n - 1], points[n]);
            if (is_last && n + 1 == points.size()) piece.spans_cell = false;
            repairs_.bridges.push_back(piece);
            owners_.push_back(end.fold);
        }
    }

    // Crumbs

    void find_crumbs() {
        for (const LooseEnd& end : ends_) {
            endings_.loose.push_back(end.fold);
            if (end.reached == kNone) endings_.free.push_back(end.fold);
        }
        FoldCrumbs crumbs(lines_, squares_, graph_, probe_, loop_, spacing_, stroke_, settings_);
        repairs_.crumbs = crumbs.find(endings_, repairs_.bridges, owners_);
        std::erase_if(repairs_.crumbs, [&](std::size_t k) {
            return carried_[k] != kNone && !crumbs.has(carried_[k]);
        });
        std::size_t kept = 0;
        for (std::size_t n = 0; n < owners_.size(); ++n) {
            if (crumbs.has(owners_[n])) continue;
            repairs_.bridges[kept] = repairs_.bridges[n];
            owners_[kept++] = owners_[n];
        }
        repairs_.bridges.resize(kept);
        owners_.resize(kept);
    }

    void drop_doubles() {
        for (const LooseEnd& end : ends_) {
            if (end.reached == kNone) tails_.push_back({end.fold, end.at_b});
        }
        std::erase_if(tails_, [&](FoldEnd tail) { return whole_[pieces_[tail.fold]] != 0; });
        const auto next_of = [&](FoldEnd tail) {
            return graph_.next({tail.fold, !tail.at_b}).value_or(FoldEnd{kNone, false});
        };
        repairs_.crumbs = FoldDoubles(lines_, squares_, pieces_, repairs_.bridges, owners_)
                              .drop(tails_, next_of, repairs_.crumbs, settings_.shadow * stroke_);
    }

    std::span<const Segment> lines_;
    const SegmentSquares& squares_;  ///< of the lines
    float spacing_;
    float stroke_;  ///< width of the line, pixels
    float width_;   ///< that lengths are counted in
    const FoldLoop& loop_;
    const FoldSettings& settings_;
    FoldProbe probe_;
    FoldGraph graph_;
    std::vector<std::uint32_t> pieces_;  ///< of each line: its group before any bridge was built
    FoldEndings endings_;
    std::vector<std::uint32_t> carried_;  ///< a line: the fold that goes on along it
    std::vector<LooseEnd> ends_;
    std::vector<std::uint8_t> whole_;  ///< a piece: it goes on as a line of another kind
    /// Ends of folds, by their segments, that may double another one.
    std::vector<FoldEnd> tails_;
    FoldRepairs repairs_;
    std::vector<std::uint32_t> owners_;  ///< a bridge: the fold at which it starts
};

}  // namespace

FoldRepairs mend_folds(std::span<const Segment> lines, const SegmentSquares& squares,
                       const Viewpoint& viewpoint, float spacing, float width, const FoldTeam& team,
                       const FoldSettings& settings) {
    return FoldMender(lines, squares, viewpoint, spacing, width, team, settings).run();
}

FoldRepairs mend_folds(std::span<const Segment> lines, const Viewpoint& viewpoint, float spacing,
                       float width, const SampleFunction& sample, const FoldSettings& settings) {
    const FoldTeam alone{{{sample, {}}}, [](std::size_t count, const auto& body) {
                             for (std::size_t k = 0; k < count; ++k) body(k, 0);
                         }};
    return mend_folds(lines, SegmentSquares(lines), viewpoint, spacing, width, alone, settings);
}

}  // namespace ink
