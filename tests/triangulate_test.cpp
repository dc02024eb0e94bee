#include "io/triangulate.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace ink {
namespace {

double signed_area(std::span<const Vec3f> p, const std::array<std::uint32_t, 3>& t) {
    return cross(to_double(p[t[1]]) - to_double(p[t[0]]), to_double(p[t[2]]) - to_double(p[t[0]]))
               .z /
           2.0;
}

TEST(Triangulate, CoversAStarOnceWithoutTurningATriangle) {
    std::vector<Vec3f> star;
    double expected = 0.0;
    for (int i = 0; i < 40; ++i) {
        const double radius = i % 2 == 0 ? 1.0 : 0.2, angle = std::acos(-1.0) * i / 20.0;
        star.push_back(to_float({radius * std::cos(angle), radius * std::sin(angle), 0.0}));
        expected += 0.5 * 1.0 * 0.2 * std::sin(std::acos(-1.0) / 20.0);
    }
    std::vector<std::array<std::uint32_t, 3>> triangles;
    ASSERT_TRUE(triangulate(star, triangles));
    EXPECT_EQ(triangles.size(), 38u);
    double sum = 0.0;
    for (const auto& triangle : triangles) {
        EXPECT_GT(signed_area(star, triangle), 0.0);
        sum += signed_area(star, triangle);
    }
    EXPECT_NEAR(sum, expected, 1e-6);
}

TEST(Triangulate, GivesUpOnAnOutlineThatWouldTakeTooLong) {
    // A ribbon wound up twenty times.
    constexpr int kSteps = 20'000;
    std::vector<Vec3f> ribbon;
    const auto add = [&](int i, double inner) {
        const double turn = 40.0 * std::acos(-1.0) * i / kSteps;
        const double radius = inner + 10.0 * i / kSteps;
        ribbon.push_back(to_float({radius * std::cos(turn), radius * std::sin(turn), 0.0}));
    };
    for (int i = 0; i < kSteps; ++i) add(i, 1.0);
    for (int i = kSteps; i-- > 0;) add(i, 1.1);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    EXPECT_FALSE(triangulate(ribbon, triangles));
    EXPECT_TRUE(triangles.empty());
}

}  // namespace
}  // namespace ink
