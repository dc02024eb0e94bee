#include "lines/corners.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "lines/knots.h"
#include "lines/path_points.h"

namespace ink {

namespace {

/// A chain has a corner at its point `after`, or at `point`, between that and the next one.
struct Split {
    std::uint32_t chain;
    std::size_t after;
    std::optional<Vec2f> point;
};

/// No part is shorter than this, in pixels: what turns so soon again is a crumb of a line.
constexpr double kShortestPart = 8.0;

class CornerFinder {
  public:
    /// Those within chains, not where two of them meet.
    void find(const ChainGraph& graph, const Path& path, std::vector<Split>& found) {
        points_.take(graph, path);
        line_.take(points_.points, path.closed, points_.cuts);
        for (const KnotLine::Corner& corner :
             line_.corners(kCornerDeg * std::numbers::pi / 180.0)) {
            const auto& cuts = points_.cuts;
            const auto step = static_cast<std::size_t>(
                std::ranges::upper_bound(cuts, corner.after) - cuts.begin() - 1);
            const std::uint32_t index = path.steps[step].chain;
            const Chain& chain = graph.chains[index];
            std::size_t after = corner.after - cuts[step];
            if (after == 0 && !chain.closed) continue;
            if (path.steps[step].reversed) {
                after = chain.points.size() - (corner.point ? 2 : 1) - after;
            }
            found.push_back({index, after,
                             corner.point ? std::optional(to_float(*corner.point)) : std::nullopt});
        }
    }

