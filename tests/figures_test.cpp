// What the paper's figures show, against closed forms: where lines must run, for both methods.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "render/render.h"
#include "scenes.h"

namespace ink::test {
namespace {

constexpr int kSide = 256;

Film draw(const std::vector<Object>& objects, const Settings& settings) {
    const Scene scene(objects);
    const auto tracer = make_embree_tracer(scene);
    return render(scene, *tracer, settings);
}

/// Line strengths of a picture, row by row.
const Plane<float>& strengths(const Film& film) {
    for (const Channel& channel : film.channels().channels) {
        if (channel.name == "line.A") return std::get<Plane<float>>(channel.values);
    }
    throw std::logic_error("no such plane");
}

/// Scene point (x, y) for pixel (i, j) when one scene unit is a pixel.
struct Plan {
    double x, y;
    explicit Plan(int i, int j) : x(i + 0.5 - kSide / 2.0), y(kSide / 2.0 - j - 0.5) {}
};

/// Orthographic from +z, one unit a pixel, the origin in the middle, solid lines of 4 pixels.
Settings plan_view(Method method, LineType only) {
    Settings settings;
    settings.size = {kSide, kSide};
    settings.view.view = View::front;
    settings.view.eye = Vec3d{0, 0, 400};
    settings.view.look_at = Vec3d{0, 0, 0};
    settings.view.orthographic = kSide;
    settings.aovs = {Aov::lines};
    settings.method = method;
    settings.metric = Metric{Metric::Kind::solid};
    settings.rings = 3;
    settings.line_width = {4.0, Length::Unit::px};
    settings.lines = {};
    settings.lines.add(only);
    settings.thresholds.depth_share = 0.02F;
    settings.threads = 1;
    return settings;
}

constexpr double kHalfWidth = 2.0;
/// Half a pixel's diagonal: a pixel's ink is an average or a sample of its area.
constexpr double kPixel = 0.75;

/// Ink lies where `distance` (pixels) from a line is within half its width, and nowhere else.
void expect_ink(const Film& film, const std::function<double(Plan)>& distance) {
    const auto& strength = strengths(film);
    int inked = 0;
    int wrong = 0;
    for (int j = 0; j < kSide; ++j) {
        for (int i = 0; i < kSide; ++i) {
            const double d = distance(Plan(i, j));
            const float ink =
                strength[static_cast<std::size_t>(j) * kSide + static_cast<std::size_t>(i)];
            if (d <= kHalfWidth - kPixel) {
                ++inked;
                wrong += ink < 0.9F ? 1 : 0;
            } else if (d > kHalfWidth + kPixel) {
                wrong += ink > 0.0F ? 1 : 0;
            }
        }
    }
    EXPECT_GT(inked, 100);
    EXPECT_EQ(wrong, 0);
}

class BothMethods : public testing::TestWithParam<Method> {};

INSTANTIATE_TEST_SUITE_P(Lines, BothMethods, testing::Values(Method::stencil, Method::edges),
                         [](const auto& method) {
                             return std::string(method.param == Method::edges ? "Edges"
                                                                              : "Stencil");
                         });

Object glyph(const UnitShape& shape, const Placement& placement) {
    Object object;
    object.kind = ObjectKind::shape;
    object.shape = Glyphs{shape, {placement}, {}, {}};
    return object;
}

double segment_distance(Plan p, Vec3d a, Vec3d b) {
    const double dx = b.x - a.x;
    const double dy = b.y - a.y;
    const double along = ((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy);
    const double s = std::clamp(along, 0.0, 1.0);
    return std::hypot(p.x - a.x - s * dx, p.y - a.y - s * dy);
}

TEST_P(BothMethods, DrawASpheresOutlineOnItsProjectedEllipse) {
    // Off the axis of a wide lens, where the outline is far from a circle.
    Settings settings = plan_view(GetParam(), LineType::silhouette);
    settings.view.orthographic.reset();
    settings.view.eye = Vec3d{0, 0, 10};
    settings.view.fov_deg = 70;
    const Vec3d centre{2.5, -2.0, 3.0};
    const double radius = 1.2;
    const Film film = draw({sphere_object({{to_float(centre), 1.2F}})}, settings);
    const double tan_half = std::tan(35.0 * std::numbers::pi / 180.0);
    const Vec3d to_centre = centre - Vec3d{0, 0, 10};
    const double cone = std::asin(radius / length(to_centre));
    const auto off_cone = [&](double x, double y) {
        const Vec3d dir = normalize(Vec3d{x * tan_half * 2 / kSide, y * tan_half * 2 / kSide, -1});
        return std::acos(dot(dir, to_centre) / length(to_centre)) - cone;
    };
    expect_ink(film, [&](Plan p) {
        const double value = off_cone(p.x, p.y);
        const double gx = (off_cone(p.x + 0.01, p.y) - off_cone(p.x - 0.01, p.y)) / 0.02;
        const double gy = (off_cone(p.x, p.y + 0.01) - off_cone(p.x, p.y - 0.01)) / 0.02;
        return std::abs(value) / std::hypot(gx, gy);
    });
}

TEST_P(BothMethods, DrawTheSeamOfTwoSpheresOnTheirRadicalPlane) {
    const Vec3d a{-30, 5, 0};
    const Vec3d b{40, -10, 10};
    const double ra = 60;
    const double rb = 50;
    Settings settings = plan_view(GetParam(), LineType::intersection);
    // The stencil method does not tell an intersection from a silhouette.
    settings.lines.add(LineType::silhouette);
    const Film film = draw({sphere_object({{to_float(a), 60.0F}, {to_float(b), 50.0F}})}, settings);

    const Vec3d axis = normalize(b - a);
    const double apart = length(b - a);
    const double along = (apart * apart + ra * ra - rb * rb) / (2 * apart);
    const double seam_radius = std::sqrt(ra * ra - along * along);
    const Vec3d middle = a + axis * along;
    const Vec3d u = normalize(cross(axis, Vec3d{0, 0, 1}));
    const Vec3d v = cross(axis, u);
    // Outlines and seam, as far as neither ball hides them.
    std::vector<Vec3d> lines;
    const auto front = [](Vec3d centre, double radius, Vec3d p) {
        const double rest =
            radius * radius - std::pow(p.x - centre.x, 2) - std::pow(p.y - centre.y, 2);
        return rest < 0 ? -1e9 : centre.z + std::sqrt(rest);
    };
    const auto add = [&](Vec3d p) {
        const double slack = 1e-6;
        if (front(a, ra * (1 - 1e-12), p) <= p.z + slack &&
            front(b, rb * (1 - 1e-12), p) <= p.z + slack) {
            lines.push_back(p);
        }
    };
    for (int k = 0; k < 2000; ++k) {
        const double angle = 2 * std::numbers::pi * k / 2000;
        const Vec3d round{std::cos(angle), std::sin(angle), 0};
        add(a + round * (ra * (1 + 1e-9)));
        add(b + round * (rb * (1 + 1e-9)));
        add(middle + (u * std::cos(angle) + v * std::sin(angle)) * seam_radius);
    }
    expect_ink(film, [&](Plan p) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const Vec3d& q : lines) nearest = std::min(nearest, std::hypot(p.x - q.x, p.y - q.y));
        return nearest;
    });
}

TEST_P(BothMethods, DrawABoxsCreasesOnItsVisibleEdges) {
    // Three faces show: the edges about the corner that points at the viewer.
    const double c = std::cos(0.6);
    const double s = std::sin(0.6);
    const double d = std::cos(0.5);
    const double e = std::sin(0.5);
    const Vec3d x{c, s * e, s * d};
    const Vec3d y{0, d, -e};
    const Vec3d z = cross(x, y);
    const double half = 55;
    Placement place{to_float(x * half), to_float(y * half), to_float(z * half), {}};
    const Film film =
        draw({glyph({GlyphKind::box}, place)}, plan_view(GetParam(), LineType::crease));
    const auto facing = [](Vec3d axis) { return axis.z > 0 ? axis : -axis; };
    const Vec3d px = facing(x) * half;
    const Vec3d py = facing(y) * half;
    const Vec3d pz = facing(z) * half;
    const Vec3d corner = px + py + pz;
    expect_ink(film, [&](Plan p) {
        // Where a crease runs into the outline, a stencil sees the outline.
        for (const Vec3d& axis : {px, py, pz}) {
            const Vec3d end = corner - axis * 2.0;
            if (std::hypot(p.x - end.x, p.y - end.y) < 8.0) return std::nan("");
        }
        return std::min({segment_distance(p, corner, corner - px * 2.0),
                         segment_distance(p, corner, corner - py * 2.0),
                         segment_distance(p, corner, corner - pz * 2.0)});
    });
}

TEST_P(BothMethods, DrawATorusHollowWhereItsContourIs) {
    const double R = 80;
    const double a = 0.45;
    const double tilt = 1.2;  // between its axis and the line of sight
    const Vec3d x{1, 0, 0};
    const Vec3d y{0, std::cos(tilt), std::sin(tilt)};
    const Vec3d z = cross(x, y);
    const Placement place{to_float(x * R), to_float(y * R), to_float(z * R), {}};
    Settings settings = plan_view(GetParam(), LineType::self_occlusion);
    settings.thresholds.depth_share = 0.05F;
    const Film film = draw({glyph({GlyphKind::torus, a}, place)}, settings);
    // The contour: where the normal (cos v cos u, cos v sin u, sin v) is at a right angle to sight.
    const Vec3d sight{dot(x, Vec3d{0, 0, 1}), dot(y, Vec3d{0, 0, 1}), dot(z, Vec3d{0, 0, 1})};
    std::vector<Vec3d> contour;
    for (int k = 0; k < 2000; ++k) {
        const double u = 2 * std::numbers::pi * k / 2000;
        const double radial = sight.x * std::cos(u) + sight.y * std::sin(u);
        for (const double v0 : {0.0, std::numbers::pi}) {
            const double v = std::atan2(-radial, sight.z) + v0;
            const double rho = 1 + a * std::cos(v);
            contour.push_back(
                (x * (rho * std::cos(u)) + y * (rho * std::sin(u)) + z * (a * std::sin(v))) * R);
        }
    }
    const auto& strength = strengths(film);
    int inked = 0;
    for (int j = 0; j < kSide; ++j) {
        for (int i = 0; i < kSide; ++i) {
            if (strength[static_cast<std::size_t>(j) * kSide + static_cast<std::size_t>(i)] <
                0.5F) {
                continue;
            }
            ++inked;
            const Plan p(i, j);
            // A stencil takes a slope that is steeper than its threshold for a jump: that goes on
            // beyond the cusps in which the contour ends.
            if (GetParam() == Method::stencil && std::abs(p.x) > 45) continue;
            double nearest = std::numeric_limits<double>::infinity();
            for (const Vec3d& q : contour) {
                nearest = std::min(nearest, std::hypot(p.x - q.x, p.y - q.y));
            }
            EXPECT_LE(nearest, kHalfWidth + kPixel + (GetParam() == Method::stencil ? 1.0 : 0.0))
                << i << ", " << j;
        }
    }
    EXPECT_GT(inked, 200);
    // In the plane of symmetry the near rim of the hollow hides the far part of the tube.
    const double v = std::atan2(-sight.y, sight.z);
    double rim = 0.0;
    for (const double turned : {v, v + std::numbers::pi}) {
        const Vec3d q = (y * (1 + a * std::cos(turned)) + z * (a * std::sin(turned))) * R;
        if (std::cos(turned) < 0) rim = q.y;
    }
    const int j = static_cast<int>(kSide / 2.0 - rim);
    EXPECT_GT(strength[static_cast<std::size_t>(j) * kSide + kSide / 2], 0.9F);
}

TEST_P(BothMethods, DrawTheGaussiansPeakWhereItHidesItsFoot) {
    // Seen from the side and a little above, the flank of the peak stands before the plain behind.
    const Vec3d x{1, 0, 0};
    const Vec3d up{0, std::cos(0.5), std::sin(0.5)};
    const Vec3d y = cross(up, x);
    const Placement place{to_float(x * 110.0), to_float(y * 110.0), to_float(up * 90.0), {}};
    const Film film = draw({glyph({GlyphKind::gaussian, 0.2}, place)},
                           plan_view(GetParam(), LineType::self_occlusion));
    const auto& strength = strengths(film);
    int inked = 0;
    for (const float ink : strength) inked += ink > 0.5F ? 1 : 0;
    EXPECT_GT(inked, 150);
    // Symmetric left and right.
    for (int j = 0; j < kSide; ++j) {
        for (int i = 0; i < kSide / 2; ++i) {
            const auto row = static_cast<std::size_t>(j) * kSide;
            EXPECT_NEAR(strength[row + static_cast<std::size_t>(i)],
                        strength[row + static_cast<std::size_t>(kSide - 1 - i)], 0.35F);
        }
    }
}

// The paper's footnote 2: "If the normals are interpolated [...] the technique will not pick up
// sharp corners at the triangle edges."
TEST_P(BothMethods, LoseTheCreasesOfAMeshToInterpolatedNormalsIfTold) {
    // A roof of 90 degrees whose file gives one upward normal to every corner.
    Object roof = mesh_object(
        {{-60, -80, 0}, {0, -80, 60}, {60, -80, 0}, {-60, 80, 0}, {0, 80, 60}, {60, 80, 0}},
        {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}});
    auto& mesh = std::get<Mesh>(roof.shape);
    smooth_normals(mesh);
    mesh.line_normals = mesh.corner_normals;
    const std::uint32_t up = pack_normal({0, 0, 1});
    mesh.corner_normals.assign(mesh.triangles.size(), {up, up, up});
    Settings settings = plan_view(GetParam(), LineType::crease);
    const auto ridge = [](Plan p) {
        // Where the crease runs into the outline, a stencil sees the outline.
        if (std::abs(std::abs(p.y) - 80) < 6) return std::nan("");
        return std::abs(p.x) + std::max(std::abs(p.y) - 80, 0.0);
    };
    expect_ink(draw({roof}, settings), ridge);
    settings.shading.normals = NormalSource::geometric;
    expect_ink(draw({roof}, settings), ridge);
    settings.shading.normals = NormalSource::shading;
    const Film smooth = draw({roof}, settings);
    for (const float ink : strengths(smooth)) ASSERT_EQ(ink, 0.0F);
    // An object's own choice goes before the picture's.
    roof.normals = NormalSource::geometric;
    expect_ink(draw({roof}, settings), ridge);
}

