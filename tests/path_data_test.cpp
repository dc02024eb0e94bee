// Curves as the attribute d of SVG paths, read back.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "vector/path_data.h"

namespace ink::test {
namespace {

std::string data_of(const Curve& curve, bool closed = false) {
    std::string text;
    append_path_data(text, curve, closed);
    return text;
}

/// All places that path data names, by the grammar of SVG 1.1 (section 8.3.9) for M, l, c and Z.
std::vector<Vec2d> places_of(const std::string& text) {
    std::vector<Vec2d> places;
    Vec2d at;
    char command = 0;
    std::size_t point = 0;  // since the command or its repetition
    for (const char* next = text.c_str(); *next != 0;) {
        if (std::string("MlcZ").find(*next) != std::string::npos) {
            command = *next++;
            point = 0;
            continue;
        }
        char* end = nullptr;
        const double x = std::strtod(next, &end);
        const double y = std::strtod(end, &end);
        next = end;
        const bool absolute = command == 'M';
        const Vec2d place = absolute ? Vec2d{x, y} : at + Vec2d{x, y};
        places.push_back(place);
        ++point;
        if (command != 'c' || point % 3 == 0) at = place;
    }
    return places;
}

TEST(PathData, IsShort) {
    Curve curve{{0.5F, -12.25F}, {}};
    curve.pieces.push_back({{1.0F, -12.0F}, {2.0F, -12.0F}, {2.5F, -12.5F}});
    curve.pieces.push_back({{3.0F, -13.0F}, {3.0F, -13.0F}, {3.0F, -13.0F}});
    curve.pieces.push_back(straight_piece({3.0F, -13.0F}, {13.0F, -13.0F}));
    curve.pieces.push_back(straight_piece({13.0F, -13.0F}, {13.1F, -3.0F}));
    EXPECT_EQ(data_of(curve, true), "M.5-12.25c.5 .25 1.5 .25 2-.25 .5-.5 .5-.5 .5-.5l10 0 .1 10Z");
}

TEST(PathData, StaysWithinHundredthsHoweverLongTheCurve) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> step(-3.0F, 3.0F);
    Curve curve{{511.333F, 77.777F}, {}};
    std::vector<Vec2f> expected{curve.start};
    for (int k = 0; k < 3000; ++k) {
        const Vec2f from = curve.end();
        const auto moved = [&] { return from + Vec2f{step(random), step(random)}; };
        if (k % 5 == 0) {
            curve.pieces.push_back(straight_piece(from, moved()));
        } else {
            curve.pieces.push_back({moved(), moved(), moved()});
            expected.push_back(curve.pieces.back().control1);
            expected.push_back(curve.pieces.back().control2);
        }
        expected.push_back(curve.end());
    }
    const std::vector<Vec2d> places = places_of(data_of(curve));
    ASSERT_EQ(places.size(), expected.size());
    for (std::size_t k = 0; k < places.size(); ++k) {
        EXPECT_NEAR(places[k].x, static_cast<double>(expected[k].x), 0.0051);
        EXPECT_NEAR(places[k].y, static_cast<double>(expected[k].y), 0.0051);
    }
}

}  // namespace
}  // namespace ink::test
