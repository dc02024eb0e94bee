#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace ink {

/// c[0] + c[1] x + ... + c[N] x^N
template <std::size_t N>
using Polynomial = std::array<double, N + 1>;

template <std::size_t Count>
double evaluate(const std::array<double, Count>& c, double x) {
    double value = c[Count - 1];
    for (std::size_t k = Count - 1; k-- > 0;) value = value * x + c[k];
    return value;
}

/// Up to N numbers in ascending order.
template <std::size_t N>
struct Roots {
    std::array<double, N> x{};
    std::size_t count = 0;
    void add(double root) { x[count++] = root; }
};

/// The root of f between lo and hi, where its signs differ: Newton's steps, or halving where they
/// leave the bracket or shrink it too slowly. `f` gives value and derivative.
template <class Function>
double bracketed_root(const Function& f, double lo, double hi, bool rising) {
    double x = 0.5 * (lo + hi);
    double last_step = hi - lo;
    for (int k = 0; k < 100; ++k) {
        const auto [value, slope] = f(x);
        if (value == 0.0) return x;
        ((value < 0.0) == rising ? lo : hi) = x;
        double next = x - value / slope;
        // Written so that it also catches a slope of zero, which makes `next` no number.
        const bool converging = std::abs(next - x) < 0.5 * std::abs(last_step);
        if (!(next > lo && next < hi) || !converging) next = 0.5 * (lo + hi);
        if (next == x || !(next > lo && next < hi)) return next;
        last_step = next - x;
        x = next;
    }
    return x;
}

/// The real roots of a polynomial in [lo, hi]. Between neighbouring roots of its derivative a
/// polynomial is monotone, so that none is missed and none is invented, whatever the coefficients:
/// a leading one of zero is no special case. A root where the sign does not change may be left out.
template <std::size_t N>
Roots<N> real_roots(const Polynomial<N>& c, double lo, double hi) {
    Roots<N> roots;
    if constexpr (N == 1) {
        const double root = -c[0] / c[1];
        if (root >= lo && root <= hi) roots.add(root);
    } else {
        Polynomial<N - 1> derivative;
        for (std::size_t k = 0; k < N; ++k) derivative[k] = static_cast<double>(k + 1) * c[k + 1];
        const Roots<N - 1> turns = real_roots<N - 1>(derivative, lo, hi);
        const auto function = [&](double x) {
            return std::array{evaluate(c, x), evaluate(derivative, x)};
        };
        double from = lo;
        double at_from = evaluate(c, from);
        for (std::size_t k = 0; k <= turns.count; ++k) {
            const double to = k < turns.count ? turns.x[k] : hi;
            const double at_to = evaluate(c, to);
            if ((at_from < 0.0) != (at_to < 0.0)) {
                roots.add(bracketed_root(function, from, to, at_from < 0.0));
            }
            from = to;
            at_from = at_to;
        }
    }
    return roots;
}

}  // namespace ink
