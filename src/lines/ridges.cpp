#include "lines/ridges.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace ink {

namespace {

constexpr std::size_t kTerms = 10;  // of a cubic in two variables

/// 1, x, y, x^2/2, xy, y^2/2, x^3/6, x^2 y/2, x y^2/2, y^3/6: a coefficient is a derivative.
std::array<double, kTerms> terms(double x, double y) {
    return {1.0,
            x,
            y,
            x * x / 2,
            x * y,
            y * y / 2,
            x * x * x / 6,
            x * x * y / 2,
            x * y * y / 2,
            y * y * y / 6};
}

using NormalMatrix = std::array<std::array<double, 2 * kTerms>, kTerms>;

/// Gauss and Jordan, with pivots, on a symmetric matrix beside the unit matrix.
void invert(NormalMatrix& m) {
    for (std::size_t column = 0; column < kTerms; ++column) {
        std::size_t pivot = column;
        for (std::size_t row = column; row < kTerms; ++row) {
            if (std::abs(m[row][column]) > std::abs(m[pivot][column])) pivot = row;
        }
        std::swap(m[column], m[pivot]);
        const double scale = 1.0 / m[column][column];
        for (double& value : m[column]) value *= scale;
        for (std::size_t row = 0; row < kTerms; ++row) {
            if (row == column) continue;
            const double factor = m[row][column];
            for (std::size_t k = 0; k < 2 * kTerms; ++k) m[row][k] -= factor * m[column][k];
        }
    }
}

float smoothstep(float from, float to, float x) {
    const float s = std::clamp((x - from) / (to - from), 0.0F, 1.0F);
    return s * s * (3.0F - 2.0F * s);
}

}  // namespace

float RidgeEstimate::distance() const {
    const float size = std::hypot(gradient.x, gradient.y);
    return size > 0.0F ? std::abs(slope) / size : std::numeric_limits<float>::infinity();
}

RidgeEstimator::RidgeEstimator(std::span<const Vec2f> offsets, const RidgeSettings& settings)
    : settings_(settings) {
    // In units of the largest offset, so that the normal equations are well scaled.
    double reach = 0.0;
    for (const Vec2f p : offsets) reach = std::max<double>(reach, std::hypot(p.x, p.y));
    NormalMatrix m{};
    for (const Vec2f p : offsets) {
        const auto t = terms(p.x / reach, p.y / reach);
        for (std::size_t i = 0; i < kTerms; ++i) {
            for (std::size_t j = 0; j < kTerms; ++j) m[i][j] += t[i] * t[j];
        }
    }
    for (std::size_t i = 0; i < kTerms; ++i) m[i][kTerms + i] = 1.0;
    invert(m);
    constexpr std::array<int, kTerms> kOrder{0, 1, 1, 2, 2, 2, 3, 3, 3, 3};
    for (const Vec2f p : offsets) {
        const auto t = terms(p.x / reach, p.y / reach);
        std::array<float, kDerivatives> weights{};
        for (std::size_t i = 1; i < kTerms; ++i) {
            double sum = 0.0;
            for (std::size_t j = 0; j < kTerms; ++j) sum += m[i][kTerms + j] * t[j];
            weights[i - 1] = static_cast<float>(sum / std::pow(reach, kOrder[i]));
        }
        weights_.push_back(weights);
    }
}

