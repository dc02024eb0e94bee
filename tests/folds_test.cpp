// Self-occlusions that break up where a surface is merely steep, made whole.

#include "lines/folds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "line_pieces.h"
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
    const Viewpoint viewpoint = viewpoint_of(world.unit);
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
        const FoldRepairs repairs = mend_folds(lines, viewpoint_of(1.0), 1.0F, 2.0F, sample);
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

/// In the middle of a gap, too long to be leapt over, the surface is steep but has no valley.
TEST(BrokenFold, IsOneLineWhereTheWaysOnFromItsEndsComeNearEachOther) {
    const World steep{{broken_fold(0.1, 0.0, {})}};
    const auto line = static_cast<float>(kLine);
    const auto bridges = [&](float half_gap, float facing) {
        std::vector<Segment> lines;
        add_fold(lines, 0.5F, 13.5F, line);
        add_fold(lines, 30.5F, 43.5F, line);
        const auto sample = [&](std::span<const Vec2f> points, std::span<Sample> out) {
            std::ranges::transform(points, out.begin(), [&](Vec2f p) {
                Sample seen = steep(p);
                const float y = std::sqrt(1.0F - facing * facing);
                if (std::abs(p.x - 22.0F) < half_gap) seen.normal = {0, y, facing};
                return seen;
            });
        };
        return mend_folds(lines, viewpoint_of(1.0), 1.0F, 2.0F, sample).bridges;
    };
    float length_x = 0.0F;
    for (const Segment& bridge : bridges(2.0F, 0.15F)) {
        length_x += std::abs(bridge.b.x - bridge.a.x);
        for (const Vec2f p : {bridge.a, bridge.b}) EXPECT_NEAR(p.y, line, 0.15F);
    }
    EXPECT_NEAR(length_x, 17.0F, 0.01F);
    EXPECT_TRUE(bridges(6.0F, 0.15F).empty());  // longer than four widths
    EXPECT_TRUE(bridges(2.0F, 0.5F).empty());   // not steep
}

