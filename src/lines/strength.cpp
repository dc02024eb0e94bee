#include "lines/strength.h"

#include <cmath>
#include <numbers>

namespace ink {

namespace {

/// `foreign` is the share of the stencil that differs, in [0, 1].
double strength(const Metric& metric, double foreign) {
    const double off_balance = std::abs(2.0 * foreign - 1.0);
    switch (metric.kind) {
        case Metric::Kind::linear: return 1.0 - off_balance;
        case Metric::Kind::power: return 1.0 - std::pow(off_balance, metric.exponent);
        case Metric::Kind::solid: return foreign > 0.0 ? 1.0 : 0.0;
    }
    return 0.0;
}

}  // namespace

float edge_strength(const Metric& metric, int i, int M) {
    return static_cast<float>(strength(metric, static_cast<double>(i) / M));
}

float straight_edge_strength(const Metric& metric, double u) {
    if (u >= 1.0) return 0.0F;
    const double foreign = (std::acos(u) - u * std::sqrt(1.0 - u * u)) / std::numbers::pi;
    return static_cast<float>(strength(metric, foreign));
}

}  // namespace ink
