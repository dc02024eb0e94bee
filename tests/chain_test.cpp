// Chaining line segments and fitting curves to the chains, on invented lines.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "lines/chain.h"
#include "lines/chain_lines.h"
#include "lines/corners.h"
#include "lines/fit.h"
#include "lines/fit_chains.h"
#include "lines/junctions.h"

namespace ink::test {
namespace {

Segment segment(Vec2f a, Vec2f b, GeometryId left = 1, GeometryId right = 0,
                LineType type = LineType::silhouette) {
    Segment made;
    made.a = a;
    made.b = b;
    made.type = made.type_at_b = type;
    made.left = made.left_at_b = left;
    made.right = made.right_at_b = right;
    made.t = 1.0F;
    made.spans_cell = true;
    return made;
}

/// The straight segments between neighbouring points.
std::vector<Segment> along(const std::vector<Vec2f>& points, bool closed) {
    std::vector<Segment> segments;
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
        segments.push_back(segment(points[k], points[k + 1]));
    }
    if (closed) segments.push_back(segment(points.back(), points.front()));
    return segments;
}

/// Where a curve given by its angle crosses the lattice through pixel centres, in order, with the
/// error that bisection leaves: crossings are in the middle of the last interval.
std::vector<Vec2f> crossings(const std::function<Vec2d(double)>& curve, double from, double to,
                             double interval = 1.0 / 64.0) {
    std::vector<Vec2f> points;
    const int steps = 400000;
    Vec2d last = curve(from);
    const auto cell = [](double x) { return std::floor(x - 0.5); };
    const auto snap = [&](double x) {
        return (std::floor((x - 0.5) / interval) + 0.5) * interval + 0.5;
    };
    for (int k = 1; k <= steps; ++k) {
        const Vec2d next = curve(from + (to - from) * k / steps);
        if (cell(next.x) != cell(last.x)) {
            const double x = std::max(cell(next.x), cell(last.x)) + 0.5;
            points.push_back(to_float(Vec2d{x, snap(next.y)}));
        } else if (cell(next.y) != cell(last.y)) {
            const double y = std::max(cell(next.y), cell(last.y)) + 0.5;
            points.push_back(to_float(Vec2d{snap(next.x), y}));
        }
        last = next;
    }
    return points;
}

std::function<Vec2d(double)> ellipse(Vec2d centre, double a, double b) {
    return [=](double angle) { return centre + Vec2d{a * std::cos(angle), b * std::sin(angle)}; };
}

constexpr double kTurn = 2.0 * std::numbers::pi;

const std::vector<Vec2d> kCorners{{10.2, 10.8}, {90.7, 20.4}, {70.9, 80.3}, {21.1, 61.6}};

/// Round a polygon, one side for each unit of s.
Vec2d polygon(double s) {
    const auto k = static_cast<std::size_t>(s) % kCorners.size();
    const double share = s - std::floor(s);
    return kCorners[k] * (1.0 - share) + kCorners[(k + 1) % kCorners.size()] * share;
}

double distance_from_corners(Vec2f point) {
    double nearest = 1e9;
    for (const Vec2d corner : kCorners) {
        nearest = std::min(nearest, length(to_double(point) - corner));
    }
    return nearest;
}

Vec2d on_curve(Vec2f start, const CurvePiece& piece, double u) {
    const double v = 1.0 - u;
    return to_double(start) * (v * v * v) + to_double(piece.control1) * (3 * u * v * v) +
           to_double(piece.control2) * (3 * u * u * v) + to_double(piece.end) * (u * u * u);
}

std::vector<Vec2d> sampled(const Curve& curve, int steps = 64) {
    std::vector<Vec2d> points{to_double(curve.start)};
    Vec2f at = curve.start;
    for (const CurvePiece& piece : curve.pieces) {
        for (int k = 1; k <= steps; ++k) {
            points.push_back(on_curve(at, piece, static_cast<double>(k) / steps));
        }
        at = piece.end;
    }
    return points;
}

std::vector<Curve> fit(const std::vector<Vec2f>& points, bool closed,
                       std::vector<std::size_t> cuts = {}) {
    if (cuts.empty()) cuts = {0, closed ? points.size() : points.size() - 1};
    std::vector<Curve> curves;
    CurveFitter(FitSettings{}).fit(points, closed, cuts, curves);
    return curves;
}

// Chains

TEST(Chains, JoinACirclesSegmentsIntoOneClosedChain) {
    const std::vector<Vec2f> points = crossings(ellipse({30, 30}, 20, 20), 0.1, 0.1 + kTurn);
    const ChainGraph graph = chain_segments(along(points, true), 1.0F);
    ASSERT_EQ(graph.chains.size(), 1U);
    EXPECT_TRUE(graph.chains[0].closed);
    EXPECT_EQ(graph.chains[0].points.size(), points.size());
    EXPECT_EQ(graph.chains[0].points.size(), graph.chains[0].t.size());
    EXPECT_NEAR(length_of(graph.chains[0]), kTurn * 20.0, 0.5);
    ASSERT_EQ(graph.paths.size(), 1U);
    EXPECT_TRUE(graph.paths[0].closed);
}

TEST(Chains, DoNotDependOnTheOrderOfSegments) {
    std::vector<Segment> segments = along(crossings(ellipse({30, 30}, 20, 9), 0, kTurn), true);
    for (const Segment& more : along(crossings(ellipse({70, 40}, 15, 15), 0, 4), false)) {
        segments.push_back(more);
    }
    const ChainGraph expected = chain_segments(segments, 1.0F);
    std::mt19937 random(7);
    for (int round = 0; round < 5; ++round) {
        std::shuffle(segments.begin(), segments.end(), random);
        const ChainGraph graph = chain_segments(segments, 1.0F);
        ASSERT_EQ(graph.chains.size(), expected.chains.size());
        for (std::size_t k = 0; k < graph.chains.size(); ++k) {
            EXPECT_EQ(graph.chains[k].points, expected.chains[k].points);
        }
    }
}

TEST(Chains, KeepGeometriesOnTheirSidesWhicheverWaySegmentsRun) {
    const std::vector<Segment> segments{segment({0.5F, 1}, {1.5F, 1}, 5, 6),
                                        segment({2.5F, 1}, {1.5F, 1}, 6, 5),
                                        segment({2.5F, 1}, {3.5F, 1}, 5, 6)};
    const ChainGraph graph = chain_segments(segments, 1.0F);
    ASSERT_EQ(graph.chains.size(), 1U);
    const Chain& chain = graph.chains[0];
    const bool rightwards = chain.points.front().x < chain.points.back().x;
    EXPECT_EQ(chain.left, rightwards ? 5U : 6U);
    EXPECT_EQ(chain.right, rightwards ? 6U : 5U);
}

/// A line from left to right, on which another one ends from below in the third cell.
std::vector<Segment> tee() {
    std::vector<Segment> segments;
    for (int k = 0; k < 6; ++k) {
        const float x = 0.5F + static_cast<float>(k);
        segments.push_back(segment({x, 1}, {x + 1, 1}, 1, k < 2 ? 2 : 3));
    }
    // The line that goes through knows what is behind it on its two ends.
    segments[2].right = 2;
    segments[2].right_at_b = 3;
    segments.push_back(segment({3, 1.5F}, {3, 1}, 2, 3));
    segments.back().spans_cell = false;
    segments.push_back(segment({3, 2.5F}, {3, 1.5F}, 2, 3));
    segments.push_back(segment({3, 3.5F}, {3, 2.5F}, 2, 3));
    return segments;
}

TEST(Chains, AreSplitWhereAnotherLineEndsOnThem) {
    const ChainGraph graph = chain_segments(tee(), 1.0F);
    ASSERT_EQ(graph.chains.size(), 3U);
    int at_junction = 0;
    for (const Chain& chain : graph.chains) {
        for (const Vec2f end : {chain.points.front(), chain.points.back()}) {
            at_junction += end == Vec2f{3, 1} ? 1 : 0;
        }
        if (chain.left == 1 && chain.right == 2) {
            EXPECT_LE(std::max(chain.points.front().x, chain.points.back().x), 3.0F);
        }
        if (chain.left == 1 && chain.right == 3) {
            EXPECT_GE(std::min(chain.points.front().x, chain.points.back().x), 3.0F);
        }
    }
    EXPECT_EQ(at_junction, 3);
}

TEST(Chains, ThatGoOnPastTheEndOfAnotherLineAreOnePath) {
    const ChainGraph graph = chain_segments(tee(), 1.0F);
    std::vector<std::size_t> sizes;
    for (const Path& path : graph.paths) sizes.push_back(path.steps.size());
    std::ranges::sort(sizes);
    EXPECT_EQ(sizes, (std::vector<std::size_t>{1, 2}));
}

TEST(Chains, EndWhereTheTypeChangesForLongerThanALineIsWide) {
    std::vector<Segment> segments;
    for (int k = 0; k < 20; ++k) {
        const float x = 0.5F + static_cast<float>(k);
        const bool seam = k >= 10 || k == 4;  // one crossing alone is no stretch of its own
        segments.push_back(segment({x, 1}, {x + 1, 1}, 1, 2,
                                   seam ? LineType::intersection : LineType::silhouette));
    }
    const ChainGraph graph = chain_segments(segments, 1.0F);
    ASSERT_EQ(graph.chains.size(), 2U);
    EXPECT_NE(graph.chains[0].type, graph.chains[1].type);
    EXPECT_EQ(graph.paths.size(), 1U);
}

TEST(Junctions, MoveToWhereTheirLinesPoint) {
    // Three straight lines that meet at (10.2, 10.3), joined in the middle of their crossings.
    const Vec2d meeting{10.2, 10.3};
    std::vector<Segment> segments;
    std::vector<Vec2f> entries;
    GeometryId id = 1;
    for (const double angle : {0.3, 2.3, 4.4}) {
        const auto ray = [&](double s) {
            return meeting + Vec2d{s * std::cos(angle), s * std::sin(angle)};
        };
        const std::vector<Vec2f> points = crossings(ray, 0.0, 8.0);
        for (Segment piece : along(points, false)) {
            piece.left = piece.left_at_b = id;
            piece.right = piece.right_at_b = id % 3 + 1;
            segments.push_back(piece);
        }
        entries.push_back(points.front());
        ++id;
    }
    const Vec2f middle = (entries[0] + entries[1] + entries[2]) * (1.0F / 3.0F);
    ASSERT_GT(length(to_double(middle) - meeting), 0.1);
    id = 1;
    for (const Vec2f entry : entries) {
        segments.push_back(segment(entry, middle, id % 3 + 1, id));
        segments.back().spans_cell = false;
        ++id;
    }
    ChainGraph graph = chain_segments(segments, 1.0F);
    place_junctions(graph, 1.0F);
    ASSERT_EQ(graph.chains.size(), 3U);
    Vec2f junction{};
    for (const Chain& chain : graph.chains) {
        const double front = length(to_double(chain.points.front()) - meeting);
        const double back = length(to_double(chain.points.back()) - meeting);
        EXPECT_LT(std::min(front, back), 0.06);
        const Vec2f end = front < back ? chain.points.front() : chain.points.back();
        if (junction == Vec2f{}) junction = end;
        EXPECT_EQ(end, junction);
    }
}

/// A line from left to right between geometry 1 and, below it, 2, 3 and 4 in turn: lines between
/// these end on it at two places.
std::vector<Segment> two_tees(float first, float second) {
    std::vector<Segment> segments;
    const auto below = [&](float x) -> GeometryId { return x < first ? 2 : x < second ? 3 : 4; };
    for (int k = 0; k < 20; ++k) {
        const float x = 0.5F + static_cast<float>(k);
        std::vector<float> ends{x};
        for (const float cut : {first, second}) {
            if (cut > x && cut < x + 1) ends.push_back(cut);
        }
        ends.push_back(x + 1);
        for (std::size_t n = 0; n + 1 < ends.size(); ++n) {
            const GeometryId id = below(0.5F * (ends[n] + ends[n + 1]));
            segments.push_back(segment({ends[n], 1}, {ends[n + 1], 1}, 1, id));
        }
    }
    GeometryId id = 2;
    for (const float x : {first, second}) {
        for (int k = 0; k < 8; ++k) {
            const float y = k == 0 ? 1.0F : 0.5F + static_cast<float>(k);
            const float next = 1.5F + static_cast<float>(k);
            segments.push_back(segment({x, next}, {x, y}, id, id + 1));
            if (k == 0) segments.back().spans_cell = false;
        }
        ++id;
    }
    return segments;
}

TEST(NearJunctions, AreOneWithinAPixelOfEachOther) {
    const ChainGraph apart = chain_lines(two_tees(8.2F, 11.1F), 1.0F, 1);
    EXPECT_EQ(apart.chains.size(), 5U);
    const ChainGraph graph = chain_lines(two_tees(8.2F, 8.9F), 1.0F, 1);
    ASSERT_EQ(graph.chains.size(), 4U);
    const auto vertex_near = [](const Chain& chain) {
        const bool first = length(chain.points.front() - Vec2f{8.55F, 1}) < 1.0F;
        return first ? std::pair(chain.first_vertex, chain.points.front())
                     : std::pair(chain.last_vertex, chain.points.back());
    };
    for (const Chain& chain : graph.chains) {
        EXPECT_EQ(vertex_near(chain), vertex_near(graph.chains[0]));
        EXPECT_NEAR(static_cast<double>(vertex_near(chain).second.y), 1.0, 0.01);
    }
    // The line that goes through is one path still, and straight.
    EXPECT_EQ(graph.paths.size(), 3U);
}

TEST(NearJunctions, CloseWhatIsSeenThroughAHoleOfHalfAPixel) {
    std::vector<Segment> segments;
    for (int k = 0; k < 12; ++k) {
        const float x = 0.5F + static_cast<float>(k);
        if (k != 5) segments.push_back(segment({x, 1}, {x + 1, 1}, 1, 2));
    }
    segments.push_back(segment({5.5F, 1}, {5.7F, 1}, 1, 2));
    segments.push_back(segment({5.7F, 1}, {6.0F, 0.9F}, 1, 3));
    segments.push_back(segment({6.0F, 0.9F}, {6.2F, 1}, 1, 3));
    segments.push_back(segment({5.7F, 1}, {6.2F, 1}, 3, 2));
    segments.push_back(segment({6.2F, 1}, {6.5F, 1}, 1, 2));
    EXPECT_EQ(chain_segments(segments, 1.0F).chains.size(), 4U);
    const ChainGraph graph = chain_lines(segments, 1.0F, 1);
    ASSERT_EQ(graph.chains.size(), 1U);
    EXPECT_NEAR(length_of(graph.chains[0]), 12.0, 0.1);
}

namespace {

/// Once round an ellipse, with what is in front outside or inside.
std::vector<Segment> ellipse(Vec2f radii, bool hole) {
    constexpr int kCount = 32;
    std::vector<Segment> segments;
    const auto at = [&](int k) {
        const double angle = 2.0 * std::numbers::pi * (k % kCount) / kCount;
        return Vec2f{9.6F + radii.x * static_cast<float>(std::cos(angle)),
                     7.3F + radii.y * static_cast<float>(std::sin(angle))};
    };
    for (int k = 0; k < kCount; ++k) {
        // Clockwise on the screen: the inside is on the right.
        Segment piece = hole ? segment(at(k), at(k + 1), 1, 0) : segment(at(k), at(k + 1), 0, 1);
        piece.left_in_front = piece.left_in_front_at_b = hole;
        segments.push_back(piece);
    }
    return segments;
}

}  // namespace

TEST(Pinholes, AreNoLinesIfNarrowerThanAPixel) {
    EXPECT_EQ(chain_lines(ellipse({0.4F, 0.4F}, true), 1.0F, 1).chains.size(), 0U);
    EXPECT_EQ(chain_lines(ellipse({0.6F, 0.6F}, true), 1.0F, 1).chains.size(), 1U);
    // A slit, whose width counts.
    EXPECT_EQ(chain_lines(ellipse({1.5F, 0.2F}, true), 1.0F, 1).chains.size(), 0U);
    EXPECT_GE(chain_lines(ellipse({4.0F, 0.2F}, true), 1.0F, 1).chains.size(), 1U);
}

TEST(Pinholes, AreNotThingsAsSmall) {
    EXPECT_EQ(chain_lines(ellipse({0.2F, 0.2F}, false), 1.0F, 1).chains.size(), 1U);
}

TEST(NearJunctions, AreOneWhateverTheWayBetweenThem) {
    // Its ends are 0.9 pixels apart, the way is 1.16 pixels long: a lattice sees more or less of
    // the bend.
    std::vector<Segment> segments = two_tees(8.2F, 9.1F);
    for (Segment& piece : segments) {
        for (Vec2f* end : {&piece.a, &piece.b}) {
            if (*end == Vec2f{8.5F, 1}) *end = {8.5F, 1.35F};
        }
    }
    EXPECT_EQ(chain_lines(segments, 1.0F, 1).chains.size(), 4U);
}

/// A crease and a fold come to one corner of an outline at an acute angle. A lattice sees them meet
/// for a while, part, and meet again: between two junctions they are two.
TEST(Twins, AreOneLineWhereASlitLiesBetween) {
    const auto lines = [](float apart) {
        std::vector<Segment> segments;
        const auto add = [&](std::vector<Vec2f> points, LineType type, GeometryId right) {
            for (std::size_t k = 0; k + 1 < points.size(); ++k) {
                segments.push_back(segment(points[k], points[k + 1], 1, right));
                segments.back().type = segments.back().type_at_b = type;
            }
        };
        add({{0.5F, 0}, {0.5F, 1}, {0.5F, 2}, {0.5F, 3}, {0.5F, 4}}, LineType::silhouette, 0);
        add({{0.5F, 2}, {1.5F, 2}, {2.5F, 2}}, LineType::self_occlusion, 1);
        add({{0.5F, 2}, {1.5F, 2 + apart}, {2.5F, 2}}, LineType::crease, 1);
        add({{2.5F, 2}, {5.5F, 1.5F}, {9.5F, 1}}, LineType::self_occlusion, 1);
        add({{2.5F, 2}, {5.5F, 2.5F}, {9.5F, 3}}, LineType::crease, 1);
        return chain_lines(segments, 1.0F, 1);
    };
    const auto count = [](const ChainGraph& graph, LineType type) {
        return std::ranges::count(graph.chains, type, &Chain::type);
    };
    const ChainGraph near = lines(0.4F);
    EXPECT_EQ(count(near, LineType::silhouette), 2);
    EXPECT_EQ(count(near, LineType::self_occlusion), 2);
    EXPECT_EQ(count(near, LineType::crease), 1);
    EXPECT_EQ(count(lines(1.6F), LineType::crease), 2);
}

// Corners

TEST(Corners, SplitAClosedLineIntoItsSides) {
    ChainGraph graph = chain_segments(along(crossings(polygon, 0.5, 4.5), true), 1.0F);
    const double round = length_of(graph.chains[0]);
    split_at_corners(graph, 1);
    ASSERT_EQ(graph.chains.size(), 4U);
    ASSERT_EQ(graph.paths.size(), 1U);
    ASSERT_EQ(graph.paths[0].steps.size(), 4U);
    const std::vector<Curve> curves = fit_chains(graph, {}, 1);
    for (std::size_t k = 0; k < 4; ++k) {
        const PathStep& step = graph.paths[0].steps[k];
        const Chain& side = graph.chains[step.chain];
        const Chain& next = graph.chains[graph.paths[0].steps[(k + 1) % 4].chain];
        EXPECT_TRUE(step.at_corner);
        EXPECT_FALSE(side.closed);
        EXPECT_EQ(side.last_vertex, next.first_vertex);
        EXPECT_EQ(side.points.back(), next.points.front());
        EXPECT_LT(distance_from_corners(side.points.front()), 0.06);
        EXPECT_EQ(side.t.size(), side.points.size());
        EXPECT_EQ(side.strengths.size(), side.points.size());
        EXPECT_NEAR(side.whole.length, round, 0.5);
        EXPECT_EQ(curves[step.chain].pieces.size(), 1U);
        EXPECT_TRUE(curves[step.chain].pieces[0].straight);
    }
}

TEST(Corners, SplitAnOpenLineWhicheverWayItRuns) {
    std::vector<Vec2f> points = crossings(polygon, 0.2, 1.8);
    for (const bool reversed : {false, true}) {
        ChainGraph graph = chain_segments(along(points, false), 1.0F);
        split_at_corners(graph, 1);
        ASSERT_EQ(graph.chains.size(), 2U) << reversed;
        EXPECT_EQ(graph.chains[0].last_vertex, graph.chains[1].first_vertex);
        EXPECT_LT(distance_from_corners(graph.chains[0].points.back()), 0.06);
        const std::vector<Curve> curves = fit_chains(graph, {}, 1);
        EXPECT_EQ(curves[0].end(), curves[1].start);
        std::ranges::reverse(points);
    }
}

TEST(Corners, LeaveALineWithOneOfThemClosedAndLetItStartThere) {
    // A drop with its tip at (10.3, 50.6).
    const auto drop = [](double angle) {
        const double swing = std::abs(std::sin(0.5 * angle));
        return Vec2d{10.3 + 60.0 * swing * swing, 50.6 + 25.0 * swing * std::sin(angle)};
    };
    ChainGraph graph = chain_segments(along(crossings(drop, 2.0, 2.0 + kTurn), true), 1.0F);
    split_at_corners(graph, 1);
    ASSERT_EQ(graph.chains.size(), 1U);
    EXPECT_TRUE(graph.chains[0].closed);
    EXPECT_LT(length(to_double(graph.chains[0].points.front()) - Vec2d{10.3, 50.6}), 0.3);
    const std::vector<Curve> curves = fit_chains(graph, {}, 1);
    EXPECT_EQ(curves[0].start, graph.chains[0].points.front());
    EXPECT_EQ(curves[0].end(), curves[0].start);
}

TEST(Corners, AreNotSeenOnSmoothLines) {
    for (const double radius : {1.7, 3.0, 10.0, 50.0, 200.0}) {
        const Vec2d centre{2 * radius + 3.3, radius + 4.7};
        for (const double longer : {1.0, 1.5}) {
            const auto points = crossings(ellipse(centre, longer * radius, radius), 0, kTurn);
            ChainGraph graph = chain_segments(along(points, true), 1.0F);
            split_at_corners(graph, 1);
            ASSERT_EQ(graph.chains.size(), 1U) << radius;
            EXPECT_TRUE(graph.chains[0].closed);
        }
    }
}

// Curves

TEST(Fit, NeedsAtMostSixNodesForAFullCircle) {
    for (const double radius : {1.7, 3.0, 10.0, 50.0, 200.0, 500.0, 1000.0}) {
        const Vec2d centre{radius + 3.3, radius + 4.7};
        const auto curves = fit(crossings(ellipse(centre, radius, radius), 0.2, 0.2 + kTurn), true);
        ASSERT_EQ(curves.size(), 1U);
        EXPECT_LE(curves[0].pieces.size(), 6U) << radius;
        EXPECT_EQ(curves[0].pieces.back().end, curves[0].start);
        // Between points that are as far apart as the radius, a curve has some freedom.
        const double tolerance = radius < 2.0 ? 0.2 : 0.11;
        for (const Vec2d point : sampled(curves[0])) {
            EXPECT_NEAR(length(point - centre), radius, tolerance) << radius;
        }
    }
}

TEST(Fit, TurnsSmoothlyWhereTwoPiecesMeet) {
    const auto curves = fit(crossings(ellipse({150, 80}, 140, 60), 0.2, 0.2 + kTurn), true);
    const std::vector<CurvePiece>& pieces = curves[0].pieces;
    EXPECT_LE(pieces.size(), 8U);
    for (std::size_t k = 0; k < pieces.size(); ++k) {
        const CurvePiece& next = pieces[(k + 1) % pieces.size()];
        const Vec2d in = to_double(pieces[k].end) - to_double(pieces[k].control2);
        const Vec2d out = to_double(next.control1) - to_double(pieces[k].end);
        EXPECT_LT(std::abs(cross(in, out)) / (length(in) * length(out)), 1e-3);
        EXPECT_GT(dot(in, out), 0.0);
    }
}

TEST(Fit, MakesAStraightRunOnePiece) {
    for (const double angle : {0.0, 0.02, 0.5, 0.785, 1.1, 1.57}) {
        const auto line = [&](double s) {
            return Vec2d{3.3 + s * std::cos(angle), 4.1 + s * std::sin(angle)};
        };
        const auto curves = fit(crossings(line, 0.0, 300.0), false);
        ASSERT_EQ(curves.size(), 1U);
        EXPECT_EQ(curves[0].pieces.size(), 1U) << angle;
        EXPECT_TRUE(curves[0].pieces[0].straight);
    }
}

TEST(Fit, KeepsTheCornersOfPolygons) {
    const auto curves = fit(crossings(polygon, 0.5, 4.5), true);
    ASSERT_EQ(curves.size(), 1U);
    ASSERT_EQ(curves[0].pieces.size(), 4U);
    for (const CurvePiece& piece : curves[0].pieces) {
        EXPECT_TRUE(piece.straight);
        EXPECT_LT(distance_from_corners(piece.end), 0.06);
    }
}

TEST(Fit, PassesExactlyThroughItsCuts) {
    const std::vector<Vec2f> points = crossings(ellipse({60, 60}, 50, 30), 0.0, 4.0);
    const std::vector<std::size_t> cuts{0, 17, 40, points.size() - 1};
    const auto curves = fit(points, false, cuts);
    ASSERT_EQ(curves.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(curves[k].start, points[cuts[k]]);
        EXPECT_EQ(curves[k].pieces.back().end, points[cuts[k + 1]]);
    }
}

TEST(Fit, SmoothsTheErrorOfCrossingsInsteadOfFollowingIt) {
    const double radius = 80.0;
    const auto arc = ellipse({100, 100}, radius, radius);
    const auto curves = fit(crossings(arc, 0.3, 2.3), false);
    double turned = 0.0;
    const std::vector<Vec2d> points = sampled(curves[0], 200);
    for (std::size_t k = 2; k < points.size(); ++k) {
        const Vec2d in = points[k - 1] - points[k - 2];
        const Vec2d out = points[k] - points[k - 1];
        turned += std::abs(std::atan2(cross(in, out), dot(in, out)));
    }
    EXPECT_NEAR(turned, 2.0, 0.05);  // any wiggle would turn there and back
}

TEST(Fit, StandsShortLinesAndRepeatedPoints) {
    EXPECT_EQ(fit({{1, 1}, {2, 1}}, false)[0].pieces.size(), 1U);
    EXPECT_EQ(fit({{1, 1}, {1, 1}}, false).size(), 1U);
    EXPECT_EQ(fit({{1, 1}, {2, 1}, {2, 1}, {3, 1}}, false).size(), 1U);
    for (const bool closed : {false, true}) {
        for (const Curve& curve : fit({{1, 1}, {1.4F, 1.5F}, {0.8F, 1.6F}}, closed)) {
            for (const Vec2d point : sampled(curve)) EXPECT_LT(length(point - Vec2d{1, 1}), 2.0);
        }
    }
    const auto dot = fit({{1, 1}, {2, 1}}, true);
    ASSERT_EQ(dot.size(), 1U);
    EXPECT_EQ(dot[0].pieces.back().end, dot[0].start);
}

TEST(Fit, BackwardsIsTheSameCurve) {
    const auto curve = fit(crossings(ellipse({60, 60}, 50, 30), 0.0, 4.0), false)[0];
    const Curve back = reversed(curve);
    EXPECT_EQ(back.start, curve.pieces.back().end);
    EXPECT_EQ(back.pieces.back().end, curve.start);
    std::vector<Vec2d> points = sampled(back);
    std::ranges::reverse(points);
    const std::vector<Vec2d> expected = sampled(curve);
    for (std::size_t k = 0; k < points.size(); ++k) {
        EXPECT_LT(length(points[k] - expected[k]), 1e-9);
    }
}

}  // namespace
}  // namespace ink::test
