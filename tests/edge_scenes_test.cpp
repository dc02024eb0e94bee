// Whole pictures of scenes with known answers, by method edges.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <variant>
#include <vector>

#include "drawing.h"
#include "edges_view.h"
#include "scenes.h"

namespace ink::test {
namespace {

std::map<LineType, double> lengths(const Scene& scene, const Settings& settings) {
    Drawing drawing;
    render(scene, *make_tracer(scene), settings, {}, {}, nullptr, &drawing);
    std::map<LineType, double> lengths;
    const auto inside = [&](Vec2f p) {
        return p.x > 0.0F && p.y > 0.0F && p.x < static_cast<float>(settings.size.width) &&
               p.y < static_cast<float>(settings.size.height);
    };
    for (const Segment& s : drawing.segments) {
        if (inside(s.a) && inside(s.b)) {
            lengths[s.type] += std::hypot(s.b.x - s.a.x, s.b.y - s.a.y);
        }
    }
    return lengths;
}

class PictureOf : public testing::TestWithParam<Size> {};

INSTANTIATE_TEST_SUITE_P(AnyShape, PictureOf, testing::Values(Size{84, 56}, Size{56, 84}),
                         [](const auto& size) {
                             return size.param.width > size.param.height ? "Wide" : "Tall";
                         });

TEST_P(PictureOf, AStraightEdgeHasTheWidthThatWasAskedForAtAnyAngle) {
    const Size size = GetParam();
    for (int angle_deg = 0; angle_deg <= 90; angle_deg += 3) {
        const Scene scene({half_plane(angle_deg, 200)});
        const auto tracer = make_tracer(scene);
        for (const double width : {0.5, 2.0, 8.0, 20.0}) {
            double ink = 0.0;
            constexpr int kPhases = 4;
            for (int phase = 0; phase < kPhases; ++phase) {
                Settings settings = plan_view(size, width);
                const double shift = 0.137 + 0.25 * phase;
                settings.view.eye = Vec3d{shift, 3 * shift, 100};
                settings.view.look_at = Vec3d{shift, 3 * shift, 0};
                settings.lattice = 1 + (angle_deg / 3 + phase) % 4;
                const Film film = render(scene, *tracer, settings, {});
                // Across the line, over the inner 24 pixels along it.
                const bool level = angle_deg <= 45;
                const auto& line = plane(film, "line.A");
                for (int y = 0; y < size.height; ++y) {
                    for (int x = 0; x < size.width; ++x) {
                        const int along = level ? x - size.width / 2 : y - size.height / 2;
                        if (along >= -12 && along < 12)
                            ink += static_cast<double>(line[at(size, x, y)]);
                    }
                }
            }
            const double angle = angle_deg * kDegrees;
            const double measured = ink / (24.0 * kPhases) *
                                    std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)));
            EXPECT_NEAR(measured, width, 0.02 * width) << angle_deg << " degrees";
        }
    }
}

TEST(BoxOnAPlane, HasSilhouettesAboveCreasesWithinAndAnIntersectionBelow) {
    // Seen at 45 degrees round and 30 degrees from above, one scene unit a pixel.
    const auto box = [](Vec3f low, Vec3f high) {
        std::vector<Vec3f> v;
        for (int k = 0; k < 8; ++k) {
            v.push_back({(k & 1) != 0 ? high.x : low.x, (k & 2) != 0 ? high.y : low.y,
                         (k & 4) != 0 ? high.z : low.z});
        }
        Object object = mesh_object(v, {{0, 2, 1},
                                        {1, 2, 3},
                                        {4, 5, 6},
                                        {5, 7, 6},
                                        {0, 1, 4},
                                        {1, 5, 4},
                                        {2, 6, 3},
                                        {3, 6, 7},
                                        {0, 4, 2},
                                        {2, 4, 6},
                                        {1, 3, 5},
                                        {3, 7, 5}});
        smooth_normals(std::get<Mesh>(object.shape));
        return object;
    };
    const double a = 60;
    Object floor = mesh_object({{-500, 0, -500}, {500, 0, -500}, {500, 0, 500}, {-500, 0, 500}},
                               {{0, 1, 2}, {0, 2, 3}});
    const Scene scene({floor, box({-30, 0, -30}, {30, 60, 30})});
    Settings settings = plan_view({160, 160}, 2.0);
    const double up = std::tan(30 * kDegrees) * std::sqrt(2.0);
    settings.view.eye = Vec3d{300, 300 * up + 30, 300};
    settings.view.look_at = Vec3d{0, 30, 0};
    auto found = lengths(scene, settings);
    const double upright = a * std::cos(30 * kDegrees);
    const double slanting =
        a * std::hypot(std::sqrt(0.5), std::sqrt(0.5) * std::sin(30 * kDegrees));
    EXPECT_NEAR(found[LineType::silhouette], 2 * upright + 2 * slanting, 3.0);
    EXPECT_NEAR(found[LineType::crease], upright + 2 * slanting, 3.0);
    EXPECT_NEAR(found[LineType::intersection], 2 * slanting, 3.0);
    EXPECT_LT(found[LineType::self_occlusion] + found[LineType::boundary], 1.0);
}

