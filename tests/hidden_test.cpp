// Lines on surfaces behind others.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "base/error.h"
#include "lines/dashes.h"
#include "render/render.h"
#include "scenes.h"
#include "set_ray.h"
#include "test_files.h"
#include "vector/line_art.h"
#include "vector/svg_writer.h"

namespace ink::test {
namespace {

/// Looking at the origin along `eye`, ten pixels a unit.
Settings seen_from(Vec3d eye, int side = 100) {
    Settings settings;
    settings.size = {side, side};
    settings.threads = 2;
    settings.view.eye = eye;
    settings.view.look_at = Vec3d{0, 0, 0};
    settings.view.up = Vec3d{0, 1, 0};
    settings.view.orthographic = 0.1 * side;
    settings.hidden.kind = HiddenLines::Kind::solid;
    return settings;
}

Vec2d on_screen(Vec3d p, const Settings& settings) {
    const Vec3d back = normalize(*settings.view.eye);
    const Vec3d right = normalize(cross(Vec3d{0, 1, 0}, back));
    const Vec3d up = cross(back, right);
    const double middle = 0.5 * settings.size.width;
    return {middle + 10.0 * dot(p, right), middle - 10.0 * dot(p, up)};
}

std::vector<Segment> hidden_lines(const Scene& scene, const Settings& settings) {
    const auto tracer = make_tracer(scene);
    Drawing drawing;
    render(scene, *tracer, settings, {.display = true, .lines = false}, {}, nullptr, &drawing);
    return drawing.hidden;
}

double total_length(const std::vector<Segment>& lines) {
    double sum = 0.0;
    for (const Segment& line : lines) sum += static_cast<double>(length(line.b - line.a));
    return sum;
}

double distance(Vec2d p, Vec2d a, Vec2d b) {
    const Vec2d d = b - a;
    const double s = std::clamp(dot(p - a, d) / dot(d, d), 0.0, 1.0);
    return length(p - (a + d * s));
}

Object box(double half) {
    const auto h = static_cast<float>(half);
    Object object;
    object.name = "box";
    Glyphs glyphs;
    glyphs.shape.kind = GlyphKind::box;
    glyphs.placements.push_back({{h, 0, 0}, {0, h, 0}, {0, 0, h}, {0, 0, 0}});
    object.shape = glyphs;
    return object;
}

TEST(HiddenLines, OfABoxAreTheThreeEdgesAtItsFarCorner) {
    const Settings settings = seen_from({5, 7, 9});
    const std::vector<Segment> lines = hidden_lines(Scene({box(2.5)}), settings);
    const Vec2d corner = on_screen({-2.5, -2.5, -2.5}, settings);
    const std::array ends{on_screen({2.5, -2.5, -2.5}, settings),
                          on_screen({-2.5, 2.5, -2.5}, settings),
                          on_screen({-2.5, -2.5, 2.5}, settings)};
    double expected = 0.0;
    for (const Vec2d end : ends) expected += length(end - corner);
    EXPECT_NEAR(total_length(lines), expected, 3.0);
    for (const Segment& line : lines) {
        EXPECT_EQ(line.type, LineType::crease);
        EXPECT_TRUE(line.hidden);
        for (const Vec2f point : {line.a, line.b}) {
            double nearest = 1e9;
            for (const Vec2d end : ends) {
                nearest = std::min(nearest, distance(to_double(point), corner, end));
            }
            // Where lines meet, a junction is known to its cell.
            const auto is_near = [&](Vec2d place) {
                return length(to_double(point) - place) < 1.5;
            };
            const bool at_corner = is_near(corner) || std::ranges::any_of(ends, is_near);
            EXPECT_LT(nearest, at_corner ? 0.7 : 0.02);
        }
    }
}

TEST(HiddenLines, OfTwoSpheresAreTheFarHalfOfTheirSeam) {
    const Settings settings = seen_from({6, 3, 8});
    const Scene scene({sphere_object({{{-1, 0, 0}, 2.0F}, {{1, 0, 0}, 2.0F}})});
    const double radius = std::sqrt(3.0);  // of the seam, in the plane x = 0
    const Vec3d towards_eye = normalize(*settings.view.eye);
    const auto seam = [&](double angle) {
        return Vec3d{0.0, radius * std::cos(angle), radius * std::sin(angle)};
    };
    // A point of the seam is hidden where one of the spheres is turned away.
    double expected = 0.0;
    constexpr int kSteps = 3600;
    std::vector<Vec2d> hidden;
    for (int k = 0; k < kSteps; ++k) {
        const Vec3d p = seam(2.0 * std::numbers::pi * k / kSteps);
        const Vec3d q = seam(2.0 * std::numbers::pi * (k + 1) / kSteps);
        const bool seen = dot(p - Vec3d{-1, 0, 0}, towards_eye) > 0.0 &&
                          dot(p - Vec3d{1, 0, 0}, towards_eye) > 0.0;
        // Next to an outline in front there is no room for a line behind it.
        const bool under_outline = std::ranges::any_of(std::array{-1.0, 1.0}, [&](double x) {
            const Vec2d centre = on_screen({x, 0, 0}, settings);
            return std::abs(length(on_screen(p, settings) - centre) - 20.0) < 0.08;
        });
        if (seen) continue;
        hidden.push_back(on_screen(p, settings));
        if (under_outline) continue;
        expected += length(on_screen(q, settings) - on_screen(p, settings));
    }
    const std::vector<Segment> lines = hidden_lines(scene, settings);
    double seam_length = 0.0;
    for (const Segment& line : lines) {
        const Vec2d middle = to_double((line.a + line.b) * 0.5F);
        double nearest = 1e9;
        for (const Vec2d point : hidden) nearest = std::min(nearest, length(point - middle));
        // Where one sphere faces the eye and the other does not, the seam bounds a notch. Else it
        // is where their far sides meet.
        EXPECT_TRUE(line.type != LineType::intersection || nearest < 0.1);
        if (nearest < 0.1) seam_length += static_cast<double>(length(line.b - line.a));
    }
    EXPECT_NEAR(seam_length, expected, 0.05 * expected);
}

TEST(HiddenLines, ShowTheOutlineOfASphereBehindAnother) {
    const Settings settings = seen_from({0, 0, 9});
    const Scene scene({sphere_object({{{0, 0, 2}, 3.0F}, {{0.5F, 0, -3}, 1.0F}})});
    const std::vector<Segment> lines = hidden_lines(scene, settings);
    EXPECT_NEAR(total_length(lines), 2.0 * std::numbers::pi * 10.0, 0.2);
    for (const Segment& line : lines) {
        EXPECT_EQ(line.type, LineType::silhouette);
        EXPECT_NEAR(length(to_double(line.a) - Vec2d{55, 50}), 10.0, 0.02);
    }
}

TEST(HiddenLines, LeaveOutWhatLiesWithinASolid) {
    const Settings settings = seen_from({0, 0, 9});
    const Scene inner({sphere_object({{{0, 0, 0}, 3.0F}, {{0.5F, 0, 0}, 1.0F}})});
    EXPECT_TRUE(hidden_lines(inner, settings).empty());
    // Stacked boxes whose faces coincide are one body.
    Object stack = box(1.0);
    auto& glyphs = std::get<Glyphs>(stack.shape);
    glyphs.placements.push_back(glyphs.placements[0]);
    glyphs.placements[1].origin = {0, 0, -2};
    Settings square = seen_from({0, 0, 9});
    square.ids = IdLevel::object;
    EXPECT_TRUE(hidden_lines(Scene({stack}), square).empty());
}

TEST(HiddenLines, AreNotLookedForBeyondTheLayersAskedFor) {
    Settings settings = seen_from({0, 0, 9});
    // The front one's far side, and both sides of the second one, are three layers.
    const Scene scene({sphere_object({{{0, 0, 6}, 3.0F}, {{0, 0, 0}, 2.0F}, {{0, 0, -5}, 1.0F}})});
    settings.hidden_layers = 3;
    const double two = total_length(hidden_lines(scene, settings));
    settings.hidden_layers = 4;
    const double three = total_length(hidden_lines(scene, settings));
    EXPECT_NEAR(two, 2.0 * std::numbers::pi * 20.0, 0.3);
    EXPECT_NEAR(three, 2.0 * std::numbers::pi * 30.0, 0.5);
}

TEST(HiddenLines, DoNotChangeTheLinesInFront) {
    Settings settings = seen_from({5, 7, 9}, 64);
    settings.hidden.kind = HiddenLines::Kind::none;
    const Scene scene({box(2.0)});
    const auto tracer = make_tracer(scene);
    Drawing without;
    Drawing with;
    render(scene, *tracer, settings, {}, {}, nullptr, &without);
    settings.hidden.kind = HiddenLines::Kind::dashed;
    render(scene, *tracer, settings, {}, {}, nullptr, &with);
    EXPECT_EQ(with.segments.size(), without.segments.size());
    EXPECT_TRUE(without.hidden.empty());
    EXPECT_FALSE(with.hidden.empty());
}

TEST(HiddenLines, AreTheSamePixelsForAnyThreadsAndTiles) {
    const Scene scene(random_objects(5, 12, 12));
    const auto tracer = make_tracer(scene);
    Settings settings;
    settings.size = {90, 70};
    settings.hidden.kind = HiddenLines::Kind::dashed;
    Pixels expected;
    for (const int variant : {0, 1, 2}) {
        settings.threads = variant == 1 ? 4 : 1;
        settings.tile = variant == 2 ? 20 : 64;
        const Film film = render(scene, *tracer, settings);
        if (variant == 0) expected = film.display().pixels;
        EXPECT_EQ(film.display().pixels, expected);
    }
}

TEST(HiddenLines, AreALayerOfDashedPathsInAnSvg) {
    Settings settings = seen_from({5, 7, 9});
    settings.hidden.kind = HiddenLines::Kind::dashed;
    settings.line_rules = read_line_rules("hidden:width=1px,color=red");
    const Scene scene({box(2.5)});
    const auto tracer = make_tracer(scene);
    Drawing drawing;
    const Film film = render(scene, *tracer, settings, {}, {}, nullptr, &drawing);
    const LineArt art = make_line_art(scene, settings, drawing, film.display());
    const auto hidden = [](const Chain& chain) { return chain.hidden; };
    EXPECT_EQ(std::ranges::count_if(art.chains, hidden), 3);
    const TemporaryFolder folder;
    write_svg(folder.path() / "x.svg", art);
    const std::string text = read_bytes(folder.path() / "x.svg");
    EXPECT_NE(text.find("<g id=\"hidden\" class=\"hidden\""), std::string::npos);
    EXPECT_NE(text.find("stroke=\"#ff0000\" stroke-width=\"1\""), std::string::npos);
    EXPECT_NE(text.find("stroke-dasharray="), std::string::npos);
    EXPECT_LT(text.find("id=\"hidden\""), text.find("id=\"silhouette\""));
}

TEST(PeeledTracer, CountsSurfacesOfAnySceneAsTheOracleDoes) {
    const Scene scene(random_objects(3, 10, 12));
    const auto embree = make_embree_tracer(scene);
    const auto oracle = make_brute_force_tracer(scene);
    std::mt19937 random(4);
    SurfaceHits hits;
    SurfaceHits expected;
    int crossed = 0;
    for (int k = 0; k < 100; ++k) {
        RayPacket rays;
        for (int i = 0; i < kLanes; ++i) {
            const Vec3f target = uniform_point(random) - Vec3f{0.5F, 0.5F, 0.5F};
            const Vec3f dir = normalize(target - Vec3f{0, 0, 3});
            set_ray(rays, i, {0, 0, 3}, dir);
        }
        embree->cross(rays, hits);
        oracle->cross(rays, expected);
        for (std::size_t i = 0; i < kLanes; ++i) {
            std::ranges::sort(hits[i], {}, &SurfaceHit::t);
            ASSERT_EQ(hits[i].size(), expected[i].size());
            for (std::size_t n = 0; n < hits[i].size(); ++n) {
                EXPECT_NEAR(hits[i][n].t, expected[i][n].t, 2e-4F);
                ++crossed;
            }
        }
    }
    EXPECT_GT(crossed, 1000);
}

TEST(Dashes, BeginAndEndALineWithAStroke) {
    const Dashes usual{10.0, 4.0};
    for (const double size : {30.0, 55.5, 200.0}) {
        const Dashes dashes = fit_dashes(usual, size, false);
        const double periods = (size + dashes.gap) / (dashes.stroke + dashes.gap);
        EXPECT_NEAR(periods, std::round(periods), 1e-9);
        EXPECT_NEAR(dashes.stroke / dashes.gap, 2.5, 1e-9);
        const Dashes ring = fit_dashes(usual, size, true);
        const double turns = size / (ring.stroke + ring.gap);
        EXPECT_NEAR(turns, std::round(turns), 1e-9);
    }
    EXPECT_EQ(fit_dashes(usual, 12.0, false).stroke, 12.0);
}

TEST(Dashes, AreCutByTheLengthAlongTheLine) {
    Chain chain;
    for (int k = 0; k <= 20; ++k) {  // round a corner
        chain.points.push_back(k <= 10 ? Vec2f{static_cast<float>(k), 0.0F}
                                       : Vec2f{10.0F, static_cast<float>(k - 10)});
        chain.t.push_back(1.0F);
    }
    const Dashes dashes{4.0, 4.0};
    std::vector<Segment> strokes;
    cut_into_strokes(chain, &dashes, strokes);
    EXPECT_NEAR(total_length(strokes), 12.0, 1e-4);
    for (const Segment& stroke : strokes) {
        const Vec2f middle = (stroke.a + stroke.b) * 0.5F;
        EXPECT_LT(std::fmod(middle.x + middle.y, 8.0F), 4.0F);
    }
    strokes.clear();
    cut_into_strokes(chain, nullptr, strokes);
    EXPECT_NEAR(total_length(strokes), 20.0, 1e-4);
}

TEST(HiddenLines, NeedMethodEdges) {
    Settings settings = seen_from({0, 0, 9});
    EXPECT_NO_THROW(validate(settings));
    settings.method = Method::stencil;
    EXPECT_THROW(validate(settings), UsageError);
}

}  // namespace
}  // namespace ink::test
