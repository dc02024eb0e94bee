#include "lines/near_junctions.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <vector>

#include "lines/junctions.h"

namespace ink {

namespace {

/// Junctions no farther from each other, in pixels, may be one. A lattice of one point a pixel
/// finds as many of the chains that are longer as a finer one does, of those that are shorter half
/// (haemoglobin at 1024 x 1024).
constexpr double kNear = 1.0;

/// The way from one to the other, in distances of kNear: it may bend, but not enclose a thing.
constexpr double kLongestWay = 1.5;

/// What is seen through a hole narrower than this, in pixels, falls between the points of a lattice
/// of one point a pixel or not, by chance, and a slit shows as a row of holes. A round hole counts
/// half its diameter.
constexpr double kNarrow = 0.5;
/// Longer slits stay, in pixels round.
constexpr double kLongestRound = 8.0;

/// Whether a chain is the rim of a narrow hole in what is in front.
bool is_pinhole(const Chain& chain) {
    if (!chain.closed || chain.left == chain.right || chain.type != LineType::silhouette) {
        return false;
    }
    const double round = length_of(chain);
    if (round >= kLongestRound) return false;
    double twice_area = 0.0;
    const Vec2d origin = to_double(chain.points.front());
    for (std::size_t k = 1; k + 1 < chain.points.size(); ++k) {
        twice_area +=
            cross(to_double(chain.points[k]) - origin, to_double(chain.points[k + 1]) - origin);
    }
    // Where y points down, a positive area lies on the right.
    const bool hole = chain.left_in_front == (twice_area > 0.0);
    return hole && std::abs(twice_area) < kNarrow * round;
}

/// Whether what lies between two chains that join the same junctions, the second the other way
/// round or not, is a narrow slit.
bool is_slit_between(const Chain& a, const Chain& b, bool backwards) {
    const double round = length_of(a) + length_of(b);
    if (round >= kLongestRound) return false;
    const Vec2d origin = to_double(a.points.front());
    const auto twice_area = [&](const Chain& chain) {
        double area = 0.0;
        for (std::size_t k = 0; k + 1 < chain.points.size(); ++k) {
            area +=
                cross(to_double(chain.points[k]) - origin, to_double(chain.points[k + 1]) - origin);
        }
        return area;
    };
    return std::abs(twice_area(a) + twice_area(b) * (backwards ? 1.0 : -1.0)) < kNarrow * round;
}

/// Sets of vertices, and the box that each lies in.
class VertexClusters {
  public:
    explicit VertexClusters(std::vector<Vec2f> places)
        : parent_(places.size()), low_(places), high_(std::move(places)) {
        std::iota(parent_.begin(), parent_.end(), 0U);
    }
    std::uint32_t find(std::uint32_t vertex) {
        while (parent_[vertex] != vertex) {
            vertex = parent_[vertex] = parent_[parent_[vertex]];
        }
        return vertex;
    }
    /// Whether they are in one set then, because all of it is near.
    bool join(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        if (a == b) return true;
        const Vec2f low{std::min(low_[a].x, low_[b].x), std::min(low_[a].y, low_[b].y)};
        const Vec2f high{std::max(high_[a].x, high_[b].x), std::max(high_[a].y, high_[b].y)};
        if (static_cast<double>(length(high - low)) > kNear) return false;
        const auto [first, second] = std::minmax(a, b);
        parent_[second] = first;
        low_[first] = low;
        high_[first] = high;
        return true;
    }
    Vec2d clamp(std::uint32_t vertex, Vec2d place) {
        const std::uint32_t root = find(vertex);
        return {std::clamp(place.x, static_cast<double>(low_[root].x),
                           static_cast<double>(high_[root].x)),
                std::clamp(place.y, static_cast<double>(low_[root].y),
                           static_cast<double>(high_[root].y))};
    }