RidgeEstimate RidgeEstimator::estimate(std::span<const Vec3f> normals) const {
    std::array<Vec3f, kDerivatives> d{};
    const Vec3f base = normals[0];  // derivatives do not depend on it; rounding does
    for (std::size_t k = 0; k < normals.size(); ++k) {
        const Vec3f n = normals[k] - base;
        for (std::size_t i = 0; i < kDerivatives; ++i) d[i] = d[i] + n * weights_[k][i];
    }
    const auto& [x, y, xx, xy, yy, xxx, xxy, xyy, yyy] = d;

    // Q^T Q, whose larger eigenvalue is q1^2.
    const float a = dot(x, x);
    const float b = dot(x, y);
    const float c = dot(y, y);
    const float half = 0.5F * (a - c);
    const float root = std::sqrt(half * half + b * b);
    const float largest = 0.5F * (a + c) + root;
    const float q1 = std::sqrt(largest);
    RidgeEstimate result;
    // Where the two singular values are alike, there is no direction t1: ridges fade out there.
    constexpr float kLeastDifference = 0.3F;
    constexpr float kFullDifference = 0.6F;
    const float difference = 2.0F * root / largest;
    if (!(q1 > settings_.least) || !(difference > kLeastDifference)) return result;
    const Vec2f t = half >= 0.0F ? Vec2f{half + root, b} : Vec2f{b, root - half};
    const float size = std::hypot(t.x, t.y);
    const float u = t.x / size;
    const float v = t.y / size;

    // Derivatives along t1 and, at a right angle to it, t2 = (-v, u).
    const Vec3f nt = x * u + y * v;
    const Vec3f ns = y * u - x * v;
    const Vec3f ntt = xx * (u * u) + xy * (2 * u * v) + yy * (v * v);
    const Vec3f nts = xx * (-u * v) + xy * (u * u - v * v) + yy * (u * v);
    const Vec3f nss = xx * (v * v) + xy * (-2 * u * v) + yy * (u * u);
    const Vec3f nttt =
        xxx * (u * u * u) + xxy * (3 * u * u * v) + xyy * (3 * u * v * v) + yyy * (v * v * v);
    const Vec3f ntts = xxx * (-u * u * v) + xxy * (u * u * u - 2 * u * v * v) +
                       xyy * (2 * u * u * v - v * v * v) + yyy * (u * v * v);

    // g = D_t1 (q1^2) = 2 n_t . n_tt, and its derivatives, along which t1 turns at a rate w.
    const float gap = 2.0F * root;
    const float g = 2.0F * dot(nt, ntt);
    const float turned = 2.0F * (dot(ns, ntt) + 2.0F * dot(nt, nts));
    const float wt = (dot(ntt, ns) + dot(nt, nts)) / gap;
    const float ws = (dot(nts, ns) + dot(nt, nss)) / gap;
    const float gt = 2.0F * (dot(ntt, ntt) + dot(nt, nttt)) + wt * turned;
    const float gs = 2.0F * (dot(nts, ntt) + dot(nt, ntts)) + ws * turned;
    result.slope = g;
    result.along = {u, v};
    result.gradient = {gt * u - gs * v, gt * v + gs * u};
    const bool maximum = gt < 0.0F;
    result.strength = maximum ? smoothstep(settings_.least, settings_.full, q1) *
                                    smoothstep(kLeastDifference, kFullDifference, difference)
                              : 0.0F;
    return result;
}

bool one_surface(const Sample& a, const Sample& b) {
    if (a.id != b.id || a.id == kBackground) return false;
    constexpr float kLeastCosine = 0.5F;
    const Vec3f normals = a.normal + b.normal;
    const Vec3f chord = b.position - a.position;
    const float along = dot(chord, normals);
    // On a smooth surface the chord is at a right angle to the mean normal, about.
    constexpr float kChordSine = 0.25F;
    return dot(a.normal, b.normal) > kLeastCosine &&
           along * along <= kChordSine * kChordSine * dot(chord, chord) * dot(normals, normals);
}

std::vector<LatticeStep> ridge_neighbourhood(int radius) {
    std::vector<LatticeStep> steps{{0, 0}};
    for (const int ring : {1, 2}) {
        const double reach = 0.5 * ring * radius;
        for (int k = 0; k < 8 * ring; ++k) {
            const double angle = 2.0 * std::numbers::pi * k / (8.0 * ring);
            const LatticeStep step{static_cast<int>(std::lround(reach * std::cos(angle))),
                                   static_cast<int>(std::lround(reach * std::sin(angle)))};
            const auto same = [&](const LatticeStep& s) { return s.i == step.i && s.j == step.j; };
            if (std::ranges::none_of(steps, same)) steps.push_back(step);
        }
    }
    return steps;
}

