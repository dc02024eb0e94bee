// Apparent ridges against a high-precision evaluation of their definition.

#include "lines/ridges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "lines/ridge_field.h"
#include "lines/short_ridges.h"
#include "lines/smooth_discs.h"
#include "render/draft.h"
#include "render/line_mask.h"
#include "render/render.h"
#include "sampling/stencil.h"
#include "scenes.h"

namespace ink::test {
namespace {

struct Normal {
    long double x, y, z;
};
using NormalField = std::function<Normal(long double x, long double y)>;

/// D_t1 (q1^2) at a point of the screen by differences of `step` of the normal field itself, with
/// t1 on the side of `towards`. Judd et al. 2007: Q is the normal's gradient on screen, q1 and t1
/// its larger singular value and right singular vector.
long double curvature_slope(const NormalField& normal, long double x, long double y,
                            std::array<long double, 2> towards) {
    struct Q {
        long double a, b, c;  // Q^T Q
        long double largest() const {
            return (a + c) / 2 + std::sqrt((a - c) * (a - c) / 4 + b * b);
        }
    };
    const auto q_at = [&](long double u, long double v) {
        const long double h = 1e-3L;
        // Fourth order.
        const auto difference = [&](long double du, long double dv) {
            const Normal a = normal(u + 2 * h * du, v + 2 * h * dv);
            const Normal b = normal(u + h * du, v + h * dv);
            const Normal c = normal(u - h * du, v - h * dv);
            const Normal d = normal(u - 2 * h * du, v - 2 * h * dv);
            const auto mix = [&](long double p, long double q, long double r, long double s) {
                return (-p + 8 * q - 8 * r + s) / (12 * h);
            };
            return Normal{mix(a.x, b.x, c.x, d.x), mix(a.y, b.y, c.y, d.y),
                          mix(a.z, b.z, c.z, d.z)};
        };
        const Normal nx = difference(1, 0);
        const Normal ny = difference(0, 1);
        const auto dot = [](const Normal& p, const Normal& q) {
            return p.x * q.x + p.y * q.y + p.z * q.z;
        };
        return Q{dot(nx, nx), dot(nx, ny), dot(ny, ny)};
    };
    const Q q = q_at(x, y);
    const long double root = std::sqrt((q.a - q.c) * (q.a - q.c) / 4 + q.b * q.b);
    long double tx = (q.a - q.c) / 2 + root;
    long double ty = q.b;
    if (q.a < q.c) {
        tx = q.b;
        ty = root - (q.a - q.c) / 2;
    }
    const long double size = std::hypot(tx, ty);
    const long double sense = tx * towards[0] + ty * towards[1] < 0 ? -1 : 1;
    tx *= sense / size;
    ty *= sense / size;
    const long double e = 1e-2L;
    return (q_at(x + e * tx, y + e * ty).largest() - q_at(x - e * tx, y - e * ty).largest()) /
           (2 * e);
}

/// An ellipsoid with its axes turned about x, seen along -z, one unit a pixel.
struct TurnedEllipsoid {
    Vec3d axes;    ///< half lengths
    double angle;  ///< of its y and z axes from those of the scene

