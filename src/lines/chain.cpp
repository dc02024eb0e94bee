#include "lines/chain.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

namespace ink {

namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFFU;

float distance(Vec2f a, Vec2f b) { return std::hypot(b.x - a.x, b.y - a.y); }

/// Numbers points: bitwise equal ones alike, in the order of their first appearance.
class VertexTable {
  public:
    explicit VertexTable(std::size_t most)
        : slots_(std::bit_ceil(2 * most + 1), kNone), mask_(slots_.size() - 1) {}

    std::uint32_t number(Vec2f point) {
        const std::uint64_t key = bits(point);
        for (std::uint64_t slot = scatter(key) & mask_;; slot = (slot + 1) & mask_) {
            if (slots_[slot] == kNone) {
                slots_[slot] = static_cast<std::uint32_t>(keys_.size());
                keys_.push_back(key);
            }
            if (keys_[slots_[slot]] == key) return slots_[slot];
        }
    }
    std::size_t size() const { return keys_.size(); }

  private:
    static std::uint64_t bits(Vec2f point) {
        // Adding zero turns -0 into +0.
        const auto x = std::bit_cast<std::uint32_t>(point.x + 0.0F);
        const auto y = std::bit_cast<std::uint32_t>(point.y + 0.0F);
        return static_cast<std::uint64_t>(y) << 32U | x;
    }
    /// The finalizer of splitmix64 (Steele, Lea and Flood 2014).
    static std::uint64_t scatter(std::uint64_t x) {
        x = (x ^ x >> 30U) * 0xBF58476D1CE4E5B9U;
        x = (x ^ x >> 27U) * 0x94D049BB133111EBU;
        return x ^ x >> 31U;
    }

    std::vector<std::uint32_t> slots_;
    std::uint64_t mask_;
    std::vector<std::uint64_t> keys_;
};

/// A segment and one of the two ways along it: twice the segment's index, plus one for the way
/// back.
using Way = std::uint32_t;

constexpr Way opposite(Way way) { return way ^ 1U; }

class Chainer {
  public:
    Chainer(std::span<const Segment> segments, float spacing);

    ChainGraph run();

  private:
    void sort(float spacing);
    void split_at_ends_within(float spacing);
    void number_ends();

    const Segment& segment(Way way) const { return segments_[way >> 1U]; }
    bool back(Way way) const { return (way & 1U) != 0; }
    std::uint32_t start(Way way) const { return ends_[way]; }
    std::uint32_t finish(Way way) const { return ends_[opposite(way)]; }
    Vec2f start_point(Way way) const { return back(way) ? segment(way).b : segment(way).a; }
    GeometryId left(Way way) const { return back(way) ? segment(way).right : segment(way).left; }
    GeometryId right(Way way) const { return back(way) ? segment(way).left : segment(way).right; }
    bool left_in_front(Way way) const { return segment(way).left_in_front != back(way); }
    /// Ways that leave a vertex.
    std::span<const Way> leaving(std::uint32_t vertex) const {
        return {leaving_.data() + first_leaving_[vertex],
                leaving_.data() + first_leaving_[vertex + 1]};
    }
    bool same_sides(Way way, Way next) const {
        return left(way) == left(next) && right(way) == right(next);
    }
    bool same_line(Way way, Way next) const {
        return segment(way).type == segment(next).type && same_sides(way, next);
    }
    Way only_next(Way way) const;
    void steady_types();
    void steady_run(std::span<const Way> run);
    Way next_in_chain(Way way) const;
    Way next_in_path(Way way) const;

    void make_chain(Way first, ChainGraph& graph);
    void make_chains(ChainGraph& graph);
    void make_path(PathStep first, ChainGraph& graph);
    void make_paths(ChainGraph& graph);
    PathStep next_step(const ChainGraph& graph, PathStep step) const;

