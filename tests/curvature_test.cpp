// How normals turn from ray to ray on exact shapes, against closed forms.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "accel/shape_intersection.h"
#include "curvatures.h"

namespace ink {
namespace {

using std::numbers::pi;

using test::Curvatures;

/// Principal curvatures of the surface seen along -z at (x, y), from central differences of the
/// normals of four neighbouring rays.
Curvatures traced_curvatures(const PlacedShape& shape, double x, double y, double step) {
    struct Seen {
        Vec3d point, normal;
    };
    const auto look = [&](double u, double v) {
        const ShapeRay ray{{u, v, 5.0}, {0, 0, -1}};
        const auto hit = shape.intersect(ray, 0.0, 1e9);
        EXPECT_TRUE(hit.has_value());
        return hit ? Seen{ray.origin + ray.dir * hit->t, normalize(hit->normal)} : Seen{};
    };
    const Seen right = look(x + step, y);
    const Seen left = look(x - step, y);
    const Seen up = look(x, y + step);
    const Seen down = look(x, y - step);
    return test::curvatures(right.point - left.point, up.point - down.point,
                            right.normal - left.normal, up.normal - down.normal);
}

TEST(Curvature, OfAnEllipsoidIsItsClosedForm) {
    const PlacedShape shape({GlyphKind::ellipsoid}, {{2, 0, 0}, {0, 1, 0}, {0, 0, 0.5F}, {}});
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.7, 0.2}, {1.2, -0.4}, {-0.3, 0.8}}) {
        const double z = 0.5 * std::sqrt(1.0 - x * x / 4.0 - y * y);
        // Do Carmo, Differential Geometry: with h = x^2/a^4 + y^2/b^4 + z^2/c^4,
        // K = 1 / (a b c h)^2 and H = (a^2 + b^2 + c^2 - |p|^2) / (2 (a b c)^2 h^(3/2)).
        const double h = x * x / 16.0 + y * y + 16.0 * z * z;
        const double abc = 2.0 * 1.0 * 0.5;
        const double K = 1.0 / (abc * abc * h * h);
        const double H =
            (4.0 + 1.0 + 0.25 - x * x - y * y - z * z) / (2.0 * abc * abc * std::pow(h, 1.5));
        const Curvatures k = traced_curvatures(shape, x, y, 1e-4);
        EXPECT_NEAR(k.least * k.most, K, 1e-5 * K);
        EXPECT_NEAR(0.5 * (k.least + k.most), H, 1e-5 * H);
    }
}

TEST(Curvature, OfATorusIsThatOfItsTubeAndItsRings) {
    const double a = 0.4;
    const PlacedShape shape({GlyphKind::torus, a}, {});
    for (const double v : {0.4, 1.0, 1.5, 2.2, 2.8}) {  // angle around the tube, seen from above
        const double rho = 1.0 + a * std::cos(v);
        const Curvatures k = traced_curvatures(shape, rho * 0.6, rho * 0.8, 1e-4);
        const double ring = std::cos(v) / rho;
        EXPECT_NEAR(k.most, 1.0 / a, 1e-4);
        EXPECT_NEAR(k.least, ring, 1e-4);
    }
}

TEST(Curvature, OfACylinderAndAConeIsZeroAlongThem) {
    const Placement lying{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {}};  // z axis along world x
    const Curvatures tube =
        traced_curvatures(PlacedShape({GlyphKind::frustum, 1.0}, lying), 0.2, 0.5, 1e-4);
    EXPECT_NEAR(tube.least, 0.0, 1e-7);
    EXPECT_NEAR(tube.most, 1.0, 1e-6);
    const Curvatures cone =
        traced_curvatures(PlacedShape({GlyphKind::frustum, 0.0}, lying), 0.2, 0.1, 1e-4);
    const double r = 0.5 * (1.0 - 0.2);
    EXPECT_NEAR(cone.least, 0.0, 1e-6);
    EXPECT_NEAR(cone.most, std::cos(std::atan(0.5)) / r, 1e-5);
}

TEST(Curvature, OfHeightFieldsIsTheirHessian) {
    for (const UnitShape& unit :
         {UnitShape{GlyphKind::gaussian, 0.4}, UnitShape{GlyphKind::waves, 1.0, 1.5}}) {
        const auto f = [&](double x, double y) {
            return unit.kind == GlyphKind::gaussian
                       ? std::exp(-0.5 * (x * x + y * y) / (unit.a * unit.a))
                       : std::cos(pi * unit.a * x) * std::cos(pi * unit.b * y);
        };
        const double x = 0.23;
        const double y = -0.31;
        const double e = 1e-4;
        const double fx = (f(x + e, y) - f(x - e, y)) / (2 * e);
        const double fy = (f(x, y + e) - f(x, y - e)) / (2 * e);
        const double fxx = (f(x + e, y) - 2 * f(x, y) + f(x - e, y)) / (e * e);
        const double fyy = (f(x, y + e) - 2 * f(x, y) + f(x, y - e)) / (e * e);
        const double fxy =
            (f(x + e, y + e) - f(x + e, y - e) - f(x - e, y + e) + f(x - e, y - e)) / (4 * e * e);
        const double w = 1 + fx * fx + fy * fy;
        const double K = (fxx * fyy - fxy * fxy) / (w * w);
        // Upward normals: a peak is convex, of positive curvature.
        const double H = -0.5 * ((1 + fy * fy) * fxx - 2 * fx * fy * fxy + (1 + fx * fx) * fyy) /
                         std::pow(w, 1.5);
        const Curvatures k = traced_curvatures(PlacedShape(unit, {}), x, y, 1e-4);
        EXPECT_NEAR(k.least * k.most, K, 1e-4 * (1 + std::abs(K)));
        EXPECT_NEAR(0.5 * (k.least + k.most), H, 1e-4 * (1 + std::abs(H)));
    }
}

TEST(Curvature, OfASuperellipsoidIsThatOfItsGraph) {
    const double e = 0.5;
    const double p = 2.0 / e;
    const auto height = [&](double x, double y) {
        return std::pow(1.0 - std::pow(std::abs(x), p) - std::pow(std::abs(y), p), 1.0 / p);
    };
    const double x = 0.6;
    const double y = 0.7;
    const double d = 1e-4;
    const double fx = (height(x + d, y) - height(x - d, y)) / (2 * d);
    const double fy = (height(x, y + d) - height(x, y - d)) / (2 * d);
    const double fxx = (height(x + d, y) - 2 * height(x, y) + height(x - d, y)) / (d * d);
    const double fyy = (height(x, y + d) - 2 * height(x, y) + height(x, y - d)) / (d * d);
    const double fxy = (height(x + d, y + d) - height(x + d, y - d) - height(x - d, y + d) +
                        height(x - d, y - d)) /
                       (4 * d * d);
    const double w = 1 + fx * fx + fy * fy;
    const double K = (fxx * fyy - fxy * fxy) / (w * w);
    const double H =
        -0.5 * ((1 + fy * fy) * fxx - 2 * fx * fy * fxy + (1 + fx * fx) * fyy) / std::pow(w, 1.5);
    const Curvatures k =
        traced_curvatures(PlacedShape({GlyphKind::superellipsoid, e, e}, {}), x, y, 1e-4);
    EXPECT_NEAR(k.least * k.most, K, 1e-4 * (1 + std::abs(K)));
    EXPECT_NEAR(0.5 * (k.least + k.most), H, 1e-4 * (1 + std::abs(H)));
}

}  // namespace
}  // namespace ink
