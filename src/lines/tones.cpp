#include "lines/tones.h"

#include <algorithm>

namespace ink {

namespace {

constexpr float kShade = 0.5F;
constexpr std::uint8_t kRight = 1;
constexpr std::uint8_t kDown = 2;

std::size_t second_end(const SampleGrid& grid, int i, int j, bool down) {
    return down ? grid.index(i, j + 1) : grid.index(i + 1, j);
}

}  // namespace

void ToneConnector::connect(const SampleGrid& grid, std::span<const float> brightness,
                            std::span<const SuspectEdge> edges, std::span<const Crossing> crossings,
                            std::vector<Segment>& segments) {
    edges_.assign(edges.begin(), edges.end());
    crossed_.assign(grid.id.size(), 0);
    take_lines(grid, brightness, crossings);
    add_borders(grid, brightness);
    connector_.connect(grid, edges_, crossings_, segments);
}

/// A side that neither end of the edge sees, a sliver between two lines, counts as light.
void ToneConnector::take_lines(const SampleGrid& grid, std::span<const float> brightness,
                               std::span<const Crossing> crossings) {
    crossings_.clear();
    for (Crossing crossing : crossings) {
        if (crossing.type == LineType::mesh) continue;
        const SuspectEdge& edge = edges_[crossing.edge];
        const std::size_t a = grid.index(edge.i, edge.j);
        const std::size_t b = second_end(grid, edge.i, edge.j, edge.down);
        const auto tone = [&](GeometryId id, std::size_t end) {
            return Tones::id(id, id == grid.id[end] && brightness[end] < kShade);
        };
        crossed_[a] |= edge.down ? kDown : kRight;
        crossing.first = tone(crossing.first, a);
        crossing.second = tone(crossing.second, b);
        crossing.nearer = Tones::id(crossing.nearer, false);
        crossings_.push_back(crossing);
    }
}

void ToneConnector::add_borders(const SampleGrid& grid, std::span<const float> brightness) {
    for (int j = 0; j < grid.height; ++j) {
        for (int i = 0; i < grid.width; ++i) {
            if (grid.id[grid.index(i, j)] == kBackground) continue;
            if (i + 1 < grid.width) add_border(grid, brightness, i, j, false);
            if (j + 1 < grid.height) add_border(grid, brightness, i, j, true);
        }
    }
}

/// Between a point and its neighbour to the right or below.
void ToneConnector::add_border(const SampleGrid& grid, std::span<const float> brightness, int i,
                               int j, bool down) {
    const std::size_t a = grid.index(i, j);
    const std::size_t b = second_end(grid, i, j, down);
    const bool a_shaded = brightness[a] < kShade;
    const bool b_shaded = brightness[b] < kShade;
    if (a_shaded == b_shaded || grid.id[a] != grid.id[b]) return;
    if ((crossed_[a] & (down ? kDown : kRight)) != 0) return;
    const float at = std::clamp((kShade - brightness[a]) / (brightness[b] - brightness[a]), 0.02F,
                                0.98F);  // off the corners of cells, where sides would meet
    const Vec2f from = grid.point(i, j);
    const Vec2f to = down ? grid.point(i, j + 1) : grid.point(i + 1, j);
    Crossing border;
    border.point = from + (to - from) * at;
    border.type = LineType::crease;
    border.strength = 0.0F;
    border.t = grid.t[a] + at * (grid.t[b] - grid.t[a]);
    border.edge = static_cast<std::uint32_t>(edges_.size());
    border.first = Tones::id(grid.id[a], a_shaded);
    border.second = Tones::id(grid.id[b], b_shaded);
    border.nearer = kNobody;
    crossings_.push_back(border);
    edges_.push_back(
        {static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j), down, Suspicion::none});
}

}  // namespace ink
