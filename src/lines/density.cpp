#include "lines/density.h"

#include <algorithm>
#include <cmath>

#include "base/multiversion.h"

namespace ink {

namespace {

int floor_divide(int a, int b) { return (a >= 0 ? a : a - b + 1) / b; }

constexpr float kWidths = 9.0F;

}  // namespace

LineDensity::LineDensity(int x0, int y0, int x1, int y1, float widest, int least_side)
    : x0_(x0),
      y0_(y0),
      x1_(x1),
      y1_(y1),
      side_(std::max(least_side, static_cast<int>(std::ceil(kWidths * widest)))),
      i0_(floor_divide(x0, side_) - 1),
      j0_(floor_divide(y0, side_) - 1),
      across_(floor_divide(x1 - 1, side_) - i0_ + 2),
      down_(floor_divide(y1 - 1, side_) - j0_ + 2),
      inked_(static_cast<std::size_t>(across_) * static_cast<std::size_t>(down_)) {}

/// Of a square, as far as it was searched.
float LineDensity::area(int i, int j) const {
    const int width = std::min(x1_, (i + 1) * side_) - std::max(x0_, i * side_);
    const int height = std::min(y1_, (j + 1) * side_) - std::max(y0_, j * side_);
    return static_cast<float>(std::max(width, 0)) * static_cast<float>(std::max(height, 0));
}

LineDensity& LineDensity::operator+=(const LineDensity& other) {
    for (std::size_t k = 0; k < inked_.size(); ++k) inked_[k] += other.inked_[k];
    return *this;
}

void LineDensity::finish() {
    squares_.resize(inked_.size());
    for (int j = j0_; j < j0_ + down_; ++j) {
        for (int i = i0_; i < i0_ + across_; ++i) {
            const std::size_t k = square(i, j);
            squares_[k] = {static_cast<float>(inked_[k]) / kFixedPoint, area(i, j)};
        }
    }
}

DensityRaster LineDensity::raster() const {
    return {squares_.data(),   shift_,          shrink_, 1.0F / static_cast<float>(side_), i0_, j0_,
            i0_ + across_ - 2, j0_ + down_ - 2, across_};
}

float LineDensity::at(Vec2f point) const {
    float share = 0.0F;
    at(std::span(&point, 1), std::span(&share, 1));
    return share;
}

void LineDensity::at(std::span<const Vec2f> points, std::span<float> shares) const {
    find_shares(raster(), points, shares);
}

float LineDensity::most_within(Vec2f lower, Vec2f upper) const {
    const DensityRaster r = raster();
    const auto first = [&](float at, float shift, int least, int most) {
        const float place = (at * r.shrink + shift) * r.per_square - 0.5F;
        return std::clamp(static_cast<int>(std::floor(place)), least, most);
    };
    const int i0 = first(lower.x, r.shift.x, r.i0, r.i1);
    const int j0 = first(lower.y, r.shift.y, r.j0, r.j1);
    const int i1 = first(upper.x, r.shift.x, r.i0, r.i1) + 1;
    const int j1 = first(upper.y, r.shift.y, r.j0, r.j1) + 1;
    // A mean of squares in proportion is no denser than the densest of them.
    float most = 0.0F;
    for (int j = j0; j <= j1; ++j) {
        for (int i = i0; i <= i1; ++i) {
            const DensityRaster::Square& here = squares_[square(i, j)];
            if (here.searched > 0.0F) most = std::max(most, here.inked / here.searched);
            // What is inked where nothing was searched belongs to its neighbours.
            if (here.searched <= 0.0F && here.inked > 0.0F) return kInfinity;
        }
    }
    constexpr float kRounding = 1e-4F;
    return most * (1.0F + kRounding);
}

void LineDensity::enlarge(float factor, Vec2f middle_before, Vec2f middle_after) {
    shrink_ = 1.0F / factor;
    shift_ = middle_before - middle_after * shrink_;
}

namespace {

/// exp(-x) for x >= 0 to 1e-5, from arithmetic that gives the same bits on every processor, which
/// the library's does not.
INKTRACE_INLINE float decay(float x) {
    const float z = std::min(x, 16.0F) * 0.125F;
    constexpr float kThird = 1.0F / 3.0F;
    constexpr float kFifth = 1.0F / 5.0F;
    constexpr float kSixth = 1.0F / 6.0F;
    // Taylor's series, from its last term on.
    float growth = 1.0F + z * kSixth;
    growth = 1.0F + z * kFifth * growth;
    growth = 1.0F + z * 0.25F * growth;
    growth = 1.0F + z * kThird * growth;
    growth = 1.0F + z * 0.5F * growth;
    growth = 1.0F + z * growth;
    const float eighth = 1.0F / growth;
    const float quarter = eighth * eighth;
    const float half = quarter * quarter;
    return half * half;
}

}  // namespace

namespace {

/// Up to this share lines keep their width; from here on they approach `most`, with no kink
/// between.
INKTRACE_INLINE float free_share(float most) { return 0.8F * most; }

INKTRACE_INLINE float scale_of(float share, float most) {
    const float free = free_share(most);
    const float room = most - free;
    const float dense = std::max(share, free);
    const float scale = (free + room * (1.0F - decay((dense - free) / room))) / dense;
    return share <= free ? 1.0F : scale;
}

INKTRACE_MULTIVERSION
void scales_of(float most, std::span<float> shares) {
    float* const values = shares.data();
    for (std::size_t k = 0; k < shares.size(); ++k) values[k] = scale_of(values[k], most);
}

}  // namespace

float width_scale(float share, float most) { return scale_of(share, most); }

float LineThinning::scale_at(Vec2f point, int level) const {
    if (most >= 1.0F) return 1.0F;
    return width_scale((level == 0 ? direct : all).at(point), most);
}

void LineThinning::scales_at(std::span<const Vec2f> points, std::span<float> scales) const {
    if (most >= 1.0F) {
        std::ranges::fill(scales, 1.0F);
        return;
    }
    // Places that follow each other are mostly close together.
    constexpr std::size_t kRun = 32;
    for (std::size_t first = 0; first < points.size(); first += kRun) {
        const std::size_t count = std::min(kRun, points.size() - first);
        const std::span<const Vec2f> some = points.subspan(first, count);
        const std::span<float> own = scales.subspan(first, count);
        Vec2f lower = some[0];
        Vec2f upper = some[0];
        for (const Vec2f p : some) {
            lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
            upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
        }
        if (direct.most_within(lower, upper) <= free_share(most)) {
            std::ranges::fill(own, 1.0F);
            continue;
        }
        direct.at(some, own);
        scales_of(most, own);
    }
}

}  // namespace ink