  private:
    std::vector<std::uint32_t> parent_;
    std::vector<Vec2f> low_, high_;
};

class JunctionMerger {
  public:
    JunctionMerger(SegmentGraph& graph, const ChainedWays& lines)
        : graph_(graph),
          lines_(lines),
          places_(placed()),
          clusters_(places_),
          gone_(lines.graph.chains.size(), 0),
          marked_(graph.size(), 0) {}

    bool run() {
        find_short_chains();
        find_twins();
        if (std::ranges::find(gone_, 1) == gone_.end()) return false;
        mark_short_chains();
        place_clusters();
        graph_.reshape(places_, marked_);
        return true;
    }

  private:
    /// One end of a chain that stays.
    struct ChainEnd {
        std::uint32_t cluster;
        std::uint32_t chain;
        bool last;
    };

    const Chain& chain(std::size_t k) const { return lines_.graph.chains[k]; }

    std::vector<Vec2f> placed() const {
        std::vector<Vec2f> places = graph_.places();
        for (const Chain& chain : lines_.graph.chains) {
            if (chain.closed) continue;
            places[chain.first_vertex] = chain.points.front();
            places[chain.last_vertex] = chain.points.back();
        }
        return places;
    }

    /// The shortest first, so that which of them become one does not hang on an order.
    void find_short_chains() {
        struct Short {
            double length;
            std::uint32_t chain;
        };
        std::vector<Short> found;
        std::vector<std::uint32_t> degrees(places_.size());
        for (const Chain& chain : lines_.graph.chains) {
            ++degrees[chain.first_vertex];
            ++degrees[chain.last_vertex];
        }
        for (std::uint32_t k = 0; k < gone_.size(); ++k) {
            if (is_pinhole(chain(k))) gone_[k] = 1;
            // What ends in the open is drawn by pixels as well.
            const bool loose =
                degrees[chain(k).first_vertex] < 2 || degrees[chain(k).last_vertex] < 2;
            if (chain(k).closed || loose) continue;
            const double size = length_of(chain(k));
            if (size < 2.0 * kNear) found.push_back({size, k});
        }
        std::ranges::stable_sort(found, {}, &Short::length);
        for (const auto& [size, k] : found) {
            // There and back is twice as long.
            const bool loop =
                clusters_.find(chain(k).first_vertex) == clusters_.find(chain(k).last_vertex);
            if (loop || size < kLongestWay * kNear) {
                gone_[k] = clusters_.join(chain(k).first_vertex, chain(k).last_vertex) ? 1 : 0;
            }
        }
    }

    /// Of two lines that a lattice tells apart for a few pixels, where they come to one corner at
    /// an acute angle, one goes that divides no geometries.
    void find_twins() {
        struct Ends {
            std::uint32_t low, high, chain;
            bool backwards;
            auto operator<=>(const Ends&) const = default;
        };
        std::vector<Ends> found;
        for (std::uint32_t k = 0; k < gone_.size(); ++k) {
            if (gone_[k] != 0 || chain(k).closed || length_of(chain(k)) >= kLongestRound) continue;
            const std::uint32_t first = clusters_.find(chain(k).first_vertex);
            const std::uint32_t last = clusters_.find(chain(k).last_vertex);
            if (first == last) continue;
            found.push_back({std::min(first, last), std::max(first, last), k, last < first});
        }
        std::ranges::sort(found);
        const auto rank = [&](const Ends& ends) {
            const Chain& line = chain(ends.chain);
            return std::tuple(line.left == line.right, line.type, length_of(line));
        };
        for (std::size_t k = 0; k < found.size(); ++k) {
            for (std::size_t n = k + 1; n < found.size(); ++n) {
                const Ends& a = found[k];
                const Ends& b = found[n];
                if (a.low != b.low || a.high != b.high) break;
                const Ends& lesser = rank(a) < rank(b) ? b : a;
                const Chain& line = chain(lesser.chain);
                if (gone_[a.chain] != 0 || gone_[b.chain] != 0 || line.left != line.right ||
                    chain(a.chain).hidden != chain(b.chain).hidden) {
                    continue;
                }
                if (is_slit_between(chain(a.chain), chain(b.chain), a.backwards != b.backwards)) {
                    gone_[lesser.chain] = 1;
                }
            }
        }
    }

