#include "lines/ridges.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <utility>

#include "base/lanes.h"
#include "base/multiversion.h"

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

INKTRACE_INLINE float smoothstep(float from, float to, float x) {
    const float s = std::min(std::max((x - from) / (to - from), 0.0F), 1.0F);
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

namespace {

using Derivatives = std::array<Vec3f, RidgeEstimator::kDerivatives>;

/// What the derivatives of the normal on screen tell. Without branches, so that loops over it
/// vectorise.
INKTRACE_INLINE RidgeEstimate estimate_from(const Derivatives& d, const RidgeSettings& settings) {
    const auto& [x, y, xx, xy, yy, xxx, xxy, xyy, yyy] = d;

    // Q^T Q, whose larger eigenvalue is q1^2.
    const float a = dot(x, x);
    const float b = dot(x, y);
    const float c = dot(y, y);
    const float half = 0.5F * (a - c);
    const float root = std::sqrt(half * half + b * b);
    const float largest = 0.5F * (a + c) + root;
    const float q1 = std::sqrt(largest);
    // Where the two singular values are alike, there is no direction t1: ridges fade out there.
    constexpr float kLeastDifference = 0.3F;
    constexpr float kFullDifference = 0.6F;
    const float difference = 2.0F * root / largest;
    const bool turns = q1 > settings.least;
    const bool has_direction = difference > kLeastDifference;
    const float tx = half >= 0.0F ? half + root : b;
    const float ty = half >= 0.0F ? b : root - half;
    const float size = std::sqrt(tx * tx + ty * ty);
    const float u = tx / size;
    const float v = ty / size;

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
    const bool maximum = gt < 0.0F;
    const float strength = smoothstep(settings.least, settings.full, q1) *
                           smoothstep(kLeastDifference, kFullDifference, difference);
    RidgeEstimate result;
    result.slope = turns && has_direction ? g : 0.0F;
    result.along = {turns && has_direction ? u : 0.0F, turns && has_direction ? v : 0.0F};
    result.gradient = {turns && has_direction ? gt * u - gs * v : 0.0F,
                       turns && has_direction ? gt * v + gs * u : 0.0F};
    result.strength = turns && has_direction && maximum ? strength : 0.0F;
    return result;
}

}  // namespace

RidgeEstimate RidgeEstimator::estimate(std::span<const Vec3f> normals) const {
    Derivatives d{};
    const Vec3f base = normals[0];  // derivatives do not depend on it; rounding does
    for (std::size_t k = 0; k < normals.size(); ++k) {
        const Vec3f n = normals[k] - base;
        for (std::size_t i = 0; i < kDerivatives; ++i) d[i] = d[i] + n * weights_[k][i];
    }
    return estimate_from(d, settings_);
}

namespace {

/// Of two hits on one surface: their normals differ by less than this angle,
constexpr float kLeastCosine = 0.5F;
/// and the chord is at a right angle to the mean normal, about.
constexpr float kChordSine = 0.25F;

}  // namespace

bool one_surface(const Sample& a, const Sample& b) {
    if (a.id != b.id || a.id == kBackground) return false;
    const Vec3f normals = a.normal + b.normal;
    const Vec3f chord = b.position - a.position;
    const float along = dot(chord, normals);
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

/// Sixteen points of a row at once. Lanes of a type that the compiler keeps in registers.
using Row = float __attribute__((vector_size(kLanes * sizeof(float))));

INKTRACE_INLINE void load(const float* from, Row& row) { std::memcpy(&row, from, sizeof row); }

/// Two points of a neighbourhood that lie opposite each other: the offset of the first in a grid's
/// planes, and its weights. Those of the second are the same for derivatives of even order and the
/// opposite for those of odd order.
struct OppositePoints {
    std::ptrdiff_t offset;
    std::array<float, RidgeEstimator::kDerivatives> weights;
};

/// Normals' derivatives at sixteen points.
struct DerivativeRows {
    std::array<std::array<Lanes<float>, 3>, RidgeEstimator::kDerivatives> d;
};

struct EstimateRows {
    Lanes<float> slope, along_x, along_y, strength;
};

/// Which of sixteen points lie on one smooth piece of surface with all of their neighbourhoods.
INKTRACE_MULTIVERSION
bool on_one_surface(const SampleGrid& grid, std::size_t first,
                    std::span<const OppositePoints> pairs, Lanes<std::int32_t>& __restrict yes) {
    const GeometryId* const id = grid.id.data() + first;
    const std::array<const float*, 6> own{grid.nx.data() + first, grid.ny.data() + first,
                                          grid.nz.data() + first, grid.px.data() + first,
                                          grid.py.data() + first, grid.pz.data() + first};
    std::int32_t any = 0;
    for (int i = 0; i < kLanes; ++i) yes[i] = id[i] != kBackground ? 1 : 0;
    for (int i = 0; i < kLanes; ++i) any |= yes[i];
    if (any == 0) return false;
    for (const OppositePoints& pair : pairs) {
        for (const std::ptrdiff_t offset : {pair.offset, -pair.offset}) {
            const auto& [nx, ny, nz, px, py, pz] = own;
            for (int i = 0; i < kLanes; ++i) {
                const std::ptrdiff_t k = offset + i;
                const float sx = nx[i] + nx[k];
                const float sy = ny[i] + ny[k];
                const float sz = nz[i] + nz[k];
                const float cx = px[k] - px[i];
                const float cy = py[k] - py[i];
                const float cz = pz[k] - pz[i];
                const float along = cx * sx + cy * sy + cz * sz;
                const float cosine = nx[i] * nx[k] + ny[i] * ny[k] + nz[i] * nz[k];
                const float most = kChordSine * kChordSine * (cx * cx + cy * cy + cz * cz) *
                                   (sx * sx + sy * sy + sz * sz);
                const bool one =
                    (id[i] == id[k]) & (cosine > kLeastCosine) & (along * along <= most);
                yes[i] &= one ? 1 : 0;
            }
        }
    }
    any = 0;
    for (int i = 0; i < kLanes; ++i) any |= yes[i];
    return any != 0;
}

/// Derivatives of one component of the normals.
INKTRACE_MULTIVERSION
void differentiate(const float* normals, std::span<const OppositePoints> pairs,
                   std::size_t component, DerivativeRows& rows) {
    constexpr std::size_t kEvenFirst = 2;  // xx, xy, yy
    constexpr std::size_t kEvenLast = 4;
    Row centre;
    Row a;
    Row b;
    load(normals, centre);
    std::array<Row, RidgeEstimator::kDerivatives> sums{};
    for (const OppositePoints& pair : pairs) {
        load(normals + pair.offset, a);
        load(normals - pair.offset, b);
        const Row odd = a - b;
        const Row even = (a - centre) + (b - centre);
        for (std::size_t k = 0; k < sums.size(); ++k) {
            const bool is_even = k >= kEvenFirst && k <= kEvenLast;
            sums[k] += (is_even ? even : odd) * pair.weights[k];
        }
    }
    for (std::size_t k = 0; k < sums.size(); ++k) {
        std::memcpy(rows.d[k][component].data(), &sums[k], sizeof sums[k]);
    }
}

INKTRACE_MULTIVERSION
void estimate_rows(const DerivativeRows& rows, const Lanes<std::int32_t>& on_surface,
                   RidgeSettings settings, EstimateRows& __restrict out) {
    for (int i = 0; i < kLanes; ++i) {
        Derivatives d;
        for (std::size_t k = 0; k < d.size(); ++k) {
            d[k] = {rows.d[k][0][i], rows.d[k][1][i], rows.d[k][2][i]};
        }
        const RidgeEstimate estimate = estimate_from(d, settings);
        out.slope[i] = estimate.slope;
        out.along_x[i] = estimate.along.x;
        out.along_y[i] = estimate.along.y;
        out.strength[i] = on_surface[i] != 0 ? estimate.strength : 0.0F;
    }
}

/// Ridge estimates at the points of a grid inside its apron, and the lines through its cells.
class RidgeField {
  public:
    RidgeField(const SampleGrid& grid, int apron, const RidgePattern& pattern,
               const RidgeSettings& settings)
        : grid_(grid),
          apron_(apron),
          settings_(settings),
          columns_(grid.width - 2 * apron),
          rows_(grid.height - 2 * apron) {
        if (columns_ <= 0 || rows_ <= 0) return;
        for (const RidgePattern::Pair& pair : pattern.pairs) {
            const auto down = static_cast<std::ptrdiff_t>(pair.step.j);
            pairs_.push_back({down * grid_.width + pair.step.i, pair.weights});
        }
        // Rows of sixteen may end beyond the last one.
        const std::size_t size = index(0, rows_) + kLanes;
        for (auto* plane : {&slope_, &along_x_, &along_y_, &strength_}) plane->resize(size);
        for (int j = 0; j < rows_; ++j) {
            for (int i = 0; i < columns_; i += kLanes) estimate(i, j);
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

    std::size_t index(int i, int j) const {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(i);
    }

    void estimate(int i, int j) {
        const std::size_t first = grid_.index(i + apron_, j + apron_);
        Lanes<std::int32_t> on_surface;
        const std::size_t to = index(i, j);
        if (!on_one_surface(grid_, first, pairs_, on_surface)) {
            std::fill_n(strength_.begin() + static_cast<std::ptrdiff_t>(to), kLanes, 0.0F);
            return;
        }
        DerivativeRows derivatives;
        differentiate(grid_.nx.data() + first, pairs_, 0, derivatives);
        differentiate(grid_.ny.data() + first, pairs_, 1, derivatives);
        differentiate(grid_.nz.data() + first, pairs_, 2, derivatives);
        EstimateRows rows;
        estimate_rows(derivatives, on_surface, settings_, rows);
        const auto copy = [&](const Lanes<float>& lanes, std::vector<float>& plane) {
            std::ranges::copy(lanes, plane.begin() + static_cast<std::ptrdiff_t>(to));
        };
        copy(rows.slope, slope_);
        copy(rows.along_x, along_x_);
        copy(rows.along_y, along_y_);
        copy(rows.strength, strength_);
    }

    /// Where the slope changes its sign between two neighbours, as the sense of t1 allows.
    void cross(int i, int j, int di, int dj, std::vector<Crossing>& crossings) {
        const std::size_t a = index(i, j);
        const std::size_t b = index(i + di, j + dj);
        if (!(strength_[a] > 0.0F) || !(strength_[b] > 0.0F)) return;
        const float turn = along_x_[a] * along_x_[b] + along_y_[a] * along_y_[b];
        const float g = slope_[a];
        const float h = slope_[b] * (turn < 0.0F ? -1.0F : 1.0F);
        if ((g < 0.0F) == (h < 0.0F)) return;
        const float share = g / (g - h);
        const Vec2f from = grid_.point(i + apron_, j + apron_);
        const Vec2f to = grid_.point(i + di + apron_, j + dj + apron_);
        crossings.push_back(
            {from + (to - from) * share, strength_[a] + (strength_[b] - strength_[a]) * share});
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
    RidgeSettings settings_;
    std::vector<OppositePoints> pairs_;
    int columns_, rows_;
    std::vector<float> slope_, along_x_, along_y_, strength_;  ///< row by row
    std::vector<Crossing> crossings_;
};

}  // namespace

RidgePattern::RidgePattern(int radius, float spacing) {
    const std::vector<LatticeStep> steps = ridge_neighbourhood(radius);
    std::vector<Vec2f> points;
    for (const LatticeStep& step : steps) {
        points.push_back(
            {static_cast<float>(step.i) * spacing, static_cast<float>(step.j) * spacing});
    }
    const RidgeEstimator estimator(points, {});
    for (std::size_t k = 0; k < steps.size(); ++k) {
        const bool first_of_pair = steps[k].j > 0 || (steps[k].j == 0 && steps[k].i > 0);
        if (first_of_pair) pairs.push_back({steps[k], estimator.weights()[k]});
    }
}

void find_ridges(const SampleGrid& grid, int apron, const RidgePattern& pattern,
                 const RidgeSettings& settings, std::vector<Segment>& segments) {
    RidgeField(grid, apron, pattern, settings).connect(segments);
}

}  // namespace ink
