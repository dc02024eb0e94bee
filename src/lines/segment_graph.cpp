#include "lines/segment_graph.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

namespace ink {

namespace {

/// Numbers points: bitwise equal ones alike, in the order of their first appearance.
class VertexTable {
  public:
    explicit VertexTable(std::size_t most)
        : slots_(std::bit_ceil(2 * most + 1), kFree), mask_(slots_.size() - 1) {}

    std::uint32_t number(Vec2f point) {
        const std::uint64_t key = bits(point);
        for (std::uint64_t slot = scatter(key) & mask_;; slot = (slot + 1) & mask_) {
            if (slots_[slot] == kFree) {
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

    static constexpr std::uint32_t kFree = 0xFFFFFFFFU;

    std::vector<std::uint32_t> slots_;
    std::uint64_t mask_;
    std::vector<std::uint64_t> keys_;
};

using Cell = std::pair<float, float>;

/// Row and column of the lattice cell that a segment lies in.
Cell cell_of(const Segment& segment, float spacing) {
    const Vec2f middle = (segment.a + segment.b) * (0.5F / spacing);
    return {std::floor(middle.y - 0.5F), std::floor(middle.x - 0.5F)};
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

}  // namespace

SegmentGraph::SegmentGraph(std::span<const Segment> segments, float spacing)
    : segments_(segments.begin(), segments.end()) {
    sort(spacing);
    split_at_ends_within(spacing);
    number_ends();
}

/// By cells, and within them by all that tells segments apart.
void SegmentGraph::sort(float spacing) {
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

/// Where a line ends on another one of its cell, cuts that one.
void SegmentGraph::split_at_ends_within(float spacing) {
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
                const float around = length(point - line.a) + length(line.b - point);
                return line.spans_cell && around <= length(line.b - line.a) + kOnLine * spacing;
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

void SegmentGraph::number_ends() {
    VertexTable table(2 * segments_.size());
    ends_.clear();
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

std::vector<Vec2f> SegmentGraph::places() const {
    std::vector<Vec2f> places(first_leaving_.size() - 1);
    for (Way way = 0; way < ends_.size(); ++way) places[ends_[way]] = start_point(way);
    return places;
}

void SegmentGraph::reshape(std::span<const Vec2f> places, std::span<const std::uint8_t> marked) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < segments_.size(); ++k) {
        Segment segment = segments_[k];
        segment.a = places[ends_[2 * k]];
        segment.b = places[ends_[2 * k + 1]];
        if (marked[k] == 0 && segment.a != segment.b) segments_[kept++] = segment;
    }
    segments_.resize(kept);
    number_ends();
}

Way SegmentGraph::only_next(Way way) const {
    const auto ways = leaving(finish(way));
    if (ways.size() != 2) return kNone;
    const Way next = ways[0] == opposite(way) ? ways[1] : ways[0];
    return left(way) == left(next) && right(way) == right(next) ? next : kNone;
}

Way SegmentGraph::next_of_type(Way way) const {
    const Way next = only_next(way);
    return next != kNone && segment(way).type == segment(next).type ? next : kNone;
}

Way SegmentGraph::next_for_the_eye(Way way) const {
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

}  // namespace ink
