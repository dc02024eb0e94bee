#include "vector/tone_lines.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

#include "lines/tones.h"

namespace ink {

namespace {

/// Spots of light or shade this small, by the length round them in pixels, are left out.
constexpr double kLeastSpot = 16.0;

bool is_border_of_tones(const Chain& chain) {
    return std::ranges::all_of(chain.strengths, [](float strength) { return strength == 0.0F; });
}

struct Line {
    Chain chain;
    Curve curve;
    bool at_corner = false;  ///< its path turns where it begins
};

Line backwards(Line line) {
    Chain& chain = line.chain;
    std::swap(chain.left, chain.right);
    std::swap(chain.first_vertex, chain.last_vertex);
    chain.left_in_front = !chain.left_in_front;
    std::ranges::reverse(chain.points);
    std::ranges::reverse(chain.t);
    std::ranges::reverse(chain.strengths);
    std::ranges::reverse(chain.width_scales);
    line.curve = reversed(line.curve);
    return line;
}

/// How many ends of lines are at each vertex, borders of tones not counted.
std::vector<std::uint32_t> count_ends(const ChainGraph& graph) {
    std::vector<std::uint32_t> ends;
    for (const Chain& chain : graph.chains) {
        if (chain.closed || is_border_of_tones(chain)) continue;
        for (const std::uint32_t vertex : {chain.first_vertex, chain.last_vertex}) {
            if (vertex >= ends.size()) ends.resize(vertex + 1);
            ++ends[vertex];
        }
    }
    return ends;
}

/// Whether a line goes on as the next one, and neither a third one nor a corner is between them.
bool goes_on(const Line& line, const Line& next, std::span<const std::uint32_t> ends) {
    const Chain& a = line.chain;
    const Chain& b = next.chain;
    return !next.at_corner && a.type == b.type && a.left == b.left && a.right == b.right &&
           a.last_vertex < ends.size() && ends[a.last_vertex] == 2;
}

/// Adds a line that begins where the other one ends.
void append(Line& line, const Line& next) {
    const auto add = [](auto& to, const auto& from) {
        to.insert(to.end(), from.begin() + 1, from.end());
    };
    const double size = length_of(line.chain);
    const double more = length_of(next.chain);
    if (size + more > 0.0) {
        line.chain.strength = static_cast<float>((size * static_cast<double>(line.chain.strength) +
                                                  more * static_cast<double>(next.chain.strength)) /
                                                 (size + more));
    }
    if (more > size) line.chain.left_in_front = next.chain.left_in_front;
    add(line.chain.points, next.chain.points);
    add(line.chain.t, next.chain.t);
    add(line.chain.strengths, next.chain.strengths);
    add(line.chain.width_scales, next.chain.width_scales);
    line.chain.last_vertex = next.chain.last_vertex;
    line.curve.pieces.insert(line.curve.pieces.end(), next.curve.pieces.begin(),
                             next.curve.pieces.end());
}

/// Of an open line that comes back to its start.
void close(Line& line) {
    line.chain.closed = true;
    line.chain.points.pop_back();
    line.chain.t.pop_back();
    line.chain.strengths.pop_back();
    line.chain.width_scales.pop_back();
}

/// The lines of a path, one after the other in its direction.
std::vector<Line> lines_along(CurveGraph& lines, const Path& path) {
    std::vector<Line> along;
    for (const PathStep& step : path.steps) {
        Line line{std::move(lines.graph.chains[step.chain]), std::move(lines.curves[step.chain]),
                  step.at_corner};
        line.chain.left = Tones::geometry(line.chain.left);
        line.chain.right = Tones::geometry(line.chain.right);
        along.push_back(step.reversed ? backwards(std::move(line)) : std::move(line));
    }
    return along;
}

std::vector<Line> joined(std::vector<Line> along, bool closed,
                         std::span<const std::uint32_t> ends) {
    if (along.front().chain.closed) return along;
    if (closed) {
        // It may begin in the middle of a line.
        const auto begins = [&](std::size_t k) {
            return !goes_on(along[k == 0 ? along.size() - 1 : k - 1], along[k], ends);
        };
        std::size_t first = 0;
        while (first < along.size() && !begins(first)) ++first;
        closed = first == along.size();
        if (!closed)
            std::rotate(along.begin(), along.begin() + static_cast<std::ptrdiff_t>(first),
                        along.end());
    }
    std::vector<Line> joined;
    for (Line& line : along) {
        if (!joined.empty() && goes_on(joined.back(), line, ends)) {
            append(joined.back(), line);
        } else {
            joined.push_back(std::move(line));
        }
    }
    if (closed) close(joined.front());
    return joined;
}

}  // namespace

void drop_spots(CurveGraph& lines) {
    for (std::size_t k = 0; k < lines.graph.chains.size(); ++k) {
        const Chain& chain = lines.graph.chains[k];
        if (!is_border_of_tones(chain) || !(chain.closed || chain.whole.closed)) continue;
        if (std::max(length_of(chain), chain.whole.length) < kLeastSpot) {
            lines.curves[k].pieces.clear();
        }
    }
}

void name_tones(std::vector<Region>& regions) {
    for (Region& region : regions) {
        region.tone = Tones::shaded(region.id) ? Region::Tone::shade : Region::Tone::light;
        region.id = Tones::geometry(region.id);
    }
}

void name_tones(CurveGraph& lines) {
    CurveGraph named;
    const std::vector<std::uint32_t> ends = count_ends(lines.graph);
    for (const Path& path : lines.graph.paths) {
        for (Line& line : joined(lines_along(lines, path), path.closed, ends)) {
            if (is_border_of_tones(line.chain)) continue;
            named.graph.chains.push_back(std::move(line.chain));
            named.curves.push_back(std::move(line.curve));
        }
    }
    lines = std::move(named);
}

}  // namespace ink