    std::vector<Segment> segments_;
    std::vector<std::uint32_t> ends_;  ///< vertex at which each way starts
    std::vector<std::uint32_t> first_leaving_;
    std::vector<Way> leaving_;
    std::vector<std::uint8_t> used_;              ///< a segment: in a chain
    std::vector<std::array<Way, 2>> chain_ways_;  ///< a chain: its first and last way
    std::vector<PathStep> step_of_way_;           ///< a way at the start of a chain run along it
    std::vector<std::uint8_t> chain_used_;
};

Chainer::Chainer(std::span<const Segment> segments, float spacing)
    : segments_(segments.begin(), segments.end()) {
    sort(spacing);
    split_at_ends_within(spacing);
    number_ends();
}

using Cell = std::pair<float, float>;

/// Row and column of the lattice cell that a segment lies in.
Cell cell_of(const Segment& segment, float spacing) {
    const Vec2f middle = (segment.a + segment.b) * (0.5F / spacing);
    return {std::floor(middle.y - 0.5F), std::floor(middle.x - 0.5F)};
}

/// By cells, and within them by all that tells segments apart.
void Chainer::sort(float spacing) {
    const auto key = [](const Segment& s) {
        return std::tuple(s.a.y, s.a.x, s.b.y, s.b.x, s.type, s.left, s.right, s.strength, s.t);
    };
    struct Entry {
        Cell cell;
        std::uint32_t index;
    };
    std::vector<Entry> order;
    order.reserve(segments_.size());
    for (std::uint32_t k = 0; k < segments_.size(); ++k) {
        order.push_back({cell_of(segments_[k], spacing), k});
    }
    std::ranges::sort(order, [&](const Entry& x, const Entry& y) {
        if (x.cell != y.cell) return x.cell < y.cell;
        return key(segments_[x.index]) < key(segments_[y.index]);
    });
    std::vector<Segment> sorted;
    sorted.reserve(order.size());
    for (const Entry& entry : order) sorted.push_back(segments_[entry.index]);
    segments_ = std::move(sorted);
}

/// What the line is beyond the place where another one ends on it.
void take_sides_at_b(Segment& line) {
    line.type = line.type_at_b;
    line.left = line.left_at_b;
    line.right = line.right_at_b;
    line.left_in_front = line.left_in_front_at_b;
}

/// Cuts the line, at a place on it, into two that share that vertex; nothing if it is an end.
std::optional<Segment> cut(Segment& line, Vec2f point) {
    if (line.a == point) take_sides_at_b(line);
    if (line.a == point || line.b == point) return std::nullopt;
    Segment rest = line;
    take_sides_at_b(rest);
    line.b = rest.a = point;
    line.type_at_b = line.type;
    line.left_at_b = line.left;
    line.right_at_b = line.right;
    line.left_in_front_at_b = line.left_in_front;
    return rest;
}

/// Where a line ends on another one of its cell, cuts that one.
void Chainer::split_at_ends_within(float spacing) {
    constexpr float kOnLine = 1e-3F;  // of the spacing: rounding, with much to spare
    std::vector<Segment> split;
    split.reserve(segments_.size());
    for (std::size_t begin = 0, end = 0; begin < segments_.size(); begin = end) {
        const Cell cell = cell_of(segments_[begin], spacing);
        const std::size_t first = split.size();
        while (end < segments_.size() && cell_of(segments_[end], spacing) == cell) {
            split.push_back(segments_[end++]);
        }
        for (std::size_t k = begin; k < end; ++k) {
            if (segments_[k].spans_cell) continue;
            const Vec2f point = segments_[k].b;
            const auto passes = [&](const Segment& line) {
                const float around = distance(line.a, point) + distance(point, line.b);
                return line.spans_cell && around <= distance(line.a, line.b) + kOnLine * spacing;
            };
            const auto line = std::find_if(split.begin() + static_cast<std::ptrdiff_t>(first),
                                           split.end(), passes);
            if (line == split.end()) continue;
            if (const auto rest = cut(*line, point)) split.push_back(*rest);
        }
    }
    std::erase_if(split, [](const Segment& segment) { return segment.a == segment.b; });
    segments_ = std::move(split);
}

void Chainer::number_ends() {
    VertexTable table(2 * segments_.size());
    ends_.reserve(2 * segments_.size());
    for (const Segment& segment : segments_) {
        ends_.push_back(table.number(segment.a));
        ends_.push_back(table.number(segment.b));
    }
    first_leaving_.assign(table.size() + 1, 0);
    for (const std::uint32_t vertex : ends_) ++first_leaving_[vertex + 1];
    for (std::size_t v = 0; v < table.size(); ++v) first_leaving_[v + 1] += first_leaving_[v];
    leaving_.resize(ends_.size());
    std::vector<std::uint32_t> next(first_leaving_.begin(), first_leaving_.end() - 1);
    for (Way way = 0; way < ends_.size(); ++way) leaving_[next[ends_[way]]++] = way;
}

/// The way on where nothing else meets the line, or kNone.
Way Chainer::only_next(Way way) const {
    const auto ways = leaving(finish(way));
    if (ways.size() != 2) return kNone;
    const Way next = ways[0] == opposite(way) ? ways[1] : ways[0];
    return same_sides(way, next) ? next : kNone;
}

/// The way on that belongs to the same chain, or kNone.
Way Chainer::next_in_chain(Way way) const {
    const Way next = only_next(way);
    return next != kNone && same_line(way, next) ? next : kNone;
}

/// Where a surface bends away just before it meets another, the type is decided by little and
/// crossings in turn come out one way and the other. A stretch shorter than this, in pixels, takes
/// the type of what it lies in or next to.
constexpr float kShortestStretch = 5.0F;

/// Gives the short stretches of one type along a line, from junction to junction, the type of the
/// longer one beside them.
void Chainer::steady_types() {
    std::vector<std::uint8_t> seen(segments_.size(), 0);
    std::vector<Way> run;
    for (const bool open : {true, false}) {
        for (Way first = 0; first < ends_.size(); ++first) {
            if (seen[first >> 1U] != 0 || (open && only_next(opposite(first)) != kNone)) continue;
            run.clear();
            for (Way way = first; way != kNone && seen[way >> 1U] == 0; way = only_next(way)) {
                seen[way >> 1U] = 1;
                run.push_back(way);
            }
            steady_run(run);
        }
    }
}

void Chainer::steady_run(std::span<const Way> run) {
    struct Stretch {
        LineType type;
        std::size_t end;  ///< of its ways in the run
        float length;
    };
    std::vector<Stretch> stretches;
    for (std::size_t k = 0; k < run.size(); ++k) {
        const Segment& piece = segment(run[k]);
        if (stretches.empty() || stretches.back().type != piece.type) {
            stretches.push_back({piece.type, 0, 0.0F});
        }
        stretches.back().end = k + 1;
        stretches.back().length += distance(piece.a, piece.b);
    }
    for (std::size_t begin = 0, end = 0; begin < stretches.size(); begin = end + 1) {
        const auto is_short = [&](std::size_t k) {
            return k < stretches.size() && stretches[k].length < kShortestStretch;
        };
        for (end = begin; is_short(end); ++end) {
        }
        // Several short ones in turn: between stretches begin - 1 and end, if there are such.
        if (begin == 0 && end == stretches.size()) {
            const auto longest = std::ranges::max_element(stretches, {}, &Stretch::length);
            const LineType type = longest->type;
            for (Stretch& stretch : stretches) stretch.type = type;
        } else {
            const bool from_next =
                begin == 0 ||
                (end < stretches.size() && stretches[end].length > stretches[begin - 1].length);
            const LineType type = stretches[from_next ? end : begin - 1].type;
            for (std::size_t k = begin; k < end; ++k) stretches[k].type = type;
        }
    }
    std::size_t k = 0;
    for (const Stretch& stretch : stretches) {
        for (; k < stretch.end; ++k) segments_[run[k] >> 1U].type = stretch.type;
    }
}

/// The way on that the eye takes: past the ends of other lines, and whatever the type is there.
Way Chainer::next_in_path(Way way) const {
    const auto ends_here = [&](Way leaving) {
        return back(leaving) && !segment(leaving).spans_cell;
    };
    if (ends_here(opposite(way))) return kNone;
    Way next = kNone;
    int others = 0;
    for (const Way candidate : leaving(finish(way))) {
        if (candidate == opposite(way) || ends_here(candidate)) continue;
        next = candidate;
        ++others;
    }
    return others == 1 ? next : kNone;
}

void Chainer::make_chain(Way first, ChainGraph& graph) {
    Chain chain;
    chain.type = segment(first).type;
    chain.hidden = segment(first).hidden;
    chain.level = segment(first).level;
    chain.left = left(first);
    chain.right = right(first);
    chain.first_vertex = start(first);
    double strength = 0.0;
    double total = 0.0;
    int in_front = 0;
    Way last = first;
    for (Way way = first; way != kNone && used_[way >> 1U] == 0; way = next_in_chain(way)) {
        const Segment& piece = segment(way);
        used_[way >> 1U] = 1;
        const Segment& before = chain.t.empty() ? piece : segment(last);
        chain.points.push_back(start_point(way));
        chain.t.push_back(0.5F * (before.t + piece.t));
        chain.strengths.push_back(0.5F * (before.strength + piece.strength));
        const float size = distance(piece.a, piece.b);
        strength += static_cast<double>(size) * static_cast<double>(piece.strength);
        total += static_cast<double>(size);
        in_front += left_in_front(way) ? 1 : -1;
        last = way;
    }
    chain.last_vertex = finish(last);
    chain.closed = chain.first_vertex == chain.last_vertex && next_in_chain(last) == first;
    if (!chain.closed) {
        chain.points.push_back(start_point(opposite(last)));
        chain.t.push_back(segment(last).t);
        chain.strengths.push_back(segment(last).strength);
    }
    chain.strength = static_cast<float>(strength / total);
    chain.left_in_front = in_front > 0;

    const auto index = static_cast<std::uint32_t>(graph.chains.size());
    step_of_way_[first] = {index, false};
    step_of_way_[opposite(last)] = {index, true};
    chain_ways_.push_back({first, last});
    graph.chains.push_back(std::move(chain));
}

void Chainer::make_chains(ChainGraph& graph) {
    used_.assign(segments_.size(), 0);
    step_of_way_.assign(ends_.size(), {kNone, false});
    for (Way way = 0; way < ends_.size(); ++way) {
        if (used_[way >> 1U] == 0 && next_in_chain(opposite(way)) == kNone) make_chain(way, graph);
    }
    for (Way way = 0; way < ends_.size(); way += 2) {
        if (used_[way >> 1U] == 0) make_chain(way, graph);
    }
}

/// The chain that goes on where a step ends, or kNone.
PathStep Chainer::next_step(const ChainGraph& graph, PathStep step) const {
    const auto [first, last] = chain_ways_[step.chain];
    const Way arriving = step.reversed ? opposite(first) : last;
    const Way next = graph.chains[step.chain].closed ? kNone : next_in_path(arriving);
    return next == kNone ? PathStep{kNone, false} : step_of_way_[next];
}

void Chainer::make_path(PathStep first, ChainGraph& graph) {
    Path path;
    PathStep step = first;
    while (step.chain != kNone && chain_used_[step.chain] == 0) {
        chain_used_[step.chain] = 1;
        path.steps.push_back(step);
        step = next_step(graph, step);
    }
    path.closed = graph.chains[first.chain].closed ||
                  (step.chain == first.chain && step.reversed == first.reversed);
    graph.paths.push_back(std::move(path));
}

void Chainer::make_paths(ChainGraph& graph) {
    const auto count = static_cast<std::uint32_t>(graph.chains.size());
    chain_used_.assign(count, 0);
    for (const bool reversed : {false, true}) {
        for (std::uint32_t k = 0; k < count; ++k) {
            const bool begins = next_step(graph, {k, !reversed}).chain == kNone;
            if (chain_used_[k] == 0 && begins) make_path({k, reversed}, graph);
        }
    }
    for (std::uint32_t k = 0; k < count; ++k) {
        if (chain_used_[k] == 0) make_path({k, false}, graph);
    }
}

ChainGraph Chainer::run() {
    ChainGraph graph;
    steady_types();
    make_chains(graph);
    make_paths(graph);
    return graph;
}

}  // namespace

ChainGraph chain_segments(std::span<const Segment> segments, float spacing) {
    return Chainer(segments, spacing).run();
}

double length_of(const Chain& chain) {
    double total = 0.0;
    for (std::size_t k = 0; k + 1 < chain.points.size(); ++k) {
        total += static_cast<double>(distance(chain.points[k], chain.points[k + 1]));
    }
    if (chain.closed) {
        total += static_cast<double>(distance(chain.points.back(), chain.points.front()));
    }
    return total;
}

}  // namespace ink