namespace {

/// Ridge estimates at the points of a grid inside its apron, and the lines through its cells.
class RidgeField {
  public:
    RidgeField(const SampleGrid& grid, int apron, int radius, const RidgeSettings& settings)
        : grid_(grid),
          apron_(apron),
          steps_(ridge_neighbourhood(radius)),
          estimator_(offsets(steps_, grid.spacing), settings),
          columns_(grid.width - 2 * apron),
          rows_(grid.height - 2 * apron),
          normals_(steps_.size()) {
        estimates_.resize(static_cast<std::size_t>(std::max(columns_, 0)) *
                          static_cast<std::size_t>(std::max(rows_, 0)));
        for (int j = 0; j < rows_; ++j) {
            for (int i = 0; i < columns_; ++i) at(i, j) = estimate(i + apron, j + apron);
        }
    }

    void connect(std::vector<Segment>& segments) {
        for (int j = 0; j + 1 < rows_; ++j) {
            for (int i = 0; i + 1 < columns_; ++i) connect_cell(i, j, segments);
        }
    }

  private:
    struct Crossing {
        Vec2f point;
        float strength;
    };

    static std::vector<Vec2f> offsets(const std::vector<LatticeStep>& steps, float spacing) {
        std::vector<Vec2f> points;
        for (const LatticeStep& step : steps) {
            points.push_back(
                {static_cast<float>(step.i) * spacing, static_cast<float>(step.j) * spacing});
        }
        return points;
    }

    RidgeEstimate& at(int i, int j) {
        return estimates_[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) +
                          static_cast<std::size_t>(i)];
    }

    RidgeEstimate estimate(int i, int j) {
        const Sample centre = grid_.sample(grid_.index(i, j));
        if (centre.id == kBackground) return {};
        for (std::size_t k = 0; k < steps_.size(); ++k) {
            const Sample other = grid_.sample(grid_.index(i + steps_[k].i, j + steps_[k].j));
            if (k > 0 && !one_surface(centre, other)) return {};
            normals_[k] = other.normal;
        }
        return estimator_.estimate(normals_);
    }

    /// Where the slope changes its sign between two neighbours, as the sense of t1 allows.
    void cross(int i, int j, int di, int dj, std::vector<Crossing>& crossings) {
        const RidgeEstimate& a = at(i, j);
        const RidgeEstimate& b = at(i + di, j + dj);
        if (!(a.strength > 0.0F) || !(b.strength > 0.0F)) return;
        const float sense = a.along.x * b.along.x + a.along.y * b.along.y < 0.0F ? -1.0F : 1.0F;
        const float g = a.slope;
        const float h = b.slope * sense;
        if ((g < 0.0F) == (h < 0.0F)) return;
        const float share = g / (g - h);
        const Vec2f from = grid_.point(i + apron_, j + apron_);
        const Vec2f to = grid_.point(i + di + apron_, j + dj + apron_);
        crossings.push_back(
            {from + (to - from) * share, a.strength + (b.strength - a.strength) * share});
    }

    void connect_cell(int i, int j, std::vector<Segment>& segments) {
        crossings_.clear();
        cross(i, j, 1, 0, crossings_);
        cross(i, j, 0, 1, crossings_);
        cross(i + 1, j, 0, 1, crossings_);
        cross(i, j + 1, 1, 0, crossings_);
        if (crossings_.size() != 2) return;
        const std::size_t sample = grid_.index(i + apron_, j + apron_);
        Segment segment;
        segment.a = crossings_[0].point;
        segment.b = crossings_[1].point;
        segment.type = LineType::ridge;
        segment.strength = 0.5F * (crossings_[0].strength + crossings_[1].strength);
        segment.t = grid_.t[sample];
        segment.left = segment.right = segment.owner = grid_.id[sample];
        segment.spans_cell = true;
        segment.left_sample = segment.right_sample = static_cast<std::uint32_t>(sample);
        segments.push_back(segment);
    }

    const SampleGrid& grid_;
    int apron_;
    std::vector<LatticeStep> steps_;
    RidgeEstimator estimator_;
    int columns_, rows_;
    std::vector<RidgeEstimate> estimates_;
    std::vector<Vec3f> normals_;
    std::vector<Crossing> crossings_;
};

}  // namespace

void find_ridges(const SampleGrid& grid, int apron, int radius, const RidgeSettings& settings,
                 std::vector<Segment>& segments) {
    RidgeField(grid, apron, radius, settings).connect(segments);
}

}  // namespace ink
