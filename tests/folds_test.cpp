// Self-occlusions that break up where a surface is merely steep, made whole.

#include "lines/folds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "lines/bridges.h"
#include "lines/fold_joints.h"
#include "lines/line_gaps.h"
#include "lines/segment_squares.h"
#include "lines_world.h"

namespace ink::test {
namespace {

constexpr double kLine = 24.3;  ///< y of the fold

/// A slope that is steepest along y = kLine, where the tangent between it and the ray is `facing`.
/// In the given ranges of x it hides what lies behind, by up to `depth`; in between it is whole.
/// `opening`: how fast the slope grows less steep to both sides.
Surface broken_fold(double facing, double depth, std::vector<std::pair<double, double>> ranges,
                    double opening = 0.015) {
    return {1, [=](double x, double y) -> std::optional<Hit> {
                const double off = y - kLine;
                double hidden = 0.0;
                for (const auto& [low, high] : ranges) {
                    if (off < 0.0 && x > low && x < high) {
                        hidden = depth * std::min({1.0, x - low, high - x}) * std::exp(off / 60.0);
                    }
                }
                const double slope = 1.0 / (facing + opening * std::abs(off));
                const double rise = std::log(1.0 + opening * std::abs(off) / facing) / opening;
                return Hit{std::copysign(rise, off) - hidden, {0.0, slope, 1.0}};
            }};
}

struct Mended {
    Found found;
    FoldRepairs repairs;
    std::vector<Segment> lines;  ///< as they are drawn
};

Mended mend(const SampleFunction& sample, const World& world, float width) {
    Mended mended{search(world, 1), {}, {}};
    Viewpoint viewpoint;
    viewpoint.dir = {0, 0, -1};
    viewpoint.parallel = true;
    viewpoint.origin = {{0, 0, 2}, {world.unit, 0, 0}, {0, -world.unit, 0}};
    viewpoint.direction = {{0, 0, -1}, {}, {}};
    mended.repairs = mend_folds(mended.found.segments, viewpoint, 1.0F, width, sample);
    mended.lines = mended.found.segments;
    for (auto k = mended.repairs.crumbs.rbegin(); k != mended.repairs.crumbs.rend(); ++k) {
        mended.lines.erase(mended.lines.begin() + static_cast<std::ptrdiff_t>(*k));
    }
    mended.lines.insert(mended.lines.end(), mended.repairs.bridges.begin(),
                        mended.repairs.bridges.end());
    return mended;
}

Mended mend(const World& world, float width) {
    return mend([&](std::span<const Vec2f> points,
                    std::span<Sample> out) { std::ranges::transform(points, out.begin(), world); },
                world, width);
}

/// A line along x, as the lattice cuts it.
void add_fold(std::vector<Segment>& lines, float from, float to, float y) {
    for (float x = from; x < to; x += 1.0F) {
        Segment& segment = lines.emplace_back();
        segment.a = {x, y};
        segment.b = {x + 1.0F, y};
        segment.type = LineType::self_occlusion;
        segment.owner = segment.left = segment.right = 1;
        segment.spans_cell = true;
    }
}

/// What points of the picture see of the plane z = 0 from a height of 2, straight down.
void sample_plane(std::span<const Vec2f> points, std::span<Sample> out) {
    std::ranges::transform(points, out.begin(), [](Vec2f p) {
        return Sample{1, {p.x, -p.y, 0.0F}, {0, 0, 1}, 2.0F};
    });
}
Viewpoint above_plane() {
    Viewpoint viewpoint;
    viewpoint.dir = {0, 0, -1};
    viewpoint.parallel = true;
    viewpoint.origin = {{0, 0, 2}, {1, 0, 0}, {0, -1, 0}};
    viewpoint.direction = {{0, 0, -1}, {}, {}};
    return viewpoint;
}

TEST(BrokenFold, IsOneLineWhereTheSurfaceStaysSteep) {
    const World world{{broken_fold(0.1, 40.0, {{5, 13}, {20, 31}, {37, 43}})}};
    const Mended mended = mend(world, 2.0F);
    ASSERT_FALSE(mended.found.segments.empty());
    EXPECT_TRUE(mended.repairs.crumbs.empty());
    ASSERT_FALSE(mended.repairs.bridges.empty());
    for (const Segment& bridge : mended.repairs.bridges) {
        EXPECT_EQ(bridge.type, LineType::self_occlusion);
        EXPECT_LT(length(bridge), 1.5);
        for (const Vec2f p : {bridge.a, bridge.b}) EXPECT_NEAR(p.y, kLine, 0.15);
    }
    // From the first to the last column without a gap, and with no more than two ends.
    Found whole = mended.found;
    whole.segments = mended.lines;
    EXPECT_NEAR(total_length(whole), 38.0, 2.5);
    EXPECT_EQ(loose_ends(whole).size(), 2U) << list(loose_ends(whole));
}

TEST(BrokenFold, IsFollowedFromOneOfTheTwoEndsOfAGap) {
    constexpr double kFrom = 13.0;
    constexpr double kTo = 20.0;
    const World world{{broken_fold(0.1, 40.0, {{5, kFrom}, {kTo, 31}})}};
    int steps = 0;
    const auto sample = [&](std::span<const Vec2f> points, std::span<Sample> out) {
        std::ranges::transform(points, out.begin(), world);
        const bool in_gap = std::ranges::all_of(
            points, [&](Vec2f p) { return p.x > kFrom + 0.5 && p.x < kTo - 0.5; });
        steps += in_gap ? 1 : 0;
    };
    EXPECT_FALSE(mend(sample, world, 2.0F).repairs.bridges.empty());
    EXPECT_GT(steps, 0);
    EXPECT_LE(steps, static_cast<int>(kTo - kFrom));
}

/// The valley from the first fold, a single segment, leads to the end of the second, from which no
/// valley goes on: ahead of it the surface faces the viewer. Both ends go to the right.
TEST(BrokenFold, IsFollowedToAnEndFromWhichNoValleyGoesOn) {
    const World steep{{broken_fold(0.1, 0.0, {})}};
    const auto line = static_cast<float>(kLine);
    for (const float side : {1.0F, -1.0F}) {
        const auto on_second = [&](int from_end) {
            const auto away = static_cast<float>(from_end);
            return Vec2f{25.0F - away, line + side * (0.3F + away)};
        };
        const Vec2f end = on_second(0);
        std::vector<Segment> lines;
        add_fold(lines, 17.5F, 18.5F, line);
        for (int k = 15; k > 0; --k) {
            Segment& segment = lines.emplace_back(lines.front());
            segment.a = on_second(k);
            segment.b = on_second(k - 1);
        }
        const auto sample = [&](std::span<const Vec2f> points, std::span<Sample> out) {
            std::ranges::transform(points, out.begin(), [&](Vec2f p) {
                Sample seen = steep(p);
                if (p.x - end.x - side * (p.y - end.y) > 0.3F) seen.normal = {0, 0, 1};
                return seen;
            });
        };
        const FoldRepairs repairs = mend_folds(lines, above_plane(), 1.0F, 2.0F, sample);
        ASSERT_FALSE(repairs.bridges.empty());
        for (const Segment& bridge : repairs.bridges) EXPECT_LE(bridge.b.x, end.x);
    }
}

TEST(BrokenFold, StaysBrokenWhereTheSurfaceFacesTheViewer) {
    const Mended mended = mend({{broken_fold(0.4, 40.0, {{5, 13}, {20, 31}})}}, 2.0F);
    EXPECT_TRUE(mended.repairs.bridges.empty());
    EXPECT_TRUE(mended.repairs.crumbs.empty());
}

TEST(BrokenFold, IsNotBridgedOverALongWay) {
    EXPECT_TRUE(
        mend({{broken_fold(0.1, 40.0, {{3, 10}, {36, 45}})}}, 2.0F).repairs.bridges.empty());
}

TEST(BrokenFold, IsOneLineOverAShortGapWithoutAValley) {
    constexpr double kEven = 1e-3;  // no steeper along the fold than beside it
    const Mended mended = mend({{broken_fold(0.15, 40.0, {{5, 20}, {26, 43}}, kEven)}}, 2.0F);
    Found whole = mended.found;
    whole.segments = mended.lines;
    EXPECT_FALSE(mended.repairs.bridges.empty());
    EXPECT_EQ(loose_ends(whole).size(), 2U) << list(loose_ends(whole));
    for (const Segment& bridge : mended.repairs.bridges) {
        for (const Vec2f p : {bridge.a, bridge.b}) EXPECT_NEAR(p.y, kLine, 0.15);
    }
    // Over more than four widths it is two.
    EXPECT_TRUE(mend({{broken_fold(0.15, 40.0, {{5, 16}, {30, 43}}, kEven)}}, 2.0F)
                    .repairs.bridges.empty());
}

TEST(DoubledFold, IsOneWhereItsTwoStrokesTouch) {
    for (const float apart : {0.5F, 1.9F, 2.1F, 5.0F}) {
        std::vector<Segment> lines;
        add_fold(lines, 0.5F, 60.5F, 10.0F);
        add_fold(lines, 50.5F, 110.5F, 10.0F + apart);
        const FoldRepairs repairs = mend_folds(lines, above_plane(), 1.0F, 2.0F, sample_plane);
        const auto drawn_at = [&](float x) {
            std::ptrdiff_t count = 0;
            for (std::size_t k = 0; k < lines.size(); ++k) {
                const bool dropped = std::ranges::binary_search(repairs.crumbs, k);
                count += !dropped && lines[k].a.x < x && x < lines[k].b.x ? 1 : 0;
            }
            return count;
        };
        for (float x = 1.0F; x < 110.0F; x += 1.0F) {
            const bool both = x > 50.5F && x < 60.5F;
            EXPECT_EQ(drawn_at(x), both && apart > 2.0F ? 2 : 1) << apart << " at " << x;
        }
    }
}

TEST(CrumbOfAFold, IsDroppedIfShortAndShallow) {
    const auto left = [](double depth, double to, float width) {
        return mend({{broken_fold(0.1, depth, {{20, to}})}}, width).lines.size();
    };
    EXPECT_EQ(left(18.0, 26, 2.0F), 0U);
    EXPECT_GT(left(18.0, 26, 0.5F), 2U);   // long for its width
    EXPECT_GT(left(100.0, 28, 2.0F), 2U);  // deep
    EXPECT_GT(left(18.0, 40, 2.0F), 15U);  // long
    EXPECT_EQ(left(6.0, 34, 2.0F), 0U);    // longer than five widths, but hides next to nothing
}

TEST(CrumbOfAFold, ThatHangsOnAnotherLineIsDroppedIfItIsAStub) {
    const Surface plate =
        flat(2, 300.0, [](double x, double y) { return x + 0.3 * (y - kLine) < 20.3; });
    const auto folds = [&](float width) {
        const Mended mended = mend({{broken_fold(0.1, 18.0, {{10, 26}}), plate}}, width);
        return std::ranges::count(mended.lines, LineType::self_occlusion, &Segment::type);
    };
    EXPECT_EQ(folds(4.0F), 0);
    EXPECT_GT(folds(1.2F), 2);  // longer than three widths, though not than five
}

TEST(CrumbOfAFold, IsDroppedHoweverDeepIfItIsADot) {
    EXPECT_EQ(mend({{broken_fold(0.1, 100.0, {{20, 24}})}}, 2.0F).lines.size(), 0U);
    EXPECT_GT(mend({{broken_fold(0.1, 100.0, {{20, 24}})}}, 0.75F).lines.size(), 2U);
}

TEST(CrumbOfAFold, ThatHangsOnAnotherLineIsDroppedHoweverDeepIfItIsAHair) {
    // A few pixels stick out beside the plate.
    const Surface plate =
        flat(2, 300.0, [](double x, double y) { return x + 0.3 * (y - kLine) < 20.3; });
    const World world{{broken_fold(0.1, 18.0, {{10, 25}}), plate}};
    const auto folds = [&](float width) {
        Viewpoint viewpoint;
        viewpoint.dir = {0, 0, -1};
        viewpoint.parallel = true;
        viewpoint.origin = {{0, 0, 2}, {world.unit, 0, 0}, {0, -world.unit, 0}};
        viewpoint.direction = {{0, 0, -1}, {}, {}};
        const Found found = search(world, 1);
        const FoldRepairs repairs =
            mend_folds(found.segments, viewpoint, 1.0F, width,
                       [&](std::span<const Vec2f> points, std::span<Sample> out) {
                           std::ranges::transform(points, out.begin(), world);
                       },
                       {.crumb_area = 0.0F, .stub_area = 0.0F});
        return std::ranges::count(found.segments, LineType::self_occlusion, &Segment::type) -
               static_cast<std::ptrdiff_t>(repairs.crumbs.size());
    };
    EXPECT_EQ(folds(6.0F), 0);
    EXPECT_EQ(folds(2.5F), 0);
    EXPECT_GT(folds(0.75F), 1);
}

TEST(BrokenFold, IsMendedAlikeWhateverTheOrderOfItsPiecesAndByAnyNumberOfWorkers) {
    const World world{{broken_fold(0.1, 40.0, {{5, 13}, {20, 31}, {37, 43}})}};
    const Mended mended = mend(world, 2.0F);
    std::vector<Segment> shuffled = mended.found.segments;
    std::ranges::shuffle(shuffled, std::mt19937(1));
    Viewpoint viewpoint;
    viewpoint.dir = {0, 0, -1};
    viewpoint.parallel = true;
    viewpoint.origin = {{0, 0, 2}, {world.unit, 0, 0}, {0, -world.unit, 0}};
    viewpoint.direction = {{0, 0, -1}, {}, {}};
    const FoldWorker worker{[&](std::span<const Vec2f> points, std::span<Sample> out) {
                                std::ranges::transform(points, out.begin(), world);
                            },
                            {}};
    const std::vector<FoldWorker> workers(3, worker);
    const FoldLoop backwards = [](std::size_t count, const auto& body) {
        for (std::size_t k = count; k-- > 0;) body(k, k % 3);
    };
    const FoldRepairs again = mend_folds(shuffled, plane::SegmentSquares(shuffled), viewpoint, 1.0F,
                                         2.0F, workers, backwards);
    ASSERT_EQ(again.bridges.size(), mended.repairs.bridges.size());
    for (std::size_t k = 0; k < again.bridges.size(); ++k) {
        EXPECT_EQ(again.bridges[k].a, mended.repairs.bridges[k].a);
        EXPECT_EQ(again.bridges[k].b, mended.repairs.bridges[k].b);
    }
}

/// A straight line in pieces from cell to cell.
std::vector<Segment> straight(Vec2f a, Vec2f b, LineType type = LineType::crease) {
    const std::vector<Vec2f> points = plane::cut_by_cells(a, b, 1.0F);
    std::vector<Segment> line;
    for (std::size_t n = 1; n < points.size(); ++n) {
        Segment piece;
        piece.a = points[n - 1];
        piece.b = points[n];
        piece.type = piece.type_at_b = type;
        piece.left = piece.right = piece.owner = 1;
        piece.spans_cell = true;
        line.push_back(piece);
    }
    return line;
}

std::vector<Segment> operator+(std::vector<Segment> a, const std::vector<Segment>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

std::vector<Segment> pieces_in_gaps(const std::vector<Segment>& lines, float width = 3.0F) {
    const plane::SegmentSquares squares(lines);
    return close_gaps({lines, lines.size(), squares}, {}, 1.0F, width);
}

/// From (10, 10) in a direction, with a gap between two places.
std::vector<Segment> broken_line(double angle_deg, float from, float to) {
    const Vec2f way{static_cast<float>(std::cos(angle_deg * kDegrees)),
                    static_cast<float>(std::sin(angle_deg * kDegrees))};
    const Vec2f start{10.3F, 10.2F};
    return straight(start, start + way * from) + straight(start + way * 40.0F, start + way * to);
}

TEST(GapOfALine, IsClosedByPiecesWithinCellsFromEndToEnd) {
    for (double angle = 0.0; angle < 90.0; angle += 7.0) {
        const std::vector<Segment> lines = broken_line(angle, 15.0F, 25.0F);
        const std::vector<Segment> pieces = pieces_in_gaps(lines);
        double total = 0.0;
        for (const Segment& piece : pieces) {
            total += std::hypot(piece.b.x - piece.a.x, piece.b.y - piece.a.y);
            const auto cell = [](float a, float b) { return std::floor((a + b) * 0.5F - 0.5F); };
            for (const Vec2f end : {piece.a, piece.b}) {
                EXPECT_NEAR(end.x, cell(piece.a.x, piece.b.x) + 1.0F, 0.5001F) << angle;
                EXPECT_NEAR(end.y, cell(piece.a.y, piece.b.y) + 1.0F, 0.5001F) << angle;
                const double off = (end.y - 10.2) * std::cos(angle * kDegrees) -
                                   (end.x - 10.3) * std::sin(angle * kDegrees);
                EXPECT_NEAR(off, 0.0, 0.01) << angle;
            }
        }
        EXPECT_NEAR(total, 10.0, 0.01) << angle;
        std::map<std::pair<float, float>, int> ends;
        for (const Segment& s : lines + pieces) {
            ++ends[{s.a.x, s.a.y}];
            ++ends[{s.b.x, s.b.y}];
        }
        EXPECT_EQ(std::ranges::count(ends, 1, [](const auto& end) { return end.second; }), 2);
    }
}

TEST(GapOfALine, StaysOpenWhereSomethingLiesBetweenOrTheEndsBelongToNoOneLine) {
    const std::vector<Segment> lines = broken_line(20.0, 15.0F, 25.0F);
    EXPECT_FALSE(pieces_in_gaps(lines).empty());
    // Wider than four widths, and than eight pixels.
    EXPECT_TRUE(pieces_in_gaps(lines, 2.0F).empty());
    EXPECT_TRUE(pieces_in_gaps(broken_line(20.0, 15.0F, 28.0F)).empty());
    // A bar, on both of whose sides the line ends.
    const Vec2f end = lines[0].a + Vec2f{15.0F * 0.9397F, 15.0F * 0.3420F};
    const auto across = [&](Vec2f p) {
        return straight(p - Vec2f{-2.0F, 6.0F}, p + Vec2f{-2.0F, 6.0F}, LineType::silhouette);
    };
    EXPECT_TRUE(pieces_in_gaps(lines + across(end + Vec2f{5.0F, 2.0F})).empty());
    EXPECT_TRUE(pieces_in_gaps(lines + across(end)).empty());
    // Lines of two things; side by side; one that fades out.
    std::vector<Segment> other = lines;
    for (Segment& s : other) s.owner = s.a.x > 30.0F ? 2 : 1;
    EXPECT_TRUE(pieces_in_gaps(other).empty());
    std::vector<Segment> faint = lines;
    for (Segment& s : faint) s.strength = s.a.x > 30.0F ? 0.2F : 1.0F;
    EXPECT_TRUE(pieces_in_gaps(faint).empty());
    EXPECT_TRUE(pieces_in_gaps(straight({10.3F, 10.2F}, {25.0F, 10.2F}) +
                               straight({30.3F, 14.2F}, {45.0F, 14.2F}))
                    .empty());
}

TEST(GapOfALine, IsClosedAlikeWhateverTheOrderOfTheSegments) {
    std::vector<Segment> lines = broken_line(33.0, 15.0F, 24.0F);
    const std::vector<Segment> pieces = pieces_in_gaps(lines);
    std::ranges::shuffle(lines, std::mt19937(1));
    const std::vector<Segment> again = pieces_in_gaps(lines);
    ASSERT_EQ(pieces.size(), again.size());
    for (std::size_t k = 0; k < pieces.size(); ++k) {
        EXPECT_TRUE(pieces[k].a == again[k].a && pieces[k].b == again[k].b);
    }
}

TEST(CrumbOfAFold, LeavesNothingThatHungOnItBehind) {
    // One fold ends on an outline, and hides next to nothing; on it another one ends, that hides
    // enough to be a stub, but not enough to stand alone.
    const std::vector<Segment> lines =
        straight({5.5F, 28.0F}, {30.5F, 28.0F}, LineType::silhouette) +
        straight({10.0F, 28.0F}, {10.0F, 18.2F}, LineType::self_occlusion) +
        straight({10.0F, 24.0F}, {18.0F, 24.0F}, LineType::self_occlusion);
    const auto crumbs = [&](double depth) {
        const World world{
            {flat(1, 0.0, [](double, double) { return true; }),
             flat(1, 0.3, [](double x, double y) { return x < 10.0 && y < 24.0; }),
             flat(1, depth, [](double x, double y) { return x > 10.5 && y < 24.0; })}};
        Viewpoint viewpoint;
        viewpoint.dir = {0, 0, -1};
        viewpoint.parallel = true;
        viewpoint.origin = {{0, 0, 2}, {world.unit, 0, 0}, {0, -world.unit, 0}};
        viewpoint.direction = {{0, 0, -1}, {}, {}};
        const FoldRepairs repairs =
            mend_folds(lines, viewpoint, 1.0F, 2.0F,
                       [&](std::span<const Vec2f> points, std::span<Sample> out) {
                           std::ranges::transform(points, out.begin(), world);
                       });
        return std::ranges::count_if(repairs.crumbs,
                                     [&](std::size_t k) { return lines[k].a.x > 10.0F; });
    };
    EXPECT_GT(crumbs(1.5), 5);
    EXPECT_EQ(crumbs(30.0), 0);
}

// Joints

FoldJoints joints_of(const std::vector<Segment>& lines, std::size_t first_joining) {
    const std::size_t first = std::min(first_joining, lines.size());
    const plane::SegmentSquares squares(std::span<const Segment>(lines).first(first));
    return ease_joints({lines, first, squares}, {}, 1.0F, 3.0F);
}

/// As they are drawn.
std::vector<Segment> eased(const std::vector<Segment>& lines, std::size_t first_joining) {
    const FoldJoints joints = joints_of(lines, first_joining);
    std::vector<Segment> drawn;
    for (std::size_t k = 0; k < lines.size(); ++k) {
        if (!std::ranges::binary_search(joints.dropped, k)) drawn.push_back(lines[k]);
    }
    return drawn + joints.curves;
}

/// The largest angle to the x axis, degrees.
double steepest(const std::vector<Segment>& lines) {
    double most = 0.0;
    for (const Segment& s : lines) {
        const double angle = std::atan2(std::abs(s.b.y - s.a.y), std::abs(s.b.x - s.a.x));
        most = std::max(most, angle / kDegrees);
    }
    return most;
}

std::vector<std::pair<float, float>> ends_of_one(const std::vector<Segment>& lines) {
    std::map<std::pair<float, float>, int> ends;
    for (const Segment& s : lines) {
        ++ends[{s.a.x, s.a.y}];
        ++ends[{s.b.x, s.b.y}];
    }
    std::vector<std::pair<float, float>> found;
    for (const auto& [place, count] : ends) {
        if (count == 1) found.push_back(place);
    }
    return found;
}

std::vector<Segment> fold(Vec2f a, Vec2f b) { return straight(a, b, LineType::self_occlusion); }

TEST(JointOfFolds, IsACurveWhereTheyLieBesideEachOther) {
    const std::vector<Segment> folds =
        fold({10.3F, 20.0F}, {40.0F, 20.0F}) + fold({41.0F, 22.0F}, {70.3F, 22.0F});
    const std::vector<Segment> lines = folds + fold({40.0F, 20.0F}, {41.0F, 22.0F});
    ASSERT_GT(steepest(lines), 60.0);
    const std::vector<Segment> drawn = eased(lines, folds.size());
    EXPECT_LT(steepest(drawn), 25.0);
    EXPECT_EQ(ends_of_one(drawn), ends_of_one(lines));
    for (const Segment& s : drawn) {
        EXPECT_GE(std::min(s.a.y, s.b.y), 20.0F);
        EXPECT_LE(std::max(s.a.y, s.b.y), 22.0F);
    }
}

TEST(JointOfFolds, ThatRunPastEachOtherIsOneCurve) {
    std::vector<Segment> folds =
        fold({10.3F, 20.0F}, {43.0F, 20.0F}) + fold({40.0F, 22.0F}, {70.3F, 22.0F});
    const std::vector<Segment> drawn = eased(folds, folds.size());
    EXPECT_EQ(ends_of_one(drawn).size(), 2U);
    EXPECT_LT(steepest(drawn), 25.0);
    // Of two things, or farther apart than their strokes are wide.
    for (Segment& s : folds) s.owner = s.a.y > 21.0F ? 2 : 1;
    EXPECT_EQ(ends_of_one(eased(folds, folds.size())).size(), 4U);
    EXPECT_EQ(ends_of_one(
                  eased(fold({10.3F, 20.0F}, {43.0F, 20.0F}) + fold({40.0F, 25.0F}, {70.3F, 25.0F}),
                        1000))
                  .size(),
              4U);
}

TEST(JointOfFolds, StaysACornerWhereTheLineGoesOnInAnotherDirection) {
    const std::vector<Segment> folds = fold({10.3F, 20.0F}, {40.0F, 20.0F});
    const std::vector<Segment> lines = folds + fold({40.0F, 20.0F}, {60.3F, 40.3F});
    const FoldJoints joints = joints_of(lines, folds.size());
    EXPECT_TRUE(joints.dropped.empty());
    EXPECT_TRUE(joints.curves.empty());
}

TEST(JointOfFolds, HasNoHairWhereOneEndedPastIt) {
    // The fold begins half a pixel before the place where the other one was joined to it.
    const std::vector<Segment> folds = fold({10.3F, 20.0F}, {40.0F, 20.0F}) +
                                       fold({42.0F, 21.2F}, {42.5F, 21.2F}) +
                                       fold({42.5F, 21.2F}, {70.3F, 21.2F});
    const std::vector<Segment> lines = folds + fold({40.0F, 20.0F}, {42.5F, 21.2F});
    EXPECT_EQ(ends_of_one(lines).size(), 3U);
    EXPECT_EQ(ends_of_one(eased(lines, folds.size())).size(), 2U);
}

TEST(EndOfAFold, DoesNotTurnBack) {
    const std::vector<Segment> line = fold({10.3F, 20.0F}, {40.0F, 20.0F});
    const auto left = [&](float length) {
        const std::vector<Segment> hook = fold({40.0F, 20.0F}, {40.0F - length, 20.0F + length});
        return eased(line + hook, 1000).size() - line.size();
    };
    EXPECT_EQ(left(4.0F), 0U);
    EXPECT_GT(left(8.0F), 8U);
    // A corner that does not turn back.
    const std::vector<Segment> corner = line + fold({40.0F, 20.0F}, {44.0F, 24.0F});
    EXPECT_EQ(eased(corner, 1000).size(), corner.size());
    // What ends on another line is no loose end.
    const std::vector<Segment> held =
        line + fold({40.0F, 20.0F}, {36.0F, 24.0F}) + straight({36.0F, 24.0F}, {36.0F, 40.0F});
    EXPECT_EQ(eased(held, 1000).size(), held.size());
}

TEST(DoubledFold, StaysWhereALineOfAnotherKindGoesOnAsIt) {
    const std::vector<Segment> folds =
        fold({10.5F, 20.0F}, {70.5F, 20.0F}) + fold({20.5F, 21.5F}, {60.5F, 21.5F});
    const auto dropped = [&](const std::vector<Segment>& lines) {
        return mend_folds(lines, above_plane(), 1.0F, 2.0F, sample_plane).crumbs.size();
    };
    EXPECT_GT(dropped(folds), 30U);
    EXPECT_EQ(dropped(folds + straight({60.5F, 21.5F}, {70.5F, 24.0F}, LineType::boundary)), 0U);
}

TEST(SegmentSquares, VisitJustTheSegmentsWhoseMiddlesAreNear) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(-40.0F, 300.0F);
    std::uniform_real_distribution<float> step(-0.7F, 0.7F);
    std::vector<Segment> segments(500);
    for (Segment& segment : segments) {
        segment.a = {place(random), place(random)};
        segment.b = segment.a + Vec2f{step(random), step(random)};
    }
    const plane::SegmentSquares squares(segments);
    for (const float reach : {1.5F, 20.0F, 70.0F}) {
        const Vec2f p{place(random), place(random)};
        std::set<std::uint32_t> visited;
        squares.near(p, reach, [&](std::uint32_t k) { visited.insert(k); });
        for (std::uint32_t k = 0; k < segments.size(); ++k) {
            const Vec2f apart = (segments[k].a + segments[k].b) * 0.5F - p;
            const bool near = std::abs(apart.x) <= reach && std::abs(apart.y) <= reach;
            EXPECT_EQ(visited.contains(k), near) << k << " within " << reach;
        }
    }
}

TEST(JointOfFolds, IsTheSameWhateverTheOrderOfTheSegments) {
    std::vector<Segment> folds = fold({10.3F, 20.0F}, {43.0F, 20.0F}) +
                                 fold({40.0F, 22.0F}, {70.3F, 22.0F}) +
                                 fold({66.0F, 24.1F}, {90.3F, 24.1F});
    const FoldJoints joints = joints_of(folds, folds.size());
    ASSERT_FALSE(joints.curves.empty());
    std::ranges::shuffle(folds, std::mt19937(1));
    const FoldJoints again = joints_of(folds, folds.size());
    EXPECT_EQ(joints.dropped.size(), again.dropped.size());
    const auto places = [](const FoldJoints& of) {
        std::set<std::array<float, 4>> found;
        for (const Segment& s : of.curves) {
            const bool swap = std::pair(s.b.x, s.b.y) < std::pair(s.a.x, s.a.y);
            const Vec2f a = swap ? s.b : s.a;
            const Vec2f b = swap ? s.a : s.b;
            found.insert({a.x, a.y, b.x, b.y});
        }
        return found;
    };
    EXPECT_EQ(places(joints), places(again));
}

}  // namespace
}  // namespace ink::test
