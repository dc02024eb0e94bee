#include "lines/chain.h"

#include <utility>

#include "lines/steady_types.h"

namespace ink {

namespace {

constexpr std::uint32_t kNone = SegmentGraph::kNone;

/// Goes along the ways of a graph: first into chains, then from chain to chain into paths.
class Chainer {
  public:
    explicit Chainer(const SegmentGraph& graph) : graph_(graph) {}

    ChainedWays run() {
        make_chains();
        make_paths();
        return {std::move(result_), std::move(chain_ways_)};
    }

  private:
    void make_chain(Way first);
    void make_chains();
    void make_path(PathStep first);
    void make_paths();
    PathStep next_step(PathStep step) const;

    const SegmentGraph& graph_;
    ChainGraph result_;
    std::vector<std::uint8_t> used_;              ///< a segment: in a chain
    std::vector<std::array<Way, 2>> chain_ways_;  ///< a chain: its first and last way
    std::vector<PathStep> step_of_way_;           ///< a way at the start of a chain run along it
    std::vector<std::uint8_t> chain_used_;
};

void Chainer::make_chain(Way first) {
    Chain chain;
    chain.type = graph_.segment(first).type;
    chain.hidden = graph_.segment(first).hidden;
    chain.level = graph_.segment(first).level;
    chain.left = graph_.left(first);
    chain.right = graph_.right(first);
    chain.first_vertex = graph_.start(first);
    double strength = 0.0;
    double total = 0.0;
    int in_front = 0;
    Way last = first;
    for (Way way = first; way != kNone && used_[way >> 1U] == 0; way = graph_.next_of_type(way)) {
        const Segment& piece = graph_.segment(way);
        used_[way >> 1U] = 1;
        const Segment& before = chain.t.empty() ? piece : graph_.segment(last);
        chain.points.push_back(graph_.start_point(way));
        chain.t.push_back(0.5F * (before.t + piece.t));
        chain.strengths.push_back(0.5F * (before.strength + piece.strength));
        chain.width_scales.push_back(0.5F * (before.width_scale + piece.width_scale));
        const float size = length(piece.b - piece.a);
        strength += static_cast<double>(size) * static_cast<double>(piece.strength);
        total += static_cast<double>(size);
        in_front += graph_.left_in_front(way) ? 1 : -1;
        last = way;
    }
    chain.last_vertex = graph_.finish(last);
    chain.closed = chain.first_vertex == chain.last_vertex && graph_.next_of_type(last) == first;
    if (!chain.closed) {
        chain.points.push_back(graph_.start_point(opposite(last)));
        chain.t.push_back(graph_.segment(last).t);
        chain.strengths.push_back(graph_.segment(last).strength);
        chain.width_scales.push_back(graph_.segment(last).width_scale);
    }
    chain.strength = static_cast<float>(strength / total);
    chain.left_in_front = in_front > 0;

    const auto index = static_cast<std::uint32_t>(result_.chains.size());
    step_of_way_[first] = {index, false};
    step_of_way_[opposite(last)] = {index, true};
    chain_ways_.push_back({first, last});
    result_.chains.push_back(std::move(chain));
}

void Chainer::make_chains() {
    used_.assign(graph_.size(), 0);
    step_of_way_.assign(graph_.ways(), {kNone, false});
    for (Way way = 0; way < graph_.ways(); ++way) {
        if (used_[way >> 1U] == 0 && graph_.next_of_type(opposite(way)) == kNone) make_chain(way);
    }
    for (Way way = 0; way < graph_.ways(); way += 2) {
        if (used_[way >> 1U] == 0) make_chain(way);
    }
}

/// The chain that goes on where a step ends, or kNone.
PathStep Chainer::next_step(PathStep step) const {
    const auto [first, last] = chain_ways_[step.chain];
    const Way arriving = step.reversed ? opposite(first) : last;
    const Way next = result_.chains[step.chain].closed ? kNone : graph_.next_for_the_eye(arriving);
    return next == kNone ? PathStep{kNone, false} : step_of_way_[next];
}

void Chainer::make_path(PathStep first) {
    Path path;
    PathStep step = first;
    while (step.chain != kNone && chain_used_[step.chain] == 0) {
        chain_used_[step.chain] = 1;
        path.steps.push_back(step);
        step = next_step(step);
    }
    path.closed = result_.chains[first.chain].closed ||
                  (step.chain == first.chain && step.reversed == first.reversed);
    result_.paths.push_back(std::move(path));
}

void Chainer::make_paths() {
    const auto count = static_cast<std::uint32_t>(result_.chains.size());
    chain_used_.assign(count, 0);
    for (const bool reversed : {false, true}) {
        for (std::uint32_t k = 0; k < count; ++k) {
            const bool begins = next_step({k, !reversed}).chain == kNone;
            if (chain_used_[k] == 0 && begins) make_path({k, reversed});
        }
    }
    for (std::uint32_t k = 0; k < count; ++k) {
        if (chain_used_[k] == 0) make_path({k, false});
    }
}

}  // namespace

ChainGraph chain_segments(std::span<const Segment> segments, float spacing) {
    SegmentGraph graph(segments, spacing);
    steady_types(graph);
    return chain_ways(graph).graph;
}

ChainedWays chain_ways(const SegmentGraph& graph) { return Chainer(graph).run(); }

double length_of(const Chain& chain) {
    double total = 0.0;
    for (std::size_t k = 0; k + 1 < chain.points.size(); ++k) {
        total += static_cast<double>(length(chain.points[k + 1] - chain.points[k]));
    }
    if (chain.closed) {
        total += static_cast<double>(length(chain.points.front() - chain.points.back()));
    }
    return total;
}

}  // namespace ink