    void mark_short_chains() {
        for (std::size_t k = 0; k < gone_.size(); ++k) {
            if (gone_[k] == 0) continue;
            const auto [first, last] = lines_.ways[k];
            for (Way way = first;; way = graph_.next_of_type(way)) {
                marked_[way >> 1U] = 1;
                merged_.push_back(clusters_.find(chain(k).first_vertex));
                if (way == last) break;
            }
        }
        std::ranges::sort(merged_);
        const auto [first, last] = std::ranges::unique(merged_);
        merged_.erase(first, last);
    }

    std::vector<ChainEnd> ends_at_clusters() {
        std::vector<ChainEnd> ends;
        for (std::uint32_t k = 0; k < gone_.size(); ++k) {
            if (gone_[k] != 0 || chain(k).closed) continue;
            for (const bool last : {false, true}) {
                const std::uint32_t cluster =
                    clusters_.find(last ? chain(k).last_vertex : chain(k).first_vertex);
                if (std::ranges::binary_search(merged_, cluster))
                    ends.push_back({cluster, k, last});
            }
        }
        std::ranges::stable_sort(ends, {}, &ChainEnd::cluster);
        return ends;
    }

    /// To where the lines point that meet there.
    void place_clusters() {
        const std::vector<ChainEnd> ends = ends_at_clusters();
        for (std::size_t begin = 0, end = 0; begin < ends.size(); begin = end) {
            std::vector<Parabola> lines;
            Vec2d sum;
            for (; end < ends.size() && ends[end].cluster == ends[begin].cluster; ++end) {
                const auto& [cluster, k, last] = ends[end];
                sum = sum + to_double(last ? chain(k).points.back() : chain(k).points.front());
                if (const auto line = approach(chain(k), last)) lines.push_back(*line);
            }
            const Vec2d middle = sum * (1.0 / static_cast<double>(end - begin));
            const Vec2f place =
                to_float(clusters_.clamp(ends[begin].cluster, meeting_point(lines, middle)));
            for (std::size_t k = begin; k < end; ++k) lead(ends[k], place);
        }
    }

    /// Moves the end of a chain. What it had within so short a way of the end goes, or the line
    /// would turn to reach it.
    void lead(const ChainEnd& end, Vec2f place) {
        const auto [first, last] = lines_.ways[end.chain];
        Way way = end.last ? opposite(last) : first;
        const Way stop = end.last ? opposite(first) : last;
        const Vec2f from =
            end.last ? chain(end.chain).points.back() : chain(end.chain).points.front();
        const double moved =
            std::min(static_cast<double>(length(place - from)), 0.4 * length_of(chain(end.chain)));
        places_[graph_.start(way)] = place;
        double along = 0.0;
        for (; way != stop; way = graph_.next_of_type(way)) {
            along += static_cast<double>(
                length(graph_.start_point(opposite(way)) - graph_.start_point(way)));
            if (along >= moved) break;
            marked_[way >> 1U] = 1;
            places_[graph_.finish(way)] = place;
        }
    }

    SegmentGraph& graph_;
    const ChainedWays& lines_;
    std::vector<Vec2f> places_;  ///< of vertices
    VertexClusters clusters_;
    std::vector<std::uint8_t> gone_;     ///< a chain: shrinks to a point
    std::vector<std::uint8_t> marked_;   ///< a segment: goes
    std::vector<std::uint32_t> merged_;  ///< clusters that chains have shrunk to; sorted
};

}  // namespace

bool merge_near_junctions(SegmentGraph& graph, const ChainedWays& lines) {
    return JunctionMerger(graph, lines).run();
}

}  // namespace ink
