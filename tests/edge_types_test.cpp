#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "base/error.h"
#include "drawing.h"
#include "edges_view.h"
#include "lines/coverage.h"
#include "scenes.h"

namespace ink::test {
namespace {

// Types and styles

/// Pixels whose line on top is of that type: see LinePlanes.
std::size_t pixels_of(const Film& film, LineType type) {
    for (const Channel& channel : film.channels().channels) {
        if (channel.name != "line.type") continue;
        return static_cast<std::size_t>(std::ranges::count(
            std::get<Plane<std::uint32_t>>(channel.values), static_cast<std::uint32_t>(type) + 1));
    }
    throw std::logic_error("no line.type");
}

/// A quadrilateral of 40 x 30 pixels, a face of two triangles, and a second one beside it.
Object two_quads() {
    Object object = mesh_object(
        {{-40, -15, 0}, {0, -15, 0}, {40, -15, 0}, {-40, 15, 0}, {0, 15, 0}, {40, 15, 0}},
        {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}});
    auto& mesh = std::get<Mesh>(object.shape);
    mesh.faces = {0, 0, 1, 1};
    smooth_normals(mesh);
    return object;
}

TEST(MeshLines, RunBetweenFacesAndNotAlongDiagonals) {
    Settings settings = plan_view({128, 64}, 2.0);
    set(settings, "lines", "mesh");
    const Film film = draw(Scene({two_quads()}), settings);
    const auto& ink = plane(film, "line.A");
    for (int y = 20; y < 44; ++y) {
        for (int x = 26; x < 102; ++x) {
            const bool on_line = x == 63 || x == 64;  // the faces meet at x = 64
            EXPECT_NEAR(ink[at({128, 64}, x, y)], on_line ? 1.0 : 0.0, 1e-3) << x << ", " << y;
        }
    }
    EXPECT_EQ(pixels_of(film, LineType::silhouette), 0U);
}

TEST(MeshLines, TakeNoRays) {
    const Scene scene({two_quads()});
    const auto tracer = make_embree_tracer(scene);
    Settings settings = plan_view({128, 64}, 2.0);
    RenderStats without;
    RenderStats with;
    render(scene, *tracer, settings, {}, {}, &without);
    set(settings, "lines", "silhouette,intersection,self-occlusion,crease,boundary,mesh");
    render(scene, *tracer, settings, {}, {}, &with);
    EXPECT_EQ(with.rays, without.rays);
}

/// A torus of 40 x 20 quadrilaterals, of two triangles each, that shows its hollow.
Object coarse_torus() {
    constexpr std::uint32_t kRound = 40;
    constexpr std::uint32_t kTube = 20;
    std::vector<Vec3f> vertices;
    std::vector<Mesh::Triangle> triangles;
    std::vector<std::uint32_t> faces;
    for (std::uint32_t i = 0; i < kRound; ++i) {
        for (std::uint32_t j = 0; j < kTube; ++j) {
            const double u = 2.0 * std::numbers::pi * i / kRound;
            const double v = 2.0 * std::numbers::pi * j / kTube;
            const double from_axis = 60.0 + 25.0 * std::cos(v);
            const Vec3d flat{from_axis * std::cos(u), from_axis * std::sin(u), 25.0 * std::sin(v)};
            const double tilt = 50.0 * kDegrees;
            vertices.push_back(
                to_float(Vec3d{flat.x, flat.y * std::cos(tilt) - flat.z * std::sin(tilt),
                               flat.y * std::sin(tilt) + flat.z * std::cos(tilt)}));
            const auto at = [](std::uint32_t a, std::uint32_t b) {
                return a % kRound * kTube + b % kTube;
            };
            triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
            faces.insert(faces.end(), 2, i * kTube + j);
        }
    }
    Object object = mesh_object(std::move(vertices), std::move(triangles));
    auto& mesh = std::get<Mesh>(object.shape);
    mesh.faces = std::move(faces);
    smooth_normals(mesh);
    return object;
}

/// Drawn, they come from the nearest edge of what each pixel sees; as data, from crossings that are
/// joined. Both must ink the same pixels.
/// How much of each pixel the bands of segments cover, drawn one by one.
Plane<float> ink_of(const std::vector<Segment>& segments, Size size, double width_px) {
    Plane<float> ink(size.pixels(), 0.0F);
    const auto half = static_cast<float>(0.5 * width_px);
    for (const Segment& segment : segments) {
        const Vec2f along = segment.b - segment.a;
        const Vec2f middle = (segment.a + segment.b) * 0.5F;
        const float reach = half + 1.0F + 0.5F * length(along);
        for (int j = 0; j < size.height; ++j) {
            for (int i = 0; i < size.width; ++i) {
                const Vec2f p{static_cast<float>(i) + 0.5F, static_cast<float>(j) + 0.5F};
                if (std::abs(p.x - middle.x) > reach || std::abs(p.y - middle.y) > reach) continue;
                const float s =
                    std::clamp(dot(p - segment.a, along) / dot(along, along), 0.0F, 1.0F);
                const Vec2f off = p - (segment.a + along * s);
                const float far = length(off);
                const Vec2f normal = far > 1e-4F ? off * (1.0F / far) : Vec2f{1, 0};
                float& pixel = ink[static_cast<std::size_t>(j * size.width + i)];
                pixel = std::max(pixel, band_coverage(far, half, normal.x, normal.y));
            }
        }
    }
    return ink;
}

TEST(MeshLines, ChangeNoPixelWhenTheyAreKeptAsData) {
    const Scene scene({coarse_torus()});
    const auto tracer = make_tracer(scene);
    Settings settings = plan_view({192, 160}, 2.0);
    set(settings, "lines", "silhouette,self-occlusion,mesh");
    const Film alone = render(scene, *tracer, settings);
    Drawing drawing;
    const Film beside = render(scene, *tracer, settings, {}, {}, nullptr, &drawing);
    EXPECT_GT(drawing.segments.size(), 1000U);
    EXPECT_EQ(alone.display().pixels, beside.display().pixels);
    EXPECT_EQ(plane(alone, "line.A"), plane(beside, "line.A"));
    EXPECT_EQ(pixels_of(alone, LineType::mesh), pixels_of(beside, LineType::mesh));
}

TEST(MeshLines, LookTheSameFromEdgesAndFromCrossings) {
    const Scene scene({coarse_torus()});
    const auto tracer = make_tracer(scene);
    for (const double width : {1.0, 2.5}) {
        Settings settings = plan_view({192, 160}, width);
        set(settings, "lines", "silhouette,self-occlusion,mesh");
        set(settings, "line-density", "1");
        set(settings, "lattice", "4");
        Drawing drawing;
        render(scene, *tracer, settings, {}, {}, nullptr, &drawing);
        const Plane<float> expected = ink_of(drawing.segments, settings.size, width);
        for (const char* q : {"1", "2", "3"}) {
            SCOPED_TRACE("width " + std::to_string(width) + ", q = " + q);
            set(settings, "lattice", q);
            const Film edges = render(scene, *tracer, settings);
            const auto& ink = plane(edges, "line.A");
            EXPECT_LT(mean_difference(ink, expected), 0.005);
            // Beside a contour, a line between faces may end a pixel earlier or later.
            std::size_t far = 0;
            for (std::size_t k = 0; k < ink.size(); ++k) {
                far += std::abs(ink[k] - expected[k]) > 0.25F ? 1 : 0;
            }
            EXPECT_LT(far, ink.size() / 250);
            EXPECT_GT(pixels_of(edges, LineType::mesh), 3000U);
        }
    }
}

constexpr const char* kAllOutlines = "silhouette,intersection,self-occlusion,crease,boundary,mesh";

/// A square of 60 pixels in front of two triangles that fill the picture. The edge between these is
/// hidden: so far behind the square's right side, in pixels.
Scene square_before_edge(float behind) {
    const float x = 30.0F - behind;
    return Scene({mesh_object({{-30, -30, 1}, {30, -30, 1}, {30, 30, 1}, {-30, 30, 1}},
                              {{0, 1, 2}, {0, 2, 3}}),
                  mesh_object({{x, -500, 0}, {x, 500, 0}, {500, 0, 0}, {-500, 0, 0}},
                              {{0, 2, 1}, {0, 1, 3}})});
}

TEST(MeshLines, ThatAreHiddenInkNothingBesideTheOutline) {
    const Size size{128, 96};
    Settings settings = plan_view(size, 4.0);
    settings.aovs.clear();
    set(settings, "lines", kAllOutlines);
    set(settings, "line-density", "1");
    const Film far = draw(square_before_edge(20.0F), settings);
    for (const float behind : {0.0F, 0.25F, 1.0F, 1.75F}) {
        SCOPED_TRACE(behind);
        const Film near = draw(square_before_edge(behind), settings);
        for (int y = 24; y < 72; ++y) {
            for (int x = 80; x < size.width; ++x) {
                const std::size_t k = at(size, x, y);
                EXPECT_EQ(near.display().pixels[k], far.display().pixels[k]) << x << ", " << y;
            }
        }
    }
}

TEST(MeshLines, RunUnderOutlinesAsIfTheyEndedThere) {
    const Scene scene({coarse_torus()});
    const auto tracer = make_tracer(scene);
    for (const char* width : {"1", "2.5"}) {
        Settings settings = plan_view({192, 160});
        set(settings, "line-width", width);
        set(settings, "lines", kAllOutlines);
        // Planes of lines want to know which line is nearest, so that those between faces end.
        const Film ended = render(scene, *tracer, settings);
        settings.aovs.clear();
        const Film covered = render(scene, *tracer, settings);
        const auto& a = ended.display().pixels;
        const auto& b = covered.display().pixels;
        double sum = 0.0;
        std::size_t far = 0;
        for (std::size_t k = 0; k < a.size(); ++k) {
            const int off =
                std::abs(static_cast<int>(a[k] & 0xFFU) - static_cast<int>(b[k] & 0xFFU));
            sum += off;
            far += off > 64 ? 1 : 0;
        }
        EXPECT_LT(sum / static_cast<double>(a.size()), 0.5);
        EXPECT_LT(far, a.size() / 250);
    }
}

TEST(MeshLines, FinerThanPixelsAreATone) {
    std::vector<Vec3f> vertices;
    std::vector<Mesh::Triangle> triangles;
    constexpr std::uint32_t kSide = 300;
    for (std::uint32_t j = 0; j <= kSide; ++j) {
        for (std::uint32_t i = 0; i <= kSide; ++i) {
            vertices.push_back(
                {static_cast<float>(i) * 0.4F - 60.0F, static_cast<float>(j) * 0.4F - 60.0F, 0.0F});
        }
    }
    for (std::uint32_t j = 0; j < kSide; ++j) {
        for (std::uint32_t i = 0; i < kSide; ++i) {
            const std::uint32_t k = j * (kSide + 1) + i;
            triangles.push_back({k, k + 1, k + kSide + 2});
            triangles.push_back({k, k + kSide + 2, k + kSide + 1});
        }
    }
    Settings settings = plan_view({100, 100}, 2.0);
    set(settings, "lines", "mesh");
    const double tone =
        mean(plane(draw(Scene({mesh_object(vertices, triangles)}), settings), "line.A"));
    EXPECT_LT(tone, 0.75);
    EXPECT_GT(tone, 0.2);
}

TEST(OpenCylinder, HasABoundaryAtItsRimsAndSilhouettesAtItsSides) {
    std::vector<Vec3f> vertices;
    std::vector<Mesh::Triangle> triangles;
    constexpr std::uint32_t kSides = 96;
    for (std::uint32_t k = 0; k < kSides; ++k) {
        const auto angle = static_cast<float>(k * 2 * std::numbers::pi / kSides);
        for (const float y : {-30.0F, 30.0F}) {
            vertices.push_back({25 * std::cos(angle), y, 25 * std::sin(angle)});
        }
        const std::uint32_t n = (k + 1) % kSides;
        triangles.push_back({2 * k, 2 * k + 1, 2 * n + 1});
        triangles.push_back({2 * k, 2 * n + 1, 2 * n});
    }
    Object object = mesh_object(vertices, triangles);
    smooth_normals(std::get<Mesh>(object.shape));
    Settings settings = plan_view({96, 96}, 2.0);
    settings.view.eye = Vec3d{0, 60, 100};  // sees the upper rim whole, and into the cylinder
    std::map<std::string, double> length;
    for (const char* type :
         {"boundary", "silhouette", "self-occlusion", "crease", "intersection"}) {
        set(settings, "lines", type);
        length[type] = mean(plane(draw(Scene({object}), settings), "line.A")) * 96 * 96 / 2.0;
    }
    // The upper rim is an ellipse of half axes 25 and 25 sin(elevation), of the lower one half is
    // seen; the sides are as long as the cylinder is high, times the cosine.
    const double elevation = std::atan2(60.0, 100.0);
    const double a = 25.0;
    const double b = 25.0 * std::sin(elevation);
    const double ellipse = std::numbers::pi * (3 * (a + b) - std::sqrt((3 * a + b) * (a + 3 * b)));
    EXPECT_NEAR(length["boundary"], 1.5 * ellipse, 0.06 * ellipse);
    EXPECT_NEAR(length["silhouette"], 2 * 60 * std::cos(elevation), 8.0);
    EXPECT_LT(length["self-occlusion"] + length["crease"] + length["intersection"], 6.0);
}

TEST(LineStyles, OfTypesAndObjectsAreDrawnAsTheySay) {
    // Two discs side by side, seen face on.
    const Scene scene({sphere_object({{{-32, 0, 0}, 20}}), sphere_object({{{32, 0, 0}, 20}})});
    Settings settings = plan_view({128, 64}, 2.0);
    set(settings, "line", "silhouette:width=4px");
    set(settings, "line", "all@2:color=#ff0000,opacity=0.5");
    const Film film = draw(scene, settings);
    const auto ink_of = [&](int x0) {
        double sum = 0.0;
        for (int y = 0; y < 64; ++y) {
            for (int x = x0; x < x0 + 64; ++x) {
                sum += static_cast<double>(plane(film, "line.A")[at({128, 64}, x, y)]);
            }
        }
        return sum;
    };
    const double circle = 2 * std::numbers::pi * 20;
    EXPECT_NEAR(ink_of(0), circle * 4, circle * 0.1);
    EXPECT_NEAR(ink_of(64), circle * 4 * 0.5, circle * 0.1);
    // In the middle of the second one's outline: half red on half shaded.
    const std::uint32_t right = film.display().pixels[at({128, 64}, 115, 32)];
    const std::uint32_t left = film.display().pixels[at({128, 64}, 12, 32)];
    EXPECT_GT(right & 0xFFU, (right >> 8U & 0xFFU) + 100);
    EXPECT_LT(left & 0xFFU, 10U);
}

TEST(LineStyles, OfAnObjectThatDoesNotExistAreRefused) {
    Settings settings = plan_view({32, 32});
    set(settings, "line", "all@3:width=1px");
    EXPECT_THROW(draw(Scene({sphere_object({{{0, 0, 0}, 9}})}), settings), UsageError);
}

TEST(LinePlanes, SayWhatLineAPixelShows) {
    const Scene scene({sphere_object({{{0, 0, 0}, 20}})});
    const Film film = draw(scene, plan_view({64, 64}, 4.0));
    const auto& distance = plane(film, "line.distance");
    for (int x = 0; x < 64; ++x) {
        const double expected = std::abs(std::hypot(x + 0.5 - 32, 0.5) - 20);
        const float found = distance[at({64, 64}, x, 32)];
        if (expected < 2.6) {
            EXPECT_NEAR(found, expected, 0.02) << x;
        } else if (expected > 2.8) {
            EXPECT_TRUE(std::isinf(found)) << x;
        }
    }
    const std::size_t inked = pixels_of(film, LineType::silhouette);
    EXPECT_EQ(inked, static_cast<std::size_t>(std::ranges::count_if(
                         distance, [](float d) { return std::isfinite(d); })));
    for (const Channel& channel : film.channels().channels) {
        if (!channel.name.starts_with("line.id")) continue;
        const auto& ids = std::get<Plane<std::uint32_t>>(channel.values);
        const std::uint32_t wanted = channel.name == "line.id.near" ? 1 : 0;
        EXPECT_EQ(ids[at({64, 64}, 12, 32)], wanted) << channel.name;
    }
}

/// A rectangle in the plane z = 0.3 x + 0.2 y, over x from x0 to x1 and y from -20 to 20.
Object slanted_rectangle(float x0, float x1) {
    const auto corner = [](float x, float y) { return Vec3f{x, y, 0.3F * x + 0.2F * y}; };
    return mesh_object({corner(x0, -20), corner(x1, -20), corner(x1, 20), corner(x0, 20)},
                       {{0, 1, 2}, {0, 2, 3}});
}

TEST(CoincidentSurfaces, OfTwoObjectsShowOneLineWhereTheyPart) {
    for (const double distance : {70.0, 100.0, 317.0}) {
        Settings settings = plan_view({128, 64}, 2.0);
        settings.view.orthographic.reset();
        settings.view.eye = Vec3d{11, 23, distance};
        set(settings, "lines", "intersection");
        const Film film =
            draw(Scene({slanted_rectangle(-40, 10), slanted_rectangle(-10.3F, 40)}), settings);
        double rows = 0.0;
        for (int y = 0; y < 64; ++y) {
            double ink = 0.0;
            int inked = 0;
            for (int x = 0; x < 128; ++x) {
                ink += static_cast<double>(plane(film, "line.A")[at({128, 64}, x, y)]);
                inked += plane(film, "line.A")[at({128, 64}, x, y)] > 0.0F ? 1 : 0;
            }
            // One line crosses each row, or none does.
            EXPECT_LT(ink, 2.7) << "row " << y << " from " << distance;
            EXPECT_LE(inked, 5) << "row " << y << " from " << distance;
            rows += ink > 1.0 ? 1 : 0;
        }
        EXPECT_GT(rows, 5) << distance;
    }
}

/// On screen, from the middle of a torus whose axis leans by `tilt` from the direction of sight:
/// the point where the near rim of its hollow stops hiding the far side. There the contour's
/// direction of sight is asymptotic: n.v = 0 and II(v, v) = 0 (Koenderink 1984). Found by
/// bisection.
Vec2f torus_cusp(double ring, double tube, double tilt) {
    const double along = std::cos(tilt);  // of the direction of sight, on the axis
    const double aside = std::sin(tilt);  // and at a right angle to it
    const auto turn_at = [&](double v) { return std::acos(-std::tan(v) * along / aside); };
    const auto curvature = [&](double v) {
        const double u = turn_at(v);
        const double round = -std::sin(u) * aside;
        const double through = -std::sin(v) * std::cos(u) * aside + std::cos(v) * along;
        return round * round * std::cos(v) / (ring + tube * std::cos(v)) + through * through / tube;
    };
    // From the rim's end farthest to the side, where u = 90 degrees, to the nearest, u = 0.
    double low = std::numbers::pi - 1e-9;
    double high = std::numbers::pi - std::atan(aside / along) + 1e-9;
    EXPECT_LT(curvature(low), 0.0);
    EXPECT_GT(curvature(high), 0.0);
    for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (low + high);
        (curvature(middle) < 0.0 ? low : high) = middle;
    }
    const double u = turn_at(low);
    const double spoke = ring + tube * std::cos(low);
    return {static_cast<float>(spoke * std::sin(u)),
            static_cast<float>(spoke * std::cos(u) * along - tube * std::sin(low) * aside)};
}