TEST(DoubledFold, IsOneWhereNoHalfStrokeFitsInBetween) {
    for (const float apart : {0.5F, 1.9F, 2.9F, 3.1F, 5.0F}) {
        std::vector<Segment> lines;
        add_fold(lines, 0.5F, 60.5F, 10.0F);
        add_fold(lines, 50.5F, 110.5F, 10.0F + apart);
        const FoldRepairs repairs = mend_folds(lines, viewpoint_of(1.0), 1.0F, 2.0F, sample_plane);
        const auto drawn_at = [&](float x) {
            std::ptrdiff_t count = 0;
            for (std::size_t k = 0; k < lines.size(); ++k) {
                const bool dropped = std::ranges::binary_search(repairs.crumbs, k);
                count += !dropped && lines[k].a.x < x && x < lines[k].b.x ? 1 : 0;
            }
            return count;
        };
        for (float x = 1.0F; x < 110.0F; x += 1.0F) {
            if (x == 50.0F) continue;  // just before the other one begins
            const bool both = x > 50.5F && x < 60.5F;
            EXPECT_EQ(drawn_at(x), both && apart > 3.0F ? 2 : 1) << apart << " at " << x;
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
    EXPECT_GT(left(18.0, 44, 2.0F), 18U);  // long
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
        const Viewpoint viewpoint = viewpoint_of(world.unit);
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
    const Viewpoint viewpoint = viewpoint_of(world.unit);
    const FoldWorker worker{[&](std::span<const Vec2f> points, std::span<Sample> out) {
                                std::ranges::transform(points, out.begin(), world);
                            },
                            {}};
    const FoldTeam backwards{std::vector<FoldWorker>(3, worker),
                             [](std::size_t count, const auto& body) {
                                 for (std::size_t k = count; k-- > 0;) body(k, k % 3);
                             }};
    const FoldRepairs again =
        mend_folds(shuffled, plane::SegmentSquares(shuffled), viewpoint, 1.0F, 2.0F, backwards);
    ASSERT_EQ(again.bridges.size(), mended.repairs.bridges.size());
    for (std::size_t k = 0; k < again.bridges.size(); ++k) {
        EXPECT_EQ(again.bridges[k].a, mended.repairs.bridges[k].a);
        EXPECT_EQ(again.bridges[k].b, mended.repairs.bridges[k].b);
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
        const Viewpoint viewpoint = viewpoint_of(world.unit);
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

TEST(CrumbOfAFold, IsARingThatItsOwnLineFills) {
    for (const float side : {0.4F, 2.0F}) {
        const Vec2f low{10.6F, 10.6F};
        const Vec2f high = low + Vec2f{side, side};
        const std::vector<Segment> ring = fold(low, {high.x, low.y}) + fold({high.x, low.y}, high) +
                                          fold(high, {low.x, high.y}) + fold({low.x, high.y}, low);
        const FoldRepairs repairs = mend_folds(ring, viewpoint_of(1.0), 1.0F, 2.0F, sample_plane);
        EXPECT_EQ(repairs.crumbs.size(), side < 1.0F ? ring.size() : 0U) << side;
    }
}

TEST(BrokenFold, OfAThinLineIsMendedAsOneOfTheLeastWidth) {
    const World world{{broken_fold(0.1, 40.0, {{5, 13}, {27, 43}})}};
    const std::vector<Segment> found = search(world, 1).segments;
    const auto bridged = [&](float width, float least_width) {
        const auto sample = [&](std::span<const Vec2f> points, std::span<Sample> out) {
            std::ranges::transform(points, out.begin(), world);
        };
        return !mend_folds(found, viewpoint_of(world.unit), 1.0F, width, sample,
                           {.least_width = least_width})
                    .bridges.empty();
    };
    EXPECT_TRUE(bridged(2.0F, 0.0F));
    EXPECT_FALSE(bridged(1.0F, 0.0F));
    EXPECT_TRUE(bridged(1.0F, 2.0F));
}

/// Whether a line doubles another one depends on what is drawn.
TEST(DoubledFold, OfAThinLineStaysWhateverTheLeastWidth) {
    const std::vector<Segment> folds =
        fold({10.5F, 20.0F}, {70.5F, 20.0F}) + fold({20.5F, 22.0F}, {60.5F, 22.0F});
    const auto dropped = [&](float width, float least_width) {
        return mend_folds(folds, viewpoint_of(1.0), 1.0F, width, sample_plane,
                          {.least_width = least_width, .crumb_area = 0.0F, .stub_area = 0.0F})
            .crumbs.size();
    };
    EXPECT_GT(dropped(2.0F, 0.0F), 30U);
    EXPECT_EQ(dropped(1.0F, 2.0F), 0U);
}

/// A fold leaves an outline and comes back to it, two pixels away from it at most.
TEST(CrumbOfAFold, IsABumpOnAnOutlineThatTheOutlinesStrokeCovers) {
    const std::vector<Segment> outline =
        straight({10.5F, 20.0F}, {60.5F, 20.0F}, LineType::silhouette);
    const std::vector<Segment> bump = fold({20.5F, 20.0F}, {26.5F, 22.0F}) +
                                      fold({26.5F, 22.0F}, {40.5F, 22.0F}) +
                                      fold({40.5F, 22.0F}, {46.5F, 20.0F});
    const auto dropped = [&](const std::vector<Segment>& lines, float width) {
        return mend_folds(lines, viewpoint_of(1.0), 1.0F, width, sample_plane).crumbs.size();
    };
    EXPECT_EQ(dropped(outline + bump, 4.5F), bump.size());
    EXPECT_EQ(dropped(outline + bump, 3.5F), 0U);
    // What goes on from it is no bump.
    EXPECT_EQ(dropped(outline + bump + fold({40.5F, 22.0F}, {40.5F, 90.0F}), 4.5F), 0U);
}

/// A fold ends beside a short one that comes from an outline and goes on past its end.
TEST(CrumbOfAFold, StaysAsFarAsAnotherFoldGoesOnAlongIt) {
    std::vector<Segment> lines;
    add_fold(lines, 20.5F, 60.5F, 10.0F);
    add_fold(lines, 16.5F, 24.5F, 10.4F);
    const std::size_t folds = lines.size();
    for (float y = 5.4F; y < 15.0F; y += 1.0F) {
        Segment& outline = lines.emplace_back(lines.front());
        outline.type = LineType::silhouette;
        outline.a = {16.5F, y};
        outline.b = {16.5F, y + 1.0F};
    }
    const FoldRepairs repairs = mend_folds(lines, viewpoint_of(1.0), 1.0F, 3.0F, sample_plane);
    for (float x = 17.0F; x < 60.0F; x += 1.0F) {
        int count = 0;
        for (std::size_t k = 0; k < folds; ++k) {
            const bool dropped = std::ranges::binary_search(repairs.crumbs, k);
            count += !dropped && lines[k].a.x < x && x < lines[k].b.x ? 1 : 0;
        }
        EXPECT_EQ(count, 1) << x;
    }
}

TEST(DoubledFold, StaysWhereALineOfAnotherKindGoesOnAsIt) {
    const std::vector<Segment> folds =
        fold({10.5F, 20.0F}, {70.5F, 20.0F}) + fold({20.5F, 21.5F}, {60.5F, 21.5F});
    const auto dropped = [&](const std::vector<Segment>& lines) {
        return mend_folds(lines, viewpoint_of(1.0), 1.0F, 2.0F, sample_plane).crumbs.size();
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

}  // namespace
}  // namespace ink::test