TEST(BentSheet, HasBoundariesAtItsRimAndASelfOcclusionAtItsCrest) {
    // A sheet bent over like a page: half a cylinder, of which the crest hides the far side.
    std::vector<Vec3f> vertices;
    std::vector<Mesh::Triangle> triangles;
    constexpr std::uint32_t kSteps = 90;
    for (std::uint32_t k = 0; k <= kSteps; ++k) {
        const auto angle = static_cast<float>(k * std::numbers::pi / kSteps);
        for (const float x : {-40.0F, 40.0F}) {
            vertices.push_back({x, 30 * std::sin(angle), 30 * std::cos(angle)});
        }
        if (k == 0) continue;
        const std::uint32_t b = 2 * k;
        triangles.push_back({b - 2, b - 1, b + 1});
        triangles.push_back({b - 2, b + 1, b});
    }
    // Beyond its foot the sheet goes on level, to the back.
    for (const float x : {-40.0F, 40.0F}) vertices.push_back({x, 0, -130});
    const auto last = static_cast<std::uint32_t>(vertices.size() - 1);
    triangles.push_back({last - 3, last - 2, last});
    triangles.push_back({last - 3, last, last - 1});
    Object sheet = mesh_object(vertices, triangles);
    smooth_normals(std::get<Mesh>(sheet.shape));
    Settings settings = plan_view({128, 128}, 2.0);
    const double down = 35 * kDegrees;
    settings.view.eye = Vec3d{0, 300 * std::sin(down), 300 * std::cos(down)};
    auto found = lengths(Scene({sheet}), settings);
    // The crest is as wide as the sheet; so are the boundaries in front and behind.
    EXPECT_NEAR(found[LineType::self_occlusion], 80.0, 4.0);
    EXPECT_GT(found[LineType::boundary], 2 * 80.0);
    EXPECT_LT(found[LineType::crease] + found[LineType::intersection], 6.0);
}

/// A ball of 2 n x n facets.
Object globe(std::uint32_t n) {
    std::vector<Vec3f> vertices;
    std::vector<Mesh::Triangle> triangles;
    for (std::uint32_t j = 0; j <= n; ++j) {
        for (std::uint32_t i = 0; i < 2 * n; ++i) {
            const double u = std::numbers::pi * i / n;
            const double v = std::numbers::pi * j / n;
            vertices.push_back(
                to_float(Vec3d{std::sin(v) * std::cos(u), std::cos(v), std::sin(v) * std::sin(u)}));
            if (j == n) continue;
            const std::uint32_t a = j * 2 * n + i;
            const std::uint32_t b = j * 2 * n + (i + 1) % (2 * n);
            triangles.push_back({a, b, b + 2 * n});
            triangles.push_back({a, b + 2 * n, a + 2 * n});
        }
    }
    Object object = mesh_object(vertices, triangles);
    auto& mesh = std::get<Mesh>(object.shape);
    weld(mesh);
    smooth_normals(mesh);
    return object;
}