    Placement placement() const {
        const double c = std::cos(angle);
        const double s = std::sin(angle);
        return {to_float(Vec3d{axes.x, 0, 0}),
                to_float(Vec3d{0, axes.y * c, axes.y * s}),
                to_float(Vec3d{0, -axes.z * s, axes.z * c}),
                {}};
    }
    /// In its own axes, p^T D p = 1: the point with the larger z of the line through (x, y).
    Normal normal(long double x, long double y) const {
        const long double c = std::cos(static_cast<long double>(angle));
        const long double s = std::sin(static_cast<long double>(angle));
        const long double da = 1 / (axes.x * axes.x);
        const long double db = 1 / (axes.y * axes.y);
        const long double dc = 1 / (axes.z * axes.z);
        // Own coordinates: u = x, v = c y + s z, w = -s y + c z.
        const long double A = db * s * s + dc * c * c;
        const long double B = (db - dc) * c * s * y;
        const long double C = da * x * x + (db * c * c + dc * s * s) * y * y - 1;
        const long double z = (-B + std::sqrt(B * B - A * C)) / A;
        const long double v = c * y + s * z;
        const long double w = -s * y + c * z;
        const long double nx = da * x;
        const long double ny = db * v * c - dc * w * s;
        const long double nz = db * v * s + dc * w * c;
        const long double size = std::sqrt(nx * nx + ny * ny + nz * nz);
        return {nx / size, ny / size, nz / size};
    }
};

const Plane<float>& strengths(const Film& film) {
    for (const Channel& channel : film.channels().channels) {
        if (channel.name == "line.A") return std::get<Plane<float>>(channel.values);
    }
    throw std::logic_error("no such plane");
}

Object exact(const TurnedEllipsoid& ellipsoid) {
    Object object;
    object.kind = ObjectKind::shape;
    object.shape = Glyphs{{GlyphKind::ellipsoid}, {ellipsoid.placement()}, {}, {}};
    return object;
}

/// In triangles of a pixel or two, whose normals are interpolated.
Object tessellated(const TurnedEllipsoid& ellipsoid) {
    constexpr std::uint32_t kAround = 720;
    constexpr std::uint32_t kRows = 360;
    const Placement place = ellipsoid.placement();
    std::vector<Vec3f> vertices;
    std::vector<Mesh::Triangle> triangles;
    for (std::uint32_t j = 0; j <= kRows; ++j) {
        const double v = std::numbers::pi * j / kRows;
        for (std::uint32_t i = 0; i < kAround; ++i) {
            const double u = 2 * std::numbers::pi * i / kAround;
            vertices.push_back(to_float(
                place.point({std::sin(v) * std::cos(u), std::sin(v) * std::sin(u), std::cos(v)})));
            if (j == kRows) continue;
            const std::uint32_t a = j * kAround + i;
            const std::uint32_t b = j * kAround + (i + 1) % kAround;
            triangles.push_back({a, a + kAround, b});
            triangles.push_back({b, a + kAround, b + kAround});
        }
    }
    Object object = mesh_object(std::move(vertices), std::move(triangles));
    smooth_normals(std::get<Mesh>(object.shape));
    return object;
}

struct RidgeCase {
    std::string name;
    Method method;
    Object (*object)(const TurnedEllipsoid&);
    double most_px;  ///< from their definition
    double scale_px = 5.0;
};

class RidgesOf : public testing::TestWithParam<RidgeCase> {};

INSTANTIATE_TEST_SUITE_P(
    Ridges, RidgesOf,
    testing::Values(RidgeCase{"Stencil", Method::stencil, exact, 0.45},
                    RidgeCase{"Edges", Method::edges, exact, 0.15},
                    RidgeCase{"StencilOnAMesh", Method::stencil, tessellated, 0.45},
                    RidgeCase{"EdgesOnAMesh", Method::edges, tessellated, 0.15},
                    RidgeCase{"EdgesFromAWideScale", Method::edges, exact, 0.51, 8.0},
                    RidgeCase{"EdgesOnAMeshFromAWideScale", Method::edges, tessellated, 0.51, 8.0}),
    [](const auto& ridges) { return ridges.param.name; });

TEST_P(RidgesOf, AnEllipsoidRunWhereTheirDefinitionPutsThem) {
    constexpr int kSide = 400;
    const TurnedEllipsoid ellipsoid{{180, 70, 170}, 0.25};
    Settings settings;
    settings.size = {kSide, kSide};
    settings.view.view = View::front;
    settings.view.eye = Vec3d{0, 0, 1000};
    settings.view.look_at = Vec3d{0, 0, 0};
    settings.view.orthographic = kSide;
    settings.aovs = {Aov::lines};
    settings.method = GetParam().method;
    settings.metric = Metric{Metric::Kind::solid};
    settings.line_width = {3.0, Length::Unit::px};
    settings.ridge_scale = {GetParam().scale_px, Length::Unit::px};
    settings.ridge_turn_deg = 0.5;
    settings.lines = {};
    settings.lines.add(LineType::ridge);
    settings.threads = 1;
    const Scene scene({GetParam().object(ellipsoid)});
    const auto tracer = make_tracer(scene);
    const Film film = render(scene, *tracer, settings);
    const auto& ink = strengths(film);

    int columns = 0;
    double worst = 0.0;
    for (int i = 80; i < kSide - 80; i += 7) {
        const long double x = i + 0.5L - kSide / 2;
        double sum = 0.0;
        double moment = 0.0;
        for (int j = 0; j < kSide; ++j) {
            const double e = ink[static_cast<std::size_t>(j) * kSide + static_cast<std::size_t>(i)];
            sum += e;
            moment += e * (kSide / 2.0 - j - 0.5);
        }
        ASSERT_GT(sum, 1.0) << "no ridge in column " << i;
        const long double drawn = moment / sum;
        const auto slope = [&](long double y) {
            return curvature_slope(
                [&](long double u, long double v) { return ellipsoid.normal(u, v); }, x, y, {0, 1});
        };
        long double below = drawn - 4;
        long double above = drawn + 4;
        ASSERT_GT(slope(below), 0);
        ASSERT_LT(slope(above), 0);
        for (int step = 0; step < 40; ++step) {
            const long double middle = (below + above) / 2;
            (slope(middle) > 0 ? below : above) = middle;
        }
        worst = std::max(worst, static_cast<double>(std::abs(drawn - below)));
        ++columns;
    }
    EXPECT_GT(columns, 30);
    EXPECT_LT(worst, GetParam().most_px);
    RecordProperty("worst_px", std::to_string(worst));
}

TEST(RidgeEstimator, IsExactForNormalsThatArePolynomials) {
    // A curved ridge in a made-up field: the estimate must not depend on where the points are.
    const auto normal = [](float x, float y) {
        return Vec3f{0.1F * x - 0.002F * x * x * x + 0.001F * x * y, 0.02F * y, 1.0F};
    };
    std::vector<RidgeEstimate> found;
    for (const float radius : {1.0F, 2.0F}) {
        std::vector<Vec2f> points{{0, 0}};
        for (const Vec2f p : ring_stencil(radius, 2)) points.push_back(p);
        const RidgeEstimator estimator(points, {0.001F, 0.002F});
        std::vector<Vec3f> normals;
        for (const Vec2f p : points) normals.push_back(normal(0.7F + p.x, 0.3F + p.y));
        found.push_back(estimator.estimate(normals));
    }
    EXPECT_NEAR(found[0].slope, found[1].slope, 1e-4F);
    EXPECT_NEAR(found[0].gradient.x, found[1].gradient.x, 1e-3F);
    EXPECT_NEAR(found[0].distance(), found[1].distance(), 1e-2F);
    EXPECT_GT(found[0].strength, 0.9F);
    // n_x turns by 0.1 - 0.006 x^2 + ...: most at x near 0.
    EXPECT_NEAR(found[0].distance(), 0.7F, 0.15F);
}

TEST(RidgeEstimator, SeesNoRidgeOnAPlaneOrABall) {
    std::vector<Vec2f> points{{0, 0}};
    for (const Vec2f p : ring_stencil(4.0F, 2)) points.push_back(p);
    const RidgeEstimator estimator(points, {0.001F, 0.002F});
    std::vector<Vec3f> flat(points.size(), {0, 0, 1});
    EXPECT_EQ(estimator.estimate(flat).strength, 0.0F);
    std::vector<Vec3f> ball;
    for (const Vec2f p : points) {
        const float x = (p.x + 20) / 100;
        const float y = (p.y + 10) / 100;
        ball.push_back({x, y, std::sqrt(1 - x * x - y * y)});
    }
    EXPECT_EQ(estimator.estimate(ball).strength, 0.0F);
}

Object superellipsoid(Placement placement) {
    Object object;
    object.kind = ObjectKind::shape;
    object.shape = Glyphs{{GlyphKind::superellipsoid, 0.3, 0.3}, {placement}, {}, {}};
    return object;
}

TEST(Ridges, DoNotDependOnTilesAndThreads) {
    const Scene scene({superellipsoid({})});
    const auto tracer = make_embree_tracer(scene);
    Settings settings;
    settings.size = {120, 100};
    settings.lines.add(LineType::ridge);
    for (const double scale_px : {2.0, 5.0, 9.0, 19.0}) {
        settings.ridge_scale = {scale_px, Length::Unit::px};
        std::vector<Pixels> pictures;
        for (const int tile : {16, 64}) {
            settings.tile = tile;
            settings.threads = tile == 16 ? 1 : 2;
            pictures.push_back(render(scene, *tracer, settings).display().pixels);
        }
        EXPECT_EQ(pictures[0], pictures[1]) << scale_px << " pixels";
    }
}

TEST(Ridges, AtTheRimOfAPictureAreThoseOfALargerOne) {
    const TurnedEllipsoid ellipsoid{{180, 70, 170}, 0.25};
    const Scene scene({exact(ellipsoid)});
    const auto tracer = make_tracer(scene);
    const auto ink_of = [&](int side, double scale_px) {
        Settings settings;
        settings.size = {side, side};
        settings.view.view = View::front;
        settings.view.eye = Vec3d{0, 0, 1000};
        settings.view.look_at = Vec3d{0, 0, 0};
        settings.view.orthographic = side;
        settings.aovs = {Aov::lines};
        settings.ridge_scale = {scale_px, Length::Unit::px};
        // Degrees for each hundredth of the height: the same for each pixel.
        settings.ridge_turn_deg = 0.5 * side / 400;
        settings.line_density = 1.0;
        settings.lines = {};
        settings.lines.add(LineType::ridge);
        return strengths(render(scene, *tracer, settings));
    };
    constexpr int kSmall = 120;
    constexpr int kBorder = 12;
    constexpr int kLarge = kSmall + 2 * kBorder;
    for (const double scale_px : {5.0, 9.0}) {
        const auto small = ink_of(kSmall, scale_px);
        const auto large = ink_of(kLarge, scale_px);
        double inked = 0.0;
        double worst = 0.0;
        for (std::size_t j = 0; j < kSmall; ++j) {
            for (std::size_t i = 0; i < kSmall; ++i) {
                const float ink = small[j * kSmall + i];
                inked += ink;
                const float expected = large[(j + kBorder) * kLarge + i + kBorder];
                worst = std::max<double>(worst, std::abs(ink - expected));
            }
        }
        EXPECT_GT(inked, kSmall) << "no ridge from one side to the other";
        EXPECT_LT(worst, 0.02) << scale_px << " pixels";
    }
}

TEST(Ridges, StayInTheirPlacesAndWidthsInDrafts) {
    const Scene scene({exact({{180, 70, 170}, 0.25})});
    const auto tracer = make_tracer(scene);
    Settings settings;
    settings.size = {601, 600};
    settings.view.view = View::front;
    settings.view.eye = Vec3d{0, 0, 1000};
    settings.view.look_at = Vec3d{0, 0, 0};
    settings.view.orthographic = 400;
    settings.compose = Compose::lines;
    settings.ridge_scale = {8.0, Length::Unit::px};
    settings.ridge_turn_deg = 0.5;
    settings.lines = {};
    settings.lines.add(LineType::ridge);
    const auto ink_of = [](const Film& film) {
        std::vector<double> ink;
        for (const std::uint32_t pixel : film.display().pixels) ink.push_back(255 - (pixel & 255U));
        return ink;
    };
    const std::vector<double> full = ink_of(render(scene, *tracer, settings));
    const double total = std::accumulate(full.begin(), full.end(), 0.0);
    ASSERT_GT(total, 255 * 400) << "no ridge across most of the picture";
    for (const double share : {0.75, 0.5, 0.375, 0.25}) {
        const std::vector<double> draft = ink_of(render_draft(scene, *tracer, settings, share));
        EXPECT_NEAR(std::accumulate(draft.begin(), draft.end(), 0.0), total, 0.03 * total) << share;
        double elsewhere = 0.0;
        for (std::size_t k = 0; k < full.size(); ++k) elsewhere += std::abs(draft[k] - full[k]);
        // Half a pixel beside its place, a line of two pixels has half of its ink elsewhere.
        EXPECT_LT(elsewhere, 0.5 * total) << share;
    }
}

TEST(Ridges, BesideALineThatIsDrawnAnywayAreLeftOut) {
    // A roof, whose sides' normals are smooth but for the crease along its top.
    Object roof =
        mesh_object({{-2, -1, 0}, {2, -1, 0}, {-2, 0, 0.4F}, {2, 0, 0.4F}, {-2, 1, 0}, {2, 1, 0}},
                    {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}});
    smooth_normals(std::get<Mesh>(roof.shape), {});
    const Scene scene({std::move(roof)});
    const auto tracer = make_tracer(scene);
    Settings settings;
    settings.size = {100, 100};
    settings.view.view = View::front;
    settings.view.eye = Vec3d{0, 0, 10};
    settings.view.look_at = Vec3d{0, 0, 0};
    settings.view.orthographic = 1.6;
    settings.lines = {};
    settings.lines.add(LineType::crease);
    const Pixels creases = render(scene, *tracer, settings).display().pixels;
    settings.lines.add(LineType::ridge);
    EXPECT_EQ(render(scene, *tracer, settings).display().pixels, creases);
    settings.lines = {};
    settings.lines.add(LineType::ridge);
    const Pixels ridges = render(scene, *tracer, settings).display().pixels;
    settings.lines = {};
    EXPECT_NE(ridges, render(scene, *tracer, settings).display().pixels) << "there is none";
}

/// A roof with a crease along its top, one side of which bends down smoothly, `bend_at` below it.
Object bent_roof(double bend_at) {
    constexpr double kSlope = 0.4;
    constexpr int kSteps = 4;
    std::vector<Vec2d> profile{{1, -kSlope}, {0, 0}};
    Vec2d at{-bend_at, -kSlope * bend_at};
    profile.push_back(at);
    for (int k = 1; k <= kSteps; ++k) {
        const double angle = std::atan(kSlope) + 0.5 * k / kSteps;
        at = at + Vec2d{-0.015, -0.015 * std::tan(angle)};
        profile.push_back(at);
    }
    profile.push_back(at + Vec2d{-1, -std::tan(std::atan(kSlope) + 0.5)});
    std::vector<Vec3f> vertices;
    std::vector<Mesh::Triangle> triangles;
    for (const Vec2d p : profile) {
        const auto k = static_cast<std::uint32_t>(vertices.size());
        for (const double x : {-3.0, 3.0}) vertices.push_back(to_float(Vec3d{x, p.x, p.y}));
        if (k == 0) continue;
        triangles.push_back({k - 2, k, k + 1});
        triangles.push_back({k - 2, k + 1, k - 1});
    }
    Object roof = mesh_object(std::move(vertices), std::move(triangles));
    smooth_normals(std::get<Mesh>(roof.shape), {});
    return roof;
}

TEST(Ridges, AlongALineWithinTheirNeighbourhoodAreLeftOut) {
    constexpr double kPixel = 0.01;
    Settings settings;
    settings.size = {200, 200};
    settings.view.view = View::front;
    settings.view.eye = Vec3d{0, 0, 10};
    settings.view.look_at = Vec3d{0, 0, 0};
    settings.view.orthographic = 200 * kPixel;
    settings.ridge_scale = {6.0, Length::Unit::px};
    settings.ridge_turn_deg = 1.0;
    const auto has_ridge = [&](double distance_px) {
        const Scene scene({bent_roof(distance_px * kPixel)});
        const auto tracer = make_tracer(scene);
        settings.lines = {};
        settings.lines.add(LineType::crease);
        const Pixels creases = render(scene, *tracer, settings).display().pixels;
        settings.lines.add(LineType::ridge);
        return render(scene, *tracer, settings).display().pixels != creases;
    };
    EXPECT_TRUE(has_ridge(30));
    EXPECT_TRUE(has_ridge(12));
    EXPECT_FALSE(has_ridge(6));
}

// A plane z = 0 with a step in it, and a hole.
RidgeGrid stepped_plane(int width, int height, int step_at, int hole_x, int hole_y) {
    RidgeGrid grid(width, height, {}, 1.0F);
    for (int j = 0; j < height; ++j) {
        for (int i = 0; i < width; ++i) {
            const std::size_t n = grid.index(i, j);
            grid.id[n] = i == hole_x && j == hole_y ? kBackground : 7;
            grid.t[n] = i < step_at ? 20.0F : 15.0F;
            grid.nx[n] = grid.ny[n] = 0.0F;
            grid.nz[n] = 1.0F;
        }
    }
    return grid;
}

TEST(SmoothDiscs, HoldNeitherAStepNorAHole) {
    constexpr int kWidth = 150;  // three words
    constexpr int kHeight = 21;
    for (const auto& [step_at, hole_x, hole_y] :
         {std::array{64, 100, 10}, std::array{128, 63, 9}, std::array{20, 127, 12}}) {
        const RidgeGrid grid = stepped_plane(kWidth, kHeight, step_at, hole_x, hole_y);
        const std::vector<int> half_widths{4, 4, 3, 2, 0};
        const Viewpoint from_above{
            {}, {0, 0, -1}, true, {{0, 0, 20}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, -2}, {}, {}}};
        SmoothDiscs discs(grid, from_above, half_widths);
        constexpr int kRadius = 4;
        discs.start(kRadius);
        for (int j = kRadius; j < kHeight - kRadius; ++j) {
            const std::vector<NodeBits>& found = discs.next();
            for (int i = kRadius; i < kWidth - kRadius; ++i) {
                bool hole = false;
                for (int d = -kRadius; d <= kRadius; ++d) {
                    const int half = half_widths[static_cast<std::size_t>(std::abs(d))];
                    hole |= j + d == hole_y && std::abs(i - hole_x) <= half;
                }
                // Some row of the disc has nodes on both sides of the step.
                const bool step = i - half_widths[0] < step_at && i + half_widths[0] >= step_at;
                const bool smooth = (found[static_cast<std::size_t>(i) / 64] >> i % 64 & 1U) != 0;
                EXPECT_EQ(smooth, !hole && !step) << i << ", " << j;
            }
        }
    }
}

