#include "lines/steady_types.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace ink {

namespace {

constexpr std::uint32_t kNone = SegmentGraph::kNone;

/// Where a surface bends away just before it meets another, the type is decided by little and
/// crossings in turn come out one way and the other. A stretch shorter than this, in pixels, takes
/// the type of what it lies in or next to.
constexpr float kShortestStretch = 5.0F;

struct Stretch {
    LineType type;
    std::size_t end;  ///< of its ways in the run
    float length;
};

/// The type changes somewhere along a piece whose ends differ: half of it goes to the neighbour, so
/// that lengths hang on the lattice by as little as can be.
void share_pieces_between(const SegmentGraph& graph, std::span<const Way> run,
                          std::vector<Stretch>& stretches) {
    for (std::size_t k = 0; k + 1 < stretches.size(); ++k) {
        const auto share = [&](Way way, bool ahead, Stretch& from, Stretch& to) {
            const Segment& piece = graph.segment(way);
            if (graph.back(way) == ahead || piece.type_at_b != to.type) return;
            const float half = 0.5F * length(piece.b - piece.a);
            from.length -= half;
            to.length += half;
        };
        share(run[stretches[k].end - 1], true, stretches[k], stretches[k + 1]);
        share(run[stretches[k].end], false, stretches[k + 1], stretches[k]);
    }
}

std::vector<Stretch> stretches_of(const SegmentGraph& graph, std::span<const Way> run) {
    std::vector<Stretch> stretches;
    for (std::size_t k = 0; k < run.size(); ++k) {
        const Segment& piece = graph.segment(run[k]);
        if (stretches.empty() || stretches.back().type != piece.type) {
            stretches.push_back({piece.type, 0, 0.0F});
        }
        stretches.back().end = k + 1;
        stretches.back().length += length(piece.b - piece.a);
    }
    share_pieces_between(graph, run, stretches);
    return stretches;
}

/// A line from one of its ends to the other, or once round.
void steady_run(SegmentGraph& graph, std::span<const Way> run) {
    std::vector<Stretch> stretches = stretches_of(graph, run);
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
        for (; k < stretch.end; ++k) graph.set_type(run[k], stretch.type);
    }
}

}  // namespace

void steady_types(SegmentGraph& graph) {
    std::vector<std::uint8_t> seen(graph.size(), 0);
    std::vector<Way> run;
    for (const bool open : {true, false}) {
        for (Way first = 0; first < graph.ways(); ++first) {
            if (seen[first >> 1U] != 0 || (open && graph.only_next(opposite(first)) != kNone))
                continue;
            run.clear();
            for (Way way = first; way != kNone && seen[way >> 1U] == 0;
                 way = graph.only_next(way)) {
                seen[way >> 1U] = 1;
                run.push_back(way);
            }
            steady_run(graph, run);
        }
    }
}

}  // namespace ink