Object torus_object(double ring, double tube, double tilt) {
    Object object;
    object.name = "torus";
    object.kind = ObjectKind::shape;
    Glyphs torus;
    torus.shape = {GlyphKind::torus, tube / ring};
    torus.placements = {placement_about({}, {0, std::sin(tilt), std::cos(tilt)}, ring)};
    object.shape = std::move(torus);
    return object;
}

TEST(HollowOfATorus, IsHiddenUpToTheCuspOfItsRim) {
    const Size size{96, 96};
    for (const double ring : {40.0, 200.0, 1000.0}) {
        for (const double tilt_deg : {55.0, 67.0, 75.0}) {
            const double tilt = tilt_deg * kDegrees;
            const Vec2f cusp = torus_cusp(ring, 0.5 * ring, tilt);
            const Scene scene({torus_object(ring, 0.5 * ring, tilt)});
            // The cusp is in the middle of the picture.
            Settings settings = plan_view(size);
            // Thin lines: a fold shorter than two and a half widths would be left out as a hair.
            set(settings, "line-width", "1px");
            settings.view.eye = Vec3d{cusp.x, -cusp.y, 10 * ring};
            settings.view.look_at = Vec3d{cusp.x, -cusp.y, 0};
            Drawing drawing;
            render(scene, *make_tracer(scene), settings, {}, {}, nullptr, &drawing);
            double nearest = 1e30;
            double farthest_out = -1e30;
            for (const Segment& segment : drawing.segments) {
                if (segment.type != LineType::self_occlusion) continue;
                for (const Vec2f p : {segment.a, segment.b}) {
                    nearest = std::min(nearest, std::hypot(p.x - 48.0, p.y - 48.0));
                    farthest_out = std::max(farthest_out, p.x - 48.0);
                }
            }
            EXPECT_LT(nearest, 1.0) << "ring " << ring << ", tilt " << tilt_deg;
            EXPECT_LT(farthest_out, 1.0) << "ring " << ring << ", tilt " << tilt_deg;
        }
    }
}

/// A cube of side 2 as one glyph.
Object box_glyph() {
    Object object;
    object.name = "box";
    object.kind = ObjectKind::shape;
    Glyphs glyphs;
    glyphs.shape.kind = GlyphKind::box;
    glyphs.placements.push_back({});
    object.shape = std::move(glyphs);
    return object;
}

TEST(BoxGlyph, ShowsTheThreeEdgesThatItsMeshShows) {
    Settings settings;
    settings.size = {128, 128};
    settings.view.view = View::iso;
    settings.aovs = {Aov::lines};
    set(settings, "lines", "crease");
    EXPECT_GT(mean(plane(draw(Scene({box_glyph()}), settings), "line.A")), 0.02);
}

}  // namespace
}  // namespace ink::test