TEST(RidgePattern, IsExactForNormalsThatAreCubic) {
    // Each derivative of x^a y^b / (a! b!) at 0 is 1 or 0, whatever the disc's radius.
    for (const int radius : {2, 3, 4, 5, 7, 8, 11, 16, 48}) {
        const RidgePattern pattern(radius, 0.5F);
        const std::array<std::array<int, 2>, RidgeEstimator::kDerivatives> powers{
            {{1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}, {3, 0}, {2, 1}, {1, 2}, {0, 3}}};
        for (std::size_t of = 0; of < powers.size(); ++of) {
            for (std::size_t by = 0; by < powers.size(); ++by) {
                double sum = 0.0;
                for (const RidgePattern::Point& point : pattern.points) {
                    const auto term = [&](int sx, int sy) {
                        const auto power = [](double x, int n) {
                            return std::pow(x, n) / std::tgamma(n + 1.0);
                        };
                        // Weights of mirrored points differ by their sign only.
                        const int sign =
                            (powers[by][0] % 2 != 0 ? sx : 1) * (powers[by][1] % 2 != 0 ? sy : 1);
                        return power(0.5 * sx * point.i, powers[of][0]) *
                               power(0.5 * sy * point.j, powers[of][1]) * point.weights[by] * sign;
                    };
                    sum += term(1, 1) + (point.i > 0 ? term(-1, 1) : 0.0) +
                           (point.j > 0 ? term(1, -1) : 0.0) +
                           (point.i > 0 && point.j > 0 ? term(-1, -1) : 0.0);
                }
                EXPECT_NEAR(sum, of == by ? 1.0 : 0.0, 1e-4 * radius * radius)
                    << radius << ": " << of << " by " << by;
            }
        }
    }
}

