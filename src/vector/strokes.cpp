#include "vector/strokes.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace ink {

namespace {

/// Widths within a stroke differ by no more than this, pixels: its edges are out by a quarter of it
/// at most, no more than the curves are.
constexpr float kWidthStep = 0.2F;

/// Opacities that differ by less look alike.
constexpr float kOpacityStep = 0.04F;

/// Fainter strokes are left out: they do not change a pixel by as much as a step of 8 bits.
constexpr double kInvisible = 0.002;

float spread(std::span<const float> values) {
    const auto [least, most] = std::ranges::minmax(values);
    return most - least;
}

/// A line with the place and the weight of each of its points; a closed one comes to its first
/// point again.
struct WeighedLine {
    std::vector<Vec2d> points;
    std::vector<double> share;  ///< of the length up to there
    std::vector<float> width, opacity;

    WeighedLine(const Chain& chain, const LineWeights& weights)
        : width(weights.width), opacity(weights.opacity) {
        for (const Vec2f point : chain.points) points.push_back(to_double(point));
        if (chain.closed) {
            points.push_back(points.front());
            width.push_back(width.front());
            opacity.push_back(opacity.front());
        }
        share.push_back(0.0);
        for (std::size_t k = 1; k < points.size(); ++k) {
            share.push_back(share.back() + length(points[k] - points[k - 1]));
        }
        const double total = share.back();
        for (double& s : share) s = total > 0.0 ? s / total : 0.0;
    }
    std::size_t last() const { return points.size() - 1; }
    bool fades(std::size_t from, std::size_t to) const {
        return spread(std::span(opacity).subspan(from, to - from + 1)) > kOpacityStep;
    }
};

/// Points between which the width hardly changes: the first, where it has changed enough, the last.
std::vector<std::size_t> cuts_by_width(const WeighedLine& line) {
    std::vector<std::size_t> cuts{0};
    float least = line.width[0];
    float most = least;
    for (std::size_t k = 1; k < line.last(); ++k) {
        least = std::min(least, line.width[k]);
        most = std::max(most, line.width[k]);
        if (most - least <= kWidthStep || line.share[k] <= line.share[cuts.back()]) continue;
        cuts.push_back(k);
        least = most = line.width[k];
    }
    while (cuts.size() > 1 && line.share[cuts.back()] >= 1.0) cuts.pop_back();
    cuts.push_back(line.last());
    return cuts;
}

/// Whether each point lies farther on the straight way between two points than the one before it.
bool goes_straight_on(const WeighedLine& line, std::size_t from, std::size_t to) {
    const Vec2d way = line.points[to] - line.points[from];
    if (way == Vec2d{}) return false;
    for (std::size_t k = from; k < to; ++k) {
        if (dot(line.points[k + 1] - line.points[k], way) < 0.0) return false;
    }
    return true;
}

/// Cuts a stretch that fades in halves until each can be painted with a straight fade.
void cut_fade(const WeighedLine& line, std::size_t from, std::size_t to,
              std::vector<std::size_t>& cuts) {
    if (to - from < 2 || !line.fades(from, to) || goes_straight_on(line, from, to)) return;
    const std::size_t middle = from + (to - from) / 2;
    cut_fade(line, from, middle, cuts);
    cuts.push_back(middle);
    cut_fade(line, middle, to, cuts);
}

std::vector<std::size_t> find_cuts(const WeighedLine& line) {
    const std::vector<std::size_t> by_width = cuts_by_width(line);
    std::vector<std::size_t> cuts{0};
    for (std::size_t k = 0; k + 1 < by_width.size(); ++k) {
        cut_fade(line, by_width[k], by_width[k + 1], cuts);
        cuts.push_back(by_width[k + 1]);
    }
    return cuts;
}

/// As few stops as show how opacity changes.
std::vector<Stroke::Stop> stops(const WeighedLine& line, std::size_t from, std::size_t to) {
    const Vec2d start = line.points[from];
    const Vec2d way = line.points[to] - start;
    const double size = dot(way, way);
    const auto stop = [&](std::size_t k) {
        const double offset = size > 0.0 ? dot(line.points[k] - start, way) / size : 0.0;
        return Stroke::Stop{std::clamp(offset, 0.0, 1.0), static_cast<double>(line.opacity[k])};
    };
    std::vector<Stroke::Stop> kept{stop(from)};
    for (std::size_t begin = from, end = from + 1; begin < to; begin = end) {
        const auto is_even = [&](std::size_t goal) {
            const Stroke::Stop a = stop(begin);
            const Stroke::Stop b = stop(goal);
            for (std::size_t k = begin + 1; k < goal; ++k) {
                const Stroke::Stop at = stop(k);
                const double way_on = b.offset - a.offset;
                const double share = way_on > 0.0 ? (at.offset - a.offset) / way_on : 0.0;
                const double even = a.opacity + share * (b.opacity - a.opacity);
                if (std::abs(even - at.opacity) > 0.5 * static_cast<double>(kOpacityStep)) {
                    return false;
                }
            }
            return true;
        };
        end = begin + 1;
        while (end < to && is_even(end + 1)) ++end;
        kept.push_back(stop(end));
    }
    return kept;
}

/// The mean over the length of values at the points.
double mean(const WeighedLine& line, std::span<const float> values, std::size_t from,
            std::size_t to) {
    double sum = 0.0;
    for (std::size_t k = from; k < to; ++k) {
        sum += (line.share[k + 1] - line.share[k]) * 0.5 *
               (static_cast<double>(values[k]) + static_cast<double>(values[k + 1]));
    }
    const double size = line.share[to] - line.share[from];
    return size > 0.0 ? sum / size : static_cast<double>(values[from]);
}

}  // namespace

