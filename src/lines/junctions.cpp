#include "lines/junctions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "lines/parabola.h"

namespace ink {

namespace {

/// One end of a chain.
struct ChainEnd {
    std::uint32_t vertex;
    std::uint32_t chain;
    bool last;
};

/// Point k of a chain, counted from one of its ends.
Vec2f point_from(const Chain& chain, bool last, std::size_t k) {
    return chain.points[last ? chain.points.size() - 1 - k : k];
}

/// Kept in the lattice cell on whose sides the lines enter it.
Vec2d keep_in_cell(Vec2d point, Vec2d inside, double spacing) {
    const auto keep = [&](double x, double in) {
        const double lower = (std::floor(in / spacing - 0.5) + 0.5) * spacing;
        return std::clamp(x, lower, lower + spacing);
    };
    return {keep(point.x, inside.x), keep(point.y, inside.y)};
}

}  // namespace

std::optional<Parabola> approach(const Chain& chain, bool last) {
    constexpr std::size_t kPoints = 5;
    std::array<LinePoint, kPoints> points;
    std::size_t count = 0;
    double s = 0.0;
    for (std::size_t k = 1; k + 1 < chain.points.size() && count < kPoints; ++k) {
        const Vec2d point = to_double(point_from(chain, last, k));
        s += length(point - to_double(point_from(chain, last, k - 1)));
        points[count++] = {s, point};
    }
    if (count < 2) return std::nullopt;
    const Parabola line = fit_parabola({points.data(), count});
    return std::isfinite(line.point.x + line.tangent.x + line.bend.x) ? std::optional(line)
                                                                      : std::nullopt;
}

Vec2d meeting_point(std::span<const Parabola> lines, Vec2d start) {
    constexpr double kPull = 0.02;  // of the start
    double xx = kPull;
    double xy = 0.0;
    double yy = kPull;
    Vec2d sum = start * kPull;
    for (const Parabola& line : lines) {
        const double speed = length(line.tangent);
        if (speed == 0.0) continue;
        const Vec2d normal{-line.tangent.y / speed, line.tangent.x / speed};
        xx += normal.x * normal.x;
        xy += normal.x * normal.y;
        yy += normal.y * normal.y;
        sum = sum + normal * dot(normal, line.point);
    }
    const double determinant = xx * yy - xy * xy;
    return {(sum.x * yy - sum.y * xy) / determinant, (sum.y * xx - sum.x * xy) / determinant};
}

void place_junctions(ChainGraph& graph, float spacing) {
    std::vector<ChainEnd> ends;
    for (std::uint32_t k = 0; k < graph.chains.size(); ++k) {
        if (graph.chains[k].closed) continue;
        ends.push_back({graph.chains[k].first_vertex, k, false});
        ends.push_back({graph.chains[k].last_vertex, k, true});
    }
    std::ranges::stable_sort(ends, {}, &ChainEnd::vertex);

    std::vector<Parabola> lines;
    for (std::size_t begin = 0, end = 0; begin < ends.size(); begin = end) {
        lines.clear();
        Vec2d inside;
        for (; end < ends.size() && ends[end].vertex == ends[begin].vertex; ++end) {
            const Chain& chain = graph.chains[ends[end].chain];
            inside = inside + to_double(point_from(chain, ends[end].last, 1));
            if (const auto line = approach(chain, ends[end].last)) lines.push_back(*line);
        }
        const std::size_t degree = end - begin;
        if (degree < 3 || lines.size() < 2) continue;
        const ChainEnd& any = ends[begin];
        const Vec2d start = to_double(point_from(graph.chains[any.chain], any.last, 0));
        const Vec2d place = keep_in_cell(meeting_point(lines, start),
                                         inside * (1.0 / static_cast<double>(degree)), spacing);
        for (std::size_t k = begin; k < end; ++k) {
            std::vector<Vec2f>& points = graph.chains[ends[k].chain].points;
            (ends[k].last ? points.back() : points.front()) = to_float(place);
        }
    }
}

}  // namespace ink