// Facets of 9 degrees are just below the least turn of a crease; so are finer ones at any zoom.
TEST(TessellatedSphere, HasNoCreaseAtAnyZoom) {
    for (const std::uint32_t n : {20U, 48U, 120U}) {
        const Scene scene({globe(n)});
        for (const char* normals : {"auto", "geometric"}) {
            for (const double height : {2.4, 0.6, 0.1, 0.01}) {
                for (const double aside : {0.0, 0.4, 0.85}) {
                    Settings settings = plan_view({96, 96}, 2.0);
                    settings.view.eye = Vec3d{aside, 0.3 * aside, 10};
                    settings.view.look_at = Vec3d{aside, 0.3 * aside, 0};
                    settings.view.orthographic = height;
                    set(settings, "normals", normals);
                    auto found = lengths(scene, settings);
                    EXPECT_EQ(found[LineType::crease], 0.0)
                        << n << ", " << normals << ", " << height;
                    EXPECT_EQ(found[LineType::self_occlusion], 0.0)
                        << n << ", " << normals << ", " << height << ", " << aside;
                }
            }
        }
    }
}

/// Behind all else.
Object backdrop(float z) {
    return mesh_object({{-3, -3, z}, {3, -3, z}, {3, 3, z}, {-3, 3, z}}, {{0, 1, 2}, {0, 2, 3}});
}

/// A turned globe seen along z, with a plate behind its contour.
Settings globe_view() {
    Settings settings = plan_view({240, 240}, 2.0);
    settings.view.eye = Vec3d{0, 0, 10};
    settings.view.look_at = Vec3d{0, 0, 0};
    settings.view.orthographic = 2.4;
    return settings;
}

constexpr double kPixel = 2.4 / 240;  // in globe_view

TEST(ContourOfAGlobe, HasNoIntersectionWithAPlateBehindIt) {
    double wrong = 0.0;
    double all = 0.0;
    for (const std::uint32_t n : {20U, 48U, 120U}) {
        for (const double gap : {0.05, 0.1, 0.2, 0.5, 1.0, 3.0}) {
            const Scene scene({globe(n), backdrop(static_cast<float>(-gap * kPixel))});
            auto found = lengths(scene, globe_view());
            EXPECT_EQ(found[LineType::self_occlusion] + found[LineType::crease], 0.0);
            wrong += found[LineType::intersection];
            all += found[LineType::intersection] + found[LineType::silhouette];
        }
    }
    EXPECT_GT(all, 18 * 620.0);
    EXPECT_LT(wrong, 1e-3 * all);
}

// It is as steep as a hundred there: what is within a thousandth of a pixel of a facet's edge may
// pass for a contour.
TEST(ContourOfAGlobe, SunkIntoAPlateIsAnIntersection) {
    for (const std::uint32_t n : {20U, 48U, 120U}) {
        for (const double depth : {1.0, 3.0, 10.0, 40.0}) {
            const Scene scene({globe(n), backdrop(static_cast<float>(depth * kPixel))});
            auto found = lengths(scene, globe_view());
            const double wrong = found[LineType::silhouette];
            const double all = found[LineType::intersection] + wrong;
            EXPECT_GT(all, 570.0);
            EXPECT_LT(wrong, (depth > 1.0 ? 0.02 : 0.04) * all) << n << ", " << depth;
        }
    }
}

/// Hills in triangles, over which lines of sight graze.
Object hills() {
    constexpr std::uint32_t kSide = 60;
    std::vector<Vec3f> vertices;
    std::vector<Mesh::Triangle> triangles;
    for (std::uint32_t j = 0; j <= kSide; ++j) {
        for (std::uint32_t i = 0; i <= kSide; ++i) {
            const double x = 2.0 * i / kSide - 1.0;
            const double z = 2.0 * j / kSide - 1.0;
            const double y = 0.12 * std::sin(9 * x + 3 * z) * std::cos(7 * z - 2 * x) +
                             0.012 * std::sin(41 * x) * std::sin(37 * z);
            vertices.push_back(to_float(Vec3d{x, y, z}));
            if (i == kSide || j == kSide) continue;
            const std::uint32_t a = j * (kSide + 1) + i;
            triangles.push_back({a, a + 1, a + kSide + 2});
            triangles.push_back({a, a + kSide + 2, a + kSide + 1});
        }
    }
    Object object = mesh_object(vertices, triangles);
    smooth_normals(std::get<Mesh>(object.shape));
    return object;
}

