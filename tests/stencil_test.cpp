// The stencil's counts and strengths against their closed form at a straight edge.

#include "sampling/stencil.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lines/strength.h"

namespace ink::test {
namespace {

/// Strength by counting: the edge passes the sample at distance u (in radii) under an angle.
float counted_strength(const Metric& metric, int rings, double u, double angle) {
    const auto stencil = ring_stencil(1.0F, rings);
    int m = 0;
    for (const Vec2f p : stencil) {
        m += p.x * std::cos(angle) + p.y * std::sin(angle) > u ? 1 : 0;
    }
    return edge_strength(metric, m, static_cast<int>(stencil.size()));
}

/// Mean error of the counted strength over distances across a line and angles of 0 to 90 degrees.
double mean_error(const Metric& metric, int rings) {
    double sum = 0.0;
    int count = 0;
    for (int degree = 0; degree <= 90; degree += 3) {
        // A hair off the axes: there, ring points lie exactly on the edge and could count either
        // way.
        const double angle = (degree + 0.01) * std::numbers::pi / 180.0;
        for (double u = 0.005; u < 1.0; u += 0.01, ++count) {
            sum += std::abs(counted_strength(metric, rings, u, angle) -
                            straight_edge_strength(metric, u));
        }
    }
    return sum / count;
}

TEST(RingStencil, HasFourTimesNTimesNPlusOnePoints) {
    for (const int N : {1, 2, 3, 8}) {
        EXPECT_EQ(ring_stencil(2.0F, N).size(), static_cast<std::size_t>(4 * N * (N + 1)));
    }
}

TEST(RingStencil, ReachesExactlyItsRadius) {
    for (const Vec2f p : ring_stencil(2.5F, 3)) EXPECT_LE(std::hypot(p.x, p.y), 2.5F + 1e-6F);
    const auto stencil = ring_stencil(2.5F, 3);
    EXPECT_NEAR(std::hypot(stencil.back().x, stencil.back().y), 2.5F, 1e-6F);
}

TEST(RingStencil, StartsEachRingOnTheXAxis) {
    const auto stencil = ring_stencil(3.0F, 3);
    EXPECT_FLOAT_EQ(stencil[0].x, 1.0F);
    EXPECT_FLOAT_EQ(stencil[8].x, 2.0F);
    EXPECT_FLOAT_EQ(stencil[24].x, 3.0F);
    EXPECT_FLOAT_EQ(stencil[24].y, 0.0F);
}

TEST(EdgeStrength, PeaksWhereTheStencilIsSplitInHalf) {
    for (const Metric metric : {Metric{Metric::Kind::linear}, Metric{Metric::Kind::power, 4}}) {
        EXPECT_FLOAT_EQ(edge_strength(metric, 12, 24), 1.0F);
        EXPECT_FLOAT_EQ(edge_strength(metric, 0, 24), 0.0F);
        EXPECT_FLOAT_EQ(edge_strength(metric, 24, 24), 0.0F);
        for (int i = 0; i < 12; ++i) {
            EXPECT_LT(edge_strength(metric, i, 24), edge_strength(metric, i + 1, 24));
            EXPECT_FLOAT_EQ(edge_strength(metric, i, 24), edge_strength(metric, 24 - i, 24));
        }
    }
}

TEST(EdgeStrength, IsThePapersExampleOfNineRaysInTwentyFour) {
    // Figure 4(b) says 62.5 %, which is i = 7.5; equation 2 gives 75 % for its m = 9.
    EXPECT_FLOAT_EQ(edge_strength({Metric::Kind::linear}, 9, 24), 0.75F);
}

TEST(EdgeStrength, FollowsEquationThree) {
    const float expected = 1.0F - static_cast<float>(std::pow(1.0 - 2.0 * 3.0 / 24.0, 10.0));
    EXPECT_FLOAT_EQ(edge_strength({Metric::Kind::power, 10}, 3, 24), expected);
}

TEST(EdgeStrength, OfTheSolidMetricIsFullWhereverAnEdgeIsTouched) {
    const Metric solid{Metric::Kind::solid};
    EXPECT_EQ(edge_strength(solid, 0, 8), 0.0F);
    for (int i = 1; i <= 8; ++i) EXPECT_EQ(edge_strength(solid, i, 8), 1.0F);
}

TEST(EdgeStrength, ApproachesTheClosedFormAsRingsAreAdded) {
    const Metric linear{Metric::Kind::linear};
    double last = 1.0;
    for (const int N : {1, 2, 4, 8, 16}) {
        const double error = mean_error(linear, N);
        EXPECT_LT(error, last) << "N = " << N;
        if (N == 8) {
            EXPECT_LT(error, 0.03);
        }
        last = error;
    }
    EXPECT_LT(mean_error({Metric::Kind::power, 10}, 32), 0.03);
}

TEST(EdgeStrength, ClosedFormEndsAtTheRadiusAndStartsAtOne) {
    for (const Metric metric : {Metric{Metric::Kind::linear}, Metric{Metric::Kind::power, 10}}) {
        EXPECT_FLOAT_EQ(straight_edge_strength(metric, 0.0), 1.0F);
        EXPECT_EQ(straight_edge_strength(metric, 1.0), 0.0F);
        EXPECT_EQ(straight_edge_strength(metric, 7.0), 0.0F);
    }
}

TEST(EdgeStrength, IntegratesToTheKnownInkOfALine) {
    // Ink over nominal width in the limit: the integral of 2A(u) over [0, 1] is 4 / (3 pi).
    double ink = 0.0;
    for (int i = 0; i < 10000; ++i) {
        ink += straight_edge_strength({Metric::Kind::linear}, (i + 0.5) / 10000) / 10000;
    }
    EXPECT_NEAR(ink, 4.0 / (3.0 * std::numbers::pi), 1e-4);
}

TEST(Multisampling, UsesARegularGridForSquares) {
    const auto nine = multisample_offsets(9);
    ASSERT_EQ(nine.size(), 9U);
    EXPECT_NEAR(nine[0].x, -1.0F / 3.0F, 1e-6F);
    EXPECT_NEAR(nine[4].x, 0.0F, 1e-6F);
    EXPECT_NEAR(nine[8].y, 1.0F / 3.0F, 1e-6F);
}

TEST(Multisampling, StaysWithinThePixelForAnyCount) {
    for (int samples = 1; samples < 40; ++samples) {
        const auto offsets = multisample_offsets(samples);
        EXPECT_EQ(offsets.size(), static_cast<std::size_t>(samples));
        for (const Vec2f p : offsets) {
            EXPECT_LE(std::abs(p.x), 0.5F);
            EXPECT_LE(std::abs(p.y), 0.5F);
        }
    }
    EXPECT_EQ(multisample_offsets(1)[0], (Vec2f{0.0F, 0.0F}));
}

}  // namespace
}  // namespace ink::test
