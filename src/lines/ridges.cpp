#include "lines/ridges.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "lines/ridge_estimate-inl.h"

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
    NormalDerivatives d{};
    const Vec3f base = normals[0];  // derivatives do not depend on it; rounding does
    for (std::size_t k = 0; k < normals.size(); ++k) {
        const Vec3f n = normals[k] - base;
        for (std::size_t i = 0; i < kDerivatives; ++i) d[i] = d[i] + n * weights_[k][i];
    }
    RidgeEstimate estimate = ridge_from(d, settings_);
    if (!(estimate.bend < 0.0F)) estimate.strength = 0.0F;
    return estimate;
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

}  // namespace ink
