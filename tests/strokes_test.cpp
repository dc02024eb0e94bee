// Cutting curves by length, and chains into strokes of one width.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lines/curve.h"
#include "vector/strokes.h"

namespace ink::test {
namespace {

/// A quarter of a circle about the origin and a straight way on.
Curve bent(float radius = 100.0F) {
    const float reach = 0.5522848F * radius;
    Curve curve{{radius, 0.0F}, {}};
    curve.pieces.push_back({{radius, reach}, {reach, radius}, {0.0F, radius}, false});
    curve.pieces.push_back(straight_piece({0.0F, radius}, {-radius, radius}));
    return curve;
}

double length_of(const Curve& curve) { return MeasuredCurve(curve).length(); }

TEST(MeasuredCurve, KnowsTheLengthOfAnArc) {
    EXPECT_NEAR(length_of(bent()), 100.0 * (0.5 * std::numbers::pi + 1.0), 0.1);
}

TEST(MeasuredCurve, PartsMeetExactlyAndAreTheWholeCurve) {
    const Curve whole = bent();
    const MeasuredCurve measured(whole);
    const std::vector<double> cuts{0.0, 0.1, 0.35, 0.36, 0.7, 0.95, 1.0};
    Vec2f end = whole.start;
    double total = 0.0;
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
        const Curve part = measured.part(cuts[k], cuts[k + 1]);
        EXPECT_EQ(part.start, end);
        end = part.end();
        EXPECT_NEAR(length_of(part), (cuts[k + 1] - cuts[k]) * measured.length(), 0.05);
        total += length_of(part);
        for (std::size_t n = 0; n < part.pieces.size(); ++n) {
            const Vec2f start = n == 0 ? part.start : part.pieces[n - 1].end;
            for (const double u : {0.0, 0.3, 0.8, 1.0}) {
                const Vec2d p = point_at(start, part.pieces[n], u);
                const double off = p.x > 0.0 ? std::abs(length(p) - 100.0) : std::abs(p.y - 100.0);
                EXPECT_LT(off, 0.04);
            }
        }
    }
    EXPECT_EQ(end, whole.end());
    EXPECT_NEAR(total, measured.length(), 1e-3 * measured.length());
}

/// The points of `bent` about every pixel.
Chain chain_along(const Curve& curve) {
    Chain chain;
    Vec2f start = curve.start;
    for (const CurvePiece& piece : curve.pieces) {
        for (int k = 0; k < 100; ++k) {
            chain.points.push_back(to_float(point_at(start, piece, k / 100.0)));
        }
        start = piece.end;
    }
    chain.points.push_back(curve.end());
    chain.t.assign(chain.points.size(), 1.0F);
    chain.strengths.assign(chain.points.size(), 1.0F);
    return chain;
}

TEST(Strokes, AreOneWhereNothingChanges) {
    const Curve curve = bent();
    const Chain chain = chain_along(curve);
    const auto strokes = make_strokes(chain, curve, weigh(chain, 2.5, {}));
    ASSERT_EQ(strokes.size(), 1U);
    EXPECT_NEAR(strokes[0].width_px, 2.5, 1e-6);
    EXPECT_NEAR(strokes[0].opacity, 1.0, 1e-6);
    EXPECT_TRUE(strokes[0].fade.empty());
    EXPECT_EQ(strokes[0].curve.start, curve.start);
    EXPECT_EQ(strokes[0].curve.end(), curve.end());
}

TEST(Strokes, FollowAWidthThatChanges) {
    const Curve curve = bent();
    const Chain chain = chain_along(curve);
    LineWeights weights = weigh(chain, 3.0, {});
    const auto wanted = [](double share) { return 3.0 - 2.0 * share; };
    const std::size_t last = chain.points.size() - 1;
    for (std::size_t k = 0; k <= last; ++k) {
        weights.width[k] =
            static_cast<float>(wanted(static_cast<double>(k) / static_cast<double>(last)));
    }
    const auto strokes = make_strokes(chain, curve, weights);
    EXPECT_GT(strokes.size(), 5U);
    EXPECT_LT(strokes.size(), 20U);
    double total = 0.0;
    for (std::size_t k = 0; k < strokes.size(); ++k) {
        EXPECT_NEAR(strokes[k].begins_at, total, 0.1);
        total += length_of(strokes[k].curve);
        if (k == 0) continue;
        EXPECT_EQ(strokes[k].curve.start, strokes[k - 1].curve.end());
        EXPECT_LT(strokes[k].width_px, strokes[k - 1].width_px);
    }
    EXPECT_NEAR(total, length_of(curve), 0.1);
}

TEST(Strokes, FadeAlongStraightWaysOnly) {
    const Curve curve = bent();
    Chain chain = chain_along(curve);
    const std::size_t last = chain.points.size() - 1;
    for (std::size_t k = 0; k <= last; ++k) {
        chain.strengths[k] = static_cast<float>(k) / static_cast<float>(last);
    }
    const auto strokes = make_strokes(chain, curve, weigh(chain, 3.0, {}));
    ASSERT_FALSE(strokes.empty());
    double before = 0.0;
    for (const Stroke& stroke : strokes) {
        ASSERT_GE(stroke.fade.size(), 2U);
        EXPECT_EQ(stroke.fade.front().offset, 0.0);
        EXPECT_EQ(stroke.fade.back().offset, 1.0);
        EXPECT_NEAR(stroke.fade.front().opacity, before, 1e-6);
        EXPECT_TRUE(std::ranges::is_sorted(stroke.fade, {}, &Stroke::Stop::offset));
        before = stroke.fade.back().opacity;
    }
    EXPECT_NEAR(before, 1.0, 1e-6);
}

TEST(Strokes, OfAClosedLineCloseWhereNothingChanges) {
    Curve circle = bent(50.0F);
    circle.pieces.pop_back();
    Chain chain = chain_along(circle);
    chain.closed = true;
    auto strokes = make_strokes(chain, circle, weigh(chain, 3.0, {}));
    ASSERT_EQ(strokes.size(), 1U);
    EXPECT_TRUE(strokes[0].closed);
    for (std::size_t k = 20; k < 60; ++k) chain.strengths[k] = 0.5F;
    strokes = make_strokes(chain, circle, weigh(chain, 3.0, {}));
    EXPECT_GT(strokes.size(), 1U);
    for (const Stroke& stroke : strokes) EXPECT_FALSE(stroke.closed);
}

TEST(Strokes, LeaveOutWhatCannotBeSeen) {
    const Curve curve = bent();
    Chain chain = chain_along(curve);
    std::ranges::fill(chain.strengths, 0.0F);
    EXPECT_TRUE(make_strokes(chain, curve, weigh(chain, 3.0, {})).empty());
}

TEST(Strokes, StandPointsThatRepeat) {
    const Curve curve{{1, 1}, {straight_piece({1, 1}, {1, 1})}};
    Chain chain;
    chain.points.assign(5, {1, 1});
    chain.t.assign(5, 1.0F);
    chain.strengths = {0.0F, 1.0F, 0.2F, 0.9F, 0.4F};
    for (const Stroke& stroke : make_strokes(chain, curve, weigh(chain, 3.0, {}))) {
        EXPECT_TRUE(std::isfinite(stroke.width_px + stroke.opacity));
        for (const auto& stop : stroke.fade) EXPECT_TRUE(std::isfinite(stop.offset));
    }
}

}  // namespace
}  // namespace ink::test