TEST(Objects, KeepTheirOwnLevelOfIds) {
    std::vector<Object> objects{sphere_object({{{-20, 0, 0}, 30}, {{20, 0, 0}, 30}})};
    Settings settings = plan_view(Method::stencil, LineType::silhouette);
    const auto middle = [&] {
        return strengths(draw(objects, settings))[kSide / 2 * kSide + kSide / 2];
    };
    EXPECT_GT(middle(), 0.9F);
    objects[0].ids = IdLevel::object;
    EXPECT_EQ(middle(), 0.0F);
    settings.ids = IdLevel::primitive;
    EXPECT_EQ(middle(), 0.0F);
}

TEST(StencilMethod, DrawsOnlyTheTypesOfLinesThatItIsTold) {
    const Placement place{{40, 20, 10}, {-20, 40, 15}, {-5, -18, 40}, {}};
    const std::vector<Object> box{glyph({GlyphKind::box}, place)};
    const auto count = [&](LineType type) {
        int inked = 0;
        Settings settings = plan_view(Method::stencil, type);
        settings.thresholds.depth_share = 0.2F;  // no face is that steep
        const Film film = draw(box, settings);
        for (const float ink : strengths(film)) inked += ink > 0 ? 1 : 0;
        return inked;
    };
    EXPECT_GT(count(LineType::silhouette), 500);
    EXPECT_GT(count(LineType::crease), 300);
    EXPECT_EQ(count(LineType::self_occlusion), 0);
}

TEST(StencilMethod, TakesItsThresholdsFromTheSettings) {
    // A wedge of 40 degrees turns the normal by 40 degrees: a difference of 2 sin(20) = 0.684,
    // which a threshold of g * w with w = 4 lets through below g = 0.171.
    const double a = 20.0 * std::numbers::pi / 180.0;
    const auto drop = static_cast<float>(80.0 * std::tan(a));
    Object wedge = mesh_object({{-80, -80, -drop},
                                {0, -80, 0},
                                {80, -80, -drop},
                                {-80, 80, -drop},
                                {0, 80, 0},
                                {80, 80, -drop}},
                               {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}});
    Settings settings = plan_view(Method::stencil, LineType::crease);
    const auto inked = [&](double gradient) {
        settings.thresholds.crease_gradient = static_cast<float>(gradient);
        int count = 0;
        const Film film = draw({wedge}, settings);
        for (const float ink : strengths(film)) count += ink > 0 ? 1 : 0;
        return count;
    };
    EXPECT_GT(inked(0.170), 300);
    EXPECT_EQ(inked(0.172), 0);
}

}  // namespace
}  // namespace ink::test
