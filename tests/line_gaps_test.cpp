#include "lines/line_gaps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "line_pieces.h"
#include "lines/segment_squares.h"
#include "lines_world.h"

namespace ink::test {
namespace {

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

}  // namespace
}  // namespace ink::test
