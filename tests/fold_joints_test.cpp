#include "lines/fold_joints.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
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
    // Of two things, or so far apart that more than half a stroke fits in between.
    for (Segment& s : folds) s.owner = s.a.y > 21.0F ? 2 : 1;
    EXPECT_EQ(ends_of_one(eased(folds, folds.size())).size(), 4U);
    EXPECT_EQ(ends_of_one(
                  eased(fold({10.3F, 20.0F}, {43.0F, 20.0F}) + fold({40.0F, 26.0F}, {70.3F, 26.0F}),
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
