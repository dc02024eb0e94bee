// Apparent ridges against a high-precision evaluation of their definition.

#include "lines/ridges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <variant>
#include <vector>

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

const std::vector<float>& strengths(const Film& film) {
    for (const Channel& channel : film.channels().channels) {
        if (channel.name == "line.A") return std::get<std::vector<float>>(channel.values);
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
};

class RidgesOf : public testing::TestWithParam<RidgeCase> {};

INSTANTIATE_TEST_SUITE_P(Ridges, RidgesOf,
                         testing::Values(RidgeCase{"Stencil", Method::stencil, exact},
                                         RidgeCase{"Edges", Method::edges, exact},
                                         RidgeCase{"StencilOnAMesh", Method::stencil, tessellated},
                                         RidgeCase{"EdgesOnAMesh", Method::edges, tessellated}),
                         [](const auto& ridges) { return ridges.param.name; });

TEST_P(RidgesOf, AnEllipsoidRunWithinHalfAPixelOfTheirDefinition) {
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
    settings.ridge_scale = {5.0, Length::Unit::px};
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
    EXPECT_LT(worst, 0.5);
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

TEST(Ridges, DoNotDependOnTiles) {
    Object object;
    object.kind = ObjectKind::shape;
    object.shape = Glyphs{{GlyphKind::superellipsoid, 0.3, 0.3}, {{}}, {}, {}};
    const Scene scene({object});
    const auto tracer = make_embree_tracer(scene);
    Settings settings;
    settings.size = {120, 100};
    settings.lines.add(LineType::ridge);
    std::vector<Pixels> pictures;
    for (const int tile : {16, 64}) {
        settings.tile = tile;
        settings.threads = tile == 16 ? 1 : 2;
        pictures.push_back(render(scene, *tracer, settings).display().pixels);
    }
    EXPECT_EQ(pictures[0], pictures[1]);
}

}  // namespace
}  // namespace ink::test