/// A plate in two halves, the crack between them so many pixels wide. Along one half a wall goes
/// down, which shows in the crack.
Object cracked_plate(double angle_deg, double shift, double width) {
    const double a = angle_deg * kDegrees;
    const Vec3d along{std::cos(a), std::sin(a), 0.0};
    const Vec3d left{-along.y, along.x, 0.0};
    const auto corner = [&](double s, double t, double z) {
        return to_float(along * s + left * (t + shift) + Vec3d{0, 0, z});
    };
    constexpr double kFar = 200.0;
    Object plate = mesh_object(
        {corner(-kFar, 0, 0), corner(kFar, 0, 0), corner(kFar, kFar, 0), corner(-kFar, kFar, 0),
         corner(-kFar, -2 * width, -9), corner(kFar, -2 * width, -9), corner(-kFar, -width, 0),
         corner(kFar, -width, 0), corner(-kFar, -kFar, 0), corner(kFar, -kFar, 0)},
        {{0, 1, 2}, {0, 2, 3}, {4, 5, 1}, {4, 1, 0}, {8, 9, 7}, {8, 7, 6}});
    auto& mesh = std::get<Mesh>(plate.shape);
    weld(mesh);
    smooth_normals(mesh);
    return plate;
}

/// Lattice points see into it here and there: dots in a row.
TEST(CrackInAMesh, ThatIsNarrowerThanAQuarterOfAPixelIsNotSeenAtAnyAngle) {
    const Size size{96, 96};
    for (const double width : {0.03, 0.1, 0.2}) {
        for (int angle_deg = 0; angle_deg < 180; angle_deg += 11) {
            Settings settings = plan_view(size);
            const Scene scene({cracked_plate(angle_deg, 0.137 + 0.01 * angle_deg, width)});
            for (const auto& [type, length] : lengths(scene, settings)) {
                EXPECT_LT(length, 1e-3)
                    << static_cast<int>(type) << ", " << width << ", " << angle_deg;
            }
            set(settings, "compose", "shaded");
            const Film film = draw(scene, settings, {.display = false, .linear = true});
            const auto& light = plane(film, "R");
            const auto [least, most] = std::ranges::minmax(light);
            EXPECT_LT(most - least, 1e-3F * most) << width << ", " << angle_deg;
        }
    }
}

TEST(CrackInAMesh, ThatIsWiderThanAPixelHasALineAlongIt) {
    const Settings settings = plan_view({96, 96});
    for (const double angle_deg : {0.0, 22.0, 57.0}) {
        const Scene scene({cracked_plate(angle_deg, 0.237, 1.2)});
        double total = 0.0;
        for (const auto& [type, length] : lengths(scene, settings)) total += length;
        EXPECT_GT(total, 180.0) << angle_deg;
    }
}

/// A ball has no fold of its own: of balls of one part that do not touch, every outline stays, and
/// be it a pixel beside another one.
TEST(BallsOfOnePart, HaveTheOutlinesOfBallsThatAreToldApart) {
    std::vector<Sphere> balls;
    for (int k = 0; k < 5; ++k) {
        const auto x = static_cast<float>(60 * k - 120);
        balls.push_back({{x, 0, 30}, 25.0F});
        balls.push_back({{x + 1.0F + 0.7F * static_cast<float>(k), 0.3F, -30}, 25.0F});
    }
    const Scene scene({sphere_object(std::move(balls))});
    Settings settings = plan_view({320, 64});
    settings.ids = IdLevel::primitive;
    std::map<LineType, double> apart = lengths(scene, settings);
    settings.ids = IdLevel::object;
    std::map<LineType, double> one = lengths(scene, settings);
    EXPECT_GT(one[LineType::self_occlusion], 100.0);
    EXPECT_NEAR(one[LineType::silhouette] + one[LineType::self_occlusion],
                apart[LineType::silhouette], 0.01 * apart[LineType::silhouette]);
}

TEST(MendedLines, DoNotDependOnTilesOrThreads) {
    const Scene scene({hills()});
    Settings settings = plan_view({240, 160}, 2.0);
    settings.view.orthographic = 1.4;
    settings.view.eye = Vec3d{1, 3.2, 10};
    std::optional<Plane<float>> first;
    for (const int tile : {16, 64, 256}) {
        for (const int threads : {1, 2}) {
            settings.tile = tile;
            settings.threads = threads;
            const auto line = plane(draw(scene, settings), "line.A");
            if (!first) first = line;
            EXPECT_TRUE(line == *first) << tile << ", " << threads;
        }
    }
    EXPECT_GT(lengths(scene, settings)[LineType::self_occlusion], 200.0);
}

}  // namespace
}  // namespace ink::test
