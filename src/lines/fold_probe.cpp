#include "lines/fold_probe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lines/segment_squares.h"

namespace ink {

using plane::left_of;
using plane::unit;

void FoldProbe::enter(Vec2f point, float reach, std::size_t worker) const {
    if (!workers_[worker].enter) return;
    workers_[worker].enter(point - Vec2f{reach, reach}, point + Vec2f{reach, reach});
}

std::span<const Sample> FoldProbe::look(std::span<const Vec2f> points, std::size_t worker) const {
    std::vector<Sample>& samples = scratch_[worker].samples;
    samples.resize(points.size());
    workers_[worker].sample(points, samples);
    return samples;
}

float FoldProbe::facing(const Sample& sample) const {
    return -dot(sample.normal, viewpoint_.ray_direction(sample));
}

namespace {

constexpr std::size_t kHalf = 3;
constexpr std::size_t kAcross = 2 * kHalf + 1;

/// Puts points beside one.
void put_across(Vec2f point, Vec2f aside, std::span<Vec2f> points) {
    for (std::size_t k = 0; k < kAcross; ++k) {
        points[k] = point + aside * (static_cast<float>(k) - static_cast<float>(kHalf));
    }
}

}  // namespace

/// First over a wide way across, then closely about the lowest point there. Mostly that is the
/// middle one: what lies closely about it comes along in the same packet of rays.
std::optional<Vec2f> FoldProbe::find_valley(Vec2f point, Vec2f way, GeometryId owner,
                                            std::size_t worker) const {
    std::array<Vec2f, 2 * kAcross> points;
    const auto wide = std::span(points).first(kAcross);
    const auto close = std::span(points).last(kAcross);
    const Vec2f aside = left_of(way) * (0.125F * spacing_);
    put_across(point, left_of(way) * (0.5F * spacing_), wide);
    put_across(point, aside, close);
    std::span<const Sample> samples = look(points, worker);
    const auto near = lowest_of(samples.first(kAcross), true, owner);
    if (!near) return {};
    samples = samples.last(kAcross);
    if (*near != kHalf) {
        put_across(wide[*near], aside, close);
        samples = look(close, worker);
    }
    const auto lowest = lowest_of(samples, false, owner);
    if (!lowest) return {};
    return close[*lowest];
}

/// Of samples side by side; nothing where a wide way across meets no valley.
std::optional<std::size_t> FoldProbe::lowest_of(std::span<const Sample> samples, bool wide,
                                                GeometryId owner) const {
    if (std::ranges::any_of(samples, [&](const Sample& s) { return s.id != owner; })) return {};
    std::array<float, kAcross> heights{};
    for (std::size_t k = 0; k < kAcross; ++k) heights[k] = facing(samples[k]);
    const auto lowest =
        static_cast<std::size_t>(std::ranges::min_element(heights) - heights.begin());
    const float rise = std::min(*std::max_element(heights.begin(), heights.begin() + kHalf),
                                *std::max_element(heights.end() - kHalf, heights.end()));
    if (wide &&
        (lowest == 0 || lowest + 1 == kAcross || rise < heights[lowest] + settings_.least_rise ||
         heights[lowest] > settings_.most_facing)) {
        return {};
    }
    return lowest;
}

bool FoldProbe::is_steep(std::span<const Vec2f> path, GeometryId owner, std::size_t worker) const {
    return std::ranges::all_of(look(path, worker), [&](const Sample& sample) {
        return sample.id == owner && facing(sample) <= settings_.most_facing_leapt;
    });
}

/// By squares of the picture, so that rays are close together.
std::vector<float> FoldProbe::depths_of(std::vector<std::uint32_t>& folds,
                                        const FoldLoop& loop) const {
    constexpr float kSide = 16.0F;
    const auto square = [&](std::uint32_t k) {
        const Vec2f p = middle_of(k);
        return std::pair{std::floor(p.y / kSide), std::floor(p.x / kSide)};
    };
    std::ranges::stable_sort(folds, {}, square);
    std::vector<std::size_t> starts;
    for (std::size_t n = 0; n < folds.size(); ++n) {
        if (n == 0 || square(folds[n]) != square(folds[n - 1])) starts.push_back(n);
    }
    starts.push_back(folds.size());
    std::vector<float> depths(folds.size());
    loop(starts.size() - 1, [&](std::size_t n, std::size_t worker) {
        const std::size_t count = starts[n + 1] - starts[n];
        measure_depths(std::span(folds).subspan(starts[n], count), worker,
                       std::span(depths).subspan(starts[n], count));
    });
    return depths;
}

namespace {

/// How far two hits are from lying on one surface, however steep that is.
float depth_between(const Sample& a, const Sample& b) {
    const Vec3f normals = a.normal + b.normal;
    const float size = length(normals);
    return size > 0.0F ? std::abs(dot(b.position - a.position, normals)) / size : 0.0F;
}

}  // namespace

/// Between two points of the screen, at the depth of a sample.
float FoldProbe::length_between(Vec2f p, Vec2f q, const Sample& sample) const {
    const auto at = [&](Vec2f point) {
        return viewpoint_.origin(point) +
               normalize(viewpoint_.direction(point)) * static_cast<double>(sample.t);
    };
    return static_cast<float>(length(at(q) - at(p)));
}

void FoldProbe::measure_depths(std::span<const std::uint32_t> folds, std::size_t worker,
                               std::span<float> depths) const {
    std::vector<Vec2f>& points = scratch_[worker].points;
    points.clear();
    for (const std::uint32_t k : folds) {
        const Vec2f aside = left_of(unit(lines_[k].b - lines_[k].a)) * (0.25F * spacing_);
        points.push_back(middle_of(k) + aside);
        points.push_back(middle_of(k) - aside);
    }
    const std::span<const Sample> samples = look(points, worker);
    for (std::size_t n = 0; n < folds.size(); ++n) {
        const Sample& a = samples[2 * n];
        const Sample& b = samples[2 * n + 1];
        const float pixel = length_between(points[2 * n], points[2 * n + 1], a) / (0.5F * spacing_);
        // Beside an outline, what is seen there is that outline's far side.
        depths[n] = a.id == b.id ? depth_between(a, b) / pixel : -1.0F;
    }
}

}  // namespace ink
