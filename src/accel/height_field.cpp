#include "accel/height_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "accel/polynomial.h"

namespace ink {

namespace {

/// All values between two numbers.
struct Interval {
    double lo, hi;

    friend Interval operator+(Interval a, Interval b) { return {a.lo + b.lo, a.hi + b.hi}; }
    friend Interval operator-(Interval a, Interval b) { return {a.lo - b.hi, a.hi - b.lo}; }
    friend Interval operator*(Interval a, Interval b) {
        const auto [least, most] =
            std::minmax({a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi});
        return {least, most};
    }
    friend Interval operator*(Interval a, double s) {
        return s < 0.0 ? Interval{a.hi * s, a.lo * s} : Interval{a.lo * s, a.hi * s};
    }
    bool has_zero() const { return lo <= 0.0 && hi >= 0.0; }
};

/// The cosines of an interval of angles.
Interval cosine(Interval angle) {
    constexpr double kTurn = 2.0 * std::numbers::pi;
    if (angle.hi - angle.lo >= kTurn) return {-1.0, 1.0};
    const double a = std::cos(angle.lo);
    const double b = std::cos(angle.hi);
    Interval range{std::min(a, b), std::max(a, b)};
    const auto crosses = [&](double phase) {
        return std::floor((angle.hi - phase) / kTurn) > std::floor((angle.lo - phase) / kTurn);
    };
    if (crosses(0.0)) range.hi = 1.0;
    if (crosses(std::numbers::pi)) range.lo = -1.0;
    return range;
}

/// g(s) = z(s) - f(x(s), y(s)) along a ray, and its derivative, of numbers and of intervals.
class GaussianAlongRay {
  public:
    GaussianAlongRay(const UnitShape& shape, Vec3d o, Vec3d d)
        : k_(0.5 / (shape.a * shape.a)),
          r2_{o.x * o.x + o.y * o.y, 2.0 * (o.x * d.x + o.y * d.y), d.x * d.x + d.y * d.y},
          z_(o.z),
          dz_(d.z) {}

    std::array<double, 2> operator()(double s) const {
        const double f = std::exp(-k_ * evaluate(r2_, s));
        return {z_ + s * dz_ - f, dz_ + k_ * turn(s) * f};
    }
    std::array<Interval, 2> operator()(Interval s) const {
        const double a = evaluate(r2_, s.lo);
        const double b = evaluate(r2_, s.hi);
        const double middle = r2_[2] > 0.0 ? -0.5 * r2_[1] / r2_[2] : s.lo;
        const double least =
            middle > s.lo && middle < s.hi ? evaluate(r2_, middle) : std::min(a, b);
        const Interval f{std::exp(-k_ * std::max(a, b)), std::exp(-k_ * least)};
        const Interval z{z_ + std::min(s.lo * dz_, s.hi * dz_),
                         z_ + std::max(s.lo * dz_, s.hi * dz_)};
        const Interval turned{turn(s.lo), turn(s.hi)};
        return {z - f, Interval{dz_, dz_} + turned * f * k_};
    }

  private:
    double turn(double s) const { return r2_[1] + 2.0 * s * r2_[2]; }  ///< derivative of r2

    double k_;
    Polynomial<2> r2_;  ///< x^2 + y^2
    double z_, dz_;
};

/// cos u cos v = (cos(u + v) + cos(u - v)) / 2, whose angles are linear along a ray.
class WavesAlongRay {
  public:
    WavesAlongRay(const UnitShape& shape, Vec3d o, Vec3d d) : z_(o.z), dz_(d.z) {
        const double u = std::numbers::pi * shape.a;
        const double v = std::numbers::pi * shape.b;
        angle_ = {u * o.x + v * o.y, u * o.x - v * o.y};
        rate_ = {u * d.x + v * d.y, u * d.x - v * d.y};
    }

    std::array<double, 2> operator()(double s) const {
        std::array<double, 2> g{z_ + s * dz_, dz_};
        for (std::size_t k = 0; k < 2; ++k) {
            const double angle = angle_[k] + s * rate_[k];
            g[0] -= 0.5 * std::cos(angle);
            g[1] += 0.5 * rate_[k] * std::sin(angle);
        }
        return g;
    }
    std::array<Interval, 2> operator()(Interval s) const {
        std::array<Interval, 2> g{s * dz_ + Interval{z_, z_}, {dz_, dz_}};
        for (std::size_t k = 0; k < 2; ++k) {
            const Interval angle = s * rate_[k] + Interval{angle_[k], angle_[k]};
            constexpr double kQuarter = std::numbers::pi / 2.0;
            const Interval sine = cosine({angle.lo - kQuarter, angle.hi - kQuarter});
            g[0] = g[0] - cosine(angle) * 0.5;
            g[1] = g[1] + sine * (0.5 * rate_[k]);
        }
        return g;
    }

  private:
    double z_, dz_;
    std::array<double, 2> angle_{}, rate_{};
};

/// The first sign change of g in [lo, hi]. An interval in which g has no zero is done with, one in
/// which its derivative has none is searched, any other is halved. What is left at the least width
/// is a surface seen edge on. A ray that lies in the surface would be halved without end: `budget`
/// is for so many intervals, a hundred times what any other ray takes.
template <class Function>
std::optional<double> first_zero(const Function& g, double lo, double hi, int& budget) {
    constexpr double kLeastWidth = 1e-9;
    if (--budget < 0) return std::nullopt;
    const auto [value, slope] = g(Interval{lo, hi});
    if (!value.has_zero()) return std::nullopt;
    if (!slope.has_zero() || hi - lo < kLeastWidth) {
        const bool below = g(lo)[0] < 0.0;
        if (below == (g(hi)[0] < 0.0)) return std::nullopt;
        return bracketed_root(g, lo, hi, below);
    }
    const double middle = 0.5 * (lo + hi);
    if (const auto first = first_zero(g, lo, middle, budget)) return first;
    return first_zero(g, middle, hi, budget);
}

}  // namespace

std::optional<double> first_on_height_field(const UnitShape& shape, Vec3d o, Vec3d d, double lo,
                                            double hi) {
    int budget = 4096;
    return shape.kind == GlyphKind::gaussian
               ? first_zero(GaussianAlongRay(shape, o, d), lo, hi, budget)
               : first_zero(WavesAlongRay(shape, o, d), lo, hi, budget);
}

Slopes height_field_slopes(const UnitShape& shape, double x, double y) {
    if (shape.kind == GlyphKind::gaussian) {
        const double k = 1.0 / (shape.a * shape.a);
        const double f = std::exp(-0.5 * k * (x * x + y * y));
        return {-k * x * f, -k * y * f};
    }
    const double u = std::numbers::pi * shape.a;
    const double v = std::numbers::pi * shape.b;
    return {-u * std::sin(u * x) * std::cos(v * y), -v * std::cos(u * x) * std::sin(v * y)};
}

}  // namespace ink