LineWeights weigh(const Chain& chain, double width_px, const LineThinning& thinning) {
    LineWeights weights;
    const auto scale_at = [&](std::size_t k) {
        return chain.width_scales.empty() ? 1.0F : chain.width_scales[k];
    };
    for (std::size_t k = 0; k < chain.points.size(); ++k) {
        weights.width.push_back(static_cast<float>(width_px) * scale_at(k) *
                                thinning.scale_at(chain.points[k], chain.level));
    }
    weights.opacity = chain.strengths;
    return weights;
}

std::vector<Stroke> make_strokes(const Chain& chain, const Curve& curve,
                                 const LineWeights& weights) {
    std::vector<Stroke> strokes;
    if (curve.pieces.empty()) return strokes;
    const WeighedLine line(chain, weights);
    if (spread(line.width) <= kWidthStep && !line.fades(0, line.last())) {
        const double opacity = mean(line, line.opacity, 0, line.last());
        if (opacity < kInvisible) return strokes;
        strokes.push_back({.curve = curve,
                           .closed = chain.closed,
                           .width_px = mean(line, line.width, 0, line.last()),
                           .opacity = opacity});
        return strokes;
    }
    const std::vector<std::size_t> cuts = find_cuts(line);
    const MeasuredCurve measured(curve);
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
        const std::size_t from = cuts[k];
        const std::size_t to = cuts[k + 1];
        const auto opacity = std::span(line.opacity).subspan(from, to - from + 1);
        if (static_cast<double>(std::ranges::max(opacity)) < kInvisible ||
            line.share[to] <= line.share[from])
            continue;
        Stroke stroke;
        const bool whole = cuts.size() == 2;
        stroke.curve = whole ? curve : measured.part(line.share[from], line.share[to]);
        stroke.closed = whole && chain.closed;
        stroke.begins_at = line.share[from] * measured.length();
        stroke.width_px = mean(line, line.width, from, to);
        stroke.opacity = mean(line, line.opacity, from, to);
        if (line.fades(from, to)) stroke.fade = stops(line, from, to);
        strokes.push_back(std::move(stroke));
    }
    return strokes;
}

}  // namespace ink