TEST(ShortRidges, AreThoseWhosePiecesInAllAreShorterThanADiscIsWide) {
    // Through cells of a grid of 20 x 20 nodes: along row 2 and down column 5, 6 pixels in all, and
    // two pieces that are alone.
    constexpr int kWidth = 20;
    const auto across = [](std::size_t i, std::size_t j) { return 2 * (j * kWidth + i); };
    const auto down = [&](std::size_t i, std::size_t j) { return across(i, j) + 1; };
    const auto piece = [](float length, std::size_t a, std::size_t b) {
        return RidgePiece{{0, 0}, {length, 0}, 1.0F, 0, {a, b}};
    };
    const std::vector<RidgePiece> all{
        piece(2, down(4, 2), down(5, 2)), piece(2.5F, down(5, 2), across(5, 3)),
        piece(5.5F, down(15, 2), down(16, 2)), piece(2, across(1, 3), across(1, 4)),
        piece(1.5F, across(5, 3), down(6, 3))};
    const auto kept = [&](float least) {
        std::vector<RidgePiece> pieces = all;
        std::vector<float> lengths;
        for (const RidgePiece& each : pieces) lengths.push_back(length(each.b - each.a));
        drop_short_ridges(pieces, lengths, kWidth, 0.5F * least);
        lengths.clear();
        for (const RidgePiece& left : pieces) lengths.push_back(length(left.b - left.a));
        return lengths;
    };
    EXPECT_EQ(kept(1.9F), (std::vector{2.0F, 2.5F, 5.5F, 2.0F, 1.5F}));
    EXPECT_EQ(kept(5.4F), (std::vector{2.0F, 2.5F, 5.5F, 1.5F}));
    EXPECT_EQ(kept(5.9F), (std::vector{2.0F, 2.5F, 1.5F}));
    EXPECT_TRUE(kept(6.1F).empty());
    // Of pieces that do not count the ridge is no longer, but they stay with it.
    std::vector<RidgePiece> pieces = all;
    drop_short_ridges(pieces, std::vector{2.0F, 0.0F, 5.5F, 2.0F, 1.5F}, kWidth, 1.7F);
    EXPECT_EQ(pieces.size(), 4U);
    pieces = all;
    drop_short_ridges(pieces, std::vector{2.0F, 0.0F, 5.5F, 2.0F, 1.5F}, kWidth, 1.8F);
    EXPECT_EQ(pieces.size(), 1U);
}

TEST(LineMask, CoversThePixelsWithinReach) {
    const Tile area{-8, -4, 152, 36};
    LineMask mask(area);
    const std::vector<std::pair<Vec2f, float>> marks{
        {{60.3F, 10.2F}, 2.5F}, {{-7.5F, -3.5F}, 3.0F}, {{100, 20}, 70.0F}, {{10.5F, 30.5F}, 0.1F}};
    for (const auto& [point, reach] : marks) mask.mark(point, reach);
    for (int y = area.y0; y < area.y1; ++y) {
        for (int x = area.x0; x < area.x1; ++x) {
            const Vec2f middle{static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F};
            const bool near = std::ranges::any_of(marks, [&](const auto& mark) {
                return length(middle - mark.first) <= mark.second;
            });
            EXPECT_EQ(mask.covers(middle), near) << x << ", " << y;
        }
    }
    EXPECT_FALSE(mask.covers({-9.0F, 0.0F}));
    EXPECT_FALSE(mask.covers({0.0F, 36.0F}));
}

}  // namespace
}  // namespace ink::test