  private:
    PathPoints points_;
    KnotLine line_;
};

/// Sorted along each chain.
std::vector<Split> find_corners(const ChainGraph& graph, int threads) {
    const int count = threads > 0 ? threads : hardware_threads();
    struct Worker {
        CornerFinder finder;
        std::vector<Split> found;
    };
    std::vector<Worker> workers(static_cast<std::size_t>(count));
    constexpr std::size_t kGrain = 32;  // paths; most are short
    parallel_for((graph.paths.size() + kGrain - 1) / kGrain, count,
                 [&](std::size_t group, std::size_t index) {
                     Worker& worker = workers[index];
                     const std::size_t end = std::min(graph.paths.size(), (group + 1) * kGrain);
                     for (std::size_t p = group * kGrain; p < end; ++p) {
                         worker.finder.find(graph, graph.paths[p], worker.found);
                     }
                 });
    std::vector<Split> splits;
    for (const Worker& worker : workers) {
        splits.insert(splits.end(), worker.found.begin(), worker.found.end());
    }
    std::ranges::sort(splits, {}, [](const Split& s) { return std::pair(s.chain, s.after); });
    return splits;
}

/// Calls `change` for every list of one value a point.
template <class Change>
void for_each_list(Chain& chain, const Change& change) {
    change(chain.points);
    change(chain.t);
    change(chain.strengths);
    if (!chain.width_scales.empty()) change(chain.width_scales);
}

/// Those that are not too near to the one before, or to an end of the chain.
std::vector<Split> far_apart(const Chain& chain, std::span<const Split> splits) {
    std::vector<Split> kept;
    if (splits.empty()) return kept;
    std::vector<double> along{0.0};
    for (std::size_t k = 1; k < chain.points.size(); ++k) {
        along.push_back(along.back() +
                        static_cast<double>(length(chain.points[k] - chain.points[k - 1])));
    }
    const double first = along[splits.front().after];
    double last = chain.closed ? first - kShortestPart : 0.0;
    const double end = chain.closed ? first + length_of(chain) : along.back();
    for (const Split& split : splits) {
        const double at = along[split.after];
        const bool is_first = chain.closed && kept.empty();
        if (at - last < kShortestPart || (!is_first && end - at < kShortestPart)) continue;
        kept.push_back(split);
        last = at;
    }
    return kept;
}

/// Makes points of all corners; returns their indices.
std::vector<std::size_t> add_points(Chain& chain, std::span<const Split> splits) {
    std::vector<std::size_t> corners;
    std::size_t added = 0;
    for (const Split& split : splits) {
        const std::size_t at = split.after + added;
        if (!split.point) {
            corners.push_back(at);
            continue;
        }
        for_each_list(chain, [at](auto& values) {
            const auto mean = (values[at] + values[(at + 1) % values.size()]) * 0.5F;
            values.insert(values.begin() + static_cast<std::ptrdiff_t>(at) + 1, mean);
        });
        chain.points[at + 1] = *split.point;
        corners.push_back(at + 1);
        ++added;
    }
    return corners;
}

/// Makes a closed chain start at its first corner, and, if there are more, end there.
void start_at_corner(Chain& chain, std::vector<std::size_t>& corners) {
    const std::size_t first = corners.front();
    for_each_list(chain, [first](auto& values) {
        std::ranges::rotate(values, values.begin() + static_cast<std::ptrdiff_t>(first));
    });
    for (std::size_t& corner : corners) corner -= first;
    if (corners.size() == 1) return;
    for_each_list(chain, [](auto& values) { values.push_back(values.front()); });
    chain.closed = false;
    corners.erase(corners.begin());
}

Chain part_of(const Chain& chain, std::size_t from, std::size_t to) {
    Chain part = chain;
    for_each_list(part, [=](auto& values) {
        values.erase(values.begin() + static_cast<std::ptrdiff_t>(to) + 1, values.end());
        values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(from));
    });
    double strength = 0.0;
    double total = 0.0;
    for (std::size_t k = 0; k + 1 < part.points.size(); ++k) {
        const auto size = static_cast<double>(length(part.points[k + 1] - part.points[k]));
        strength += size * 0.5 * static_cast<double>(part.strengths[k] + part.strengths[k + 1]);
        total += size;
    }
    if (total > 0.0) part.strength = static_cast<float>(strength / total);
    return part;
}

/// The parts of a chain from corner to corner, at least one. New vertices are numbered from `next`.
std::vector<Chain> split(Chain chain, std::span<const Split> splits, std::uint32_t& next) {
    std::vector<Chain> parts;
    const Chain::Whole whole{length_of(chain), chain.closed};
    std::vector<std::size_t> corners = add_points(chain, splits);
    if (chain.closed) {
        start_at_corner(chain, corners);
        if (chain.closed) {
            parts.push_back(std::move(chain));
            return parts;
        }
        chain.first_vertex = chain.last_vertex = next++;
    }
    corners.push_back(chain.points.size() - 1);
    std::size_t from = 0;
    std::uint32_t vertex = chain.first_vertex;
    for (const std::size_t to : corners) {
        Chain& part = parts.emplace_back(part_of(chain, from, to));
        part.first_vertex = vertex;
        if (to != corners.back()) part.last_vertex = vertex = next++;
        part.whole = whole;
        from = to;
    }
    return parts;
}

/// Replaces each chain of a path by its parts.
Path along_parts(const Path& path, std::span<const std::uint32_t> first_part) {
    Path result{{}, path.closed};
    for (const PathStep& step : path.steps) {
        const std::uint32_t first = first_part[step.chain];
        const std::uint32_t count = first_part[step.chain + 1] - first;
        for (std::uint32_t n = 0; n < count; ++n) {
            const std::uint32_t part = step.reversed ? first + count - 1 - n : first + n;
            result.steps.push_back({part, step.reversed, n > 0});
        }
    }
    return result;
}

std::uint32_t vertex_after_all(const ChainGraph& graph) {
    std::uint32_t next = 0;
    for (const Chain& chain : graph.chains) {
        next = std::max({next, chain.first_vertex + 1, chain.last_vertex + 1});
    }
    return next;
}

}  // namespace

void split_at_corners(ChainGraph& graph, int threads) {
    const std::vector<Split> splits = find_corners(graph, threads);
    std::uint32_t next_vertex = vertex_after_all(graph);
    std::vector<Chain> chains;
    chains.reserve(graph.chains.size() + splits.size());
    std::vector<std::uint32_t> first_part;
    std::vector<std::uint8_t> starts_at_corner(graph.chains.size(), 0);
    auto begin = splits.begin();
    for (std::uint32_t k = 0; k < graph.chains.size(); ++k) {
        first_part.push_back(static_cast<std::uint32_t>(chains.size()));
        Chain& chain = graph.chains[k];
        const auto end =
            std::find_if(begin, splits.end(), [k](const Split& s) { return s.chain != k; });
        const std::vector<Split> kept = far_apart(chain, {begin, end});
        begin = end;
        if (kept.empty()) {
            chains.push_back(std::move(chain));
            continue;
        }
        starts_at_corner[k] = chain.closed ? 1 : 0;
        std::ranges::move(split(std::move(chain), kept, next_vertex), std::back_inserter(chains));
    }
    first_part.push_back(static_cast<std::uint32_t>(chains.size()));
    for (Path& path : graph.paths) {
        const bool at_corner = starts_at_corner[path.steps.front().chain] != 0;
        path = along_parts(path, first_part);
        if (at_corner) path.steps.front().at_corner = true;
    }
    graph.chains = std::move(chains);
}

}  // namespace ink
