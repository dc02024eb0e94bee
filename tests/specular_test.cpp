// Lines in mirrors, through glass and behind transparent surfaces, against the same things seen
// directly and against a reference that traces in double precision.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <tuple>
#include <vector>

#include "base/error.h"
#include "drawing.h"
#include "render/render.h"
#include "sampling/optics.h"
#include "scenes.h"

namespace ink::test {
namespace {

constexpr int kSide = 192;

struct Result {
    Film film;
    Drawing drawing;
};

Result render_lines(const std::vector<Object>& objects, const Settings& settings) {
    const Scene scene(objects);
    const auto tracer = make_tracer(scene);
    Drawing drawing;
    Film film = render(scene, *tracer, settings, {}, {}, nullptr, &drawing);
    return {std::move(film), std::move(drawing)};
}

/// Orthographic from +z, one unit a pixel, the origin in the middle.
Settings plan_view() {
    Settings settings;
    settings.size = {kSide, kSide};
    settings.view.eye = Vec3d{0, 0, 1000};
    settings.view.look_at = Vec3d{0, 0, 0};
    settings.view.orthographic = kSide;
    settings.line_width = {3.0, Length::Unit::px};
    settings.aovs = {Aov::lines};
    settings.threads = 1;
    return settings;
}

Vec3d plan_point(Vec2f p) { return {p.x - 0.5 * kSide, 0.5 * kSide - p.y, 0.0}; }

Object ball(Vec3f centre, float radius, const Material& material = {}) {
    Object object = sphere_object({{centre, radius}});
    object.material = material;
    return object;
}

Material mirror_of(float share) {
    Material material;
    material.mirror = share;
    return material;
}

Material glass() {
    Material material;
    material.transparency = 1.0F;
    material.ior = 1.5F;
    return material;
}

Material film_of(float transparency) {
    Material material;
    material.transparency = transparency;
    return material;
}

std::vector<Segment> at_level(const Drawing& drawing, int level) {
    std::vector<Segment> segments;
    std::ranges::copy_if(drawing.segments, std::back_inserter(segments),
                         [&](const Segment& segment) { return segment.level == level; });
    return segments;
}

double length_of(const Segment& segment) {
    return std::hypot(segment.b.x - segment.a.x, segment.b.y - segment.a.y);
}

double total_length(const std::vector<Segment>& segments) {
    double sum = 0.0;
    for (const Segment& segment : segments) sum += length_of(segment);
    return sum;
}

double distance_to(const Segment& segment, Vec2f p) {
    const Vec2f d = segment.b - segment.a;
    const float squared = dot(d, d);
    const float s = squared > 0.0F ? std::clamp(dot(p - segment.a, d) / squared, 0.0F, 1.0F) : 0.0F;
    const Vec2f off = p - segment.a - d * s;
    return std::hypot(off.x, off.y);
}

double nearest(const std::vector<Segment>& segments, Vec2f p) {
    double least = std::numeric_limits<double>::infinity();
    for (const Segment& segment : segments) least = std::min(least, distance_to(segment, p));
    return least;
}

Vec2f middle(const Segment& segment) { return (segment.a + segment.b) * 0.5F; }

double total_ink(const Film& film) {
    double sum = 0.0;
    for (const float ink : plane(film, "line.A")) sum += ink;
    return sum;
}

// A flat mirror

/// Two balls that meet, and a box, above the plane y = 0 (`side` 1) or mirrored below it (-1).
std::vector<Object> things(double side) {
    const auto s = static_cast<float>(side);
    Object box;
    box.name = "box";
    box.kind = ObjectKind::shape;
    box.shape = Glyphs{{GlyphKind::box},
                       {{{0.5F, 0.1F * s, 0.2F},
                         {-0.1F, 0.4F * s, 0.0F},
                         {-0.2F, 0, 0.5F},
                         {1.6F, 1.5F * s, 0.3F}}},
                       {},
                       {}};
    return {sphere_object({{{-1.4F, 1.6F * s, 0}, 0.8F}, {{-0.5F, 1.3F * s, 0.3F}, 0.6F}}), box};
}

Settings floor_view() {
    Settings settings;
    settings.size = {kSide, kSide};
    settings.view.eye = Vec3d{0.3, 3.0, 14};
    settings.view.look_at = Vec3d{0, 0, 0};
    settings.view.fov_deg = 26;
    settings.line_width = {3.0, Length::Unit::px};
    settings.aovs = {Aov::lines};
    settings.threads = 1;
    return settings;
}

Object mirror_floor() {
    constexpr float kHalf = 60.0F;
    Object object = mesh_object(
        {{-kHalf, 0, kHalf}, {kHalf, 0, kHalf}, {kHalf, 0, -kHalf}, {-kHalf, 0, -kHalf}},
        {{0, 1, 2}, {0, 2, 3}});
    object.material = mirror_of(0.8F);
    return object;
}

TEST(FlatMirror, ShowsLinesWhereTheMirroredThingsHaveThem) {
    std::vector<Object> mirrored = things(1);
    mirrored.push_back(mirror_floor());
    Settings settings = floor_view();
    settings.line_rules = read_line_rules("all/0:opacity=0");
    const Result in_mirror = render_lines(mirrored, settings);
    const Result direct = render_lines(things(-1), floor_view());

    const std::vector<Segment> seen = at_level(in_mirror.drawing, 1);
    const std::vector<Segment>& expected = direct.drawing.segments;
    ASSERT_GT(total_length(expected), 200.0);
    EXPECT_NEAR(total_length(seen), total_length(expected), 0.005 * total_length(expected));
    for (const Segment& segment : seen) {
        EXPECT_LT(nearest(expected, middle(segment)), 0.05) << middle(segment).x;
    }
    for (const Segment& segment : expected) {
        EXPECT_LT(nearest(seen, middle(segment)), 0.05) << middle(segment).x;
    }
    // The width, by the ink that the lines take.
    EXPECT_NEAR(total_ink(in_mirror.film), total_ink(direct.film), 0.02 * total_ink(direct.film));
}

TEST(FlatMirror, ShowsLinesOfTheSameTypes) {
    std::vector<Object> mirrored = things(1);
    mirrored.push_back(mirror_floor());
    const Result in_mirror = render_lines(mirrored, floor_view());
    const Result direct = render_lines(things(-1), floor_view());
    const auto by_type = [](const std::vector<Segment>& segments) {
        std::array<double, kLineTypes> lengths{};
        for (const Segment& segment : segments) {
            lengths[static_cast<std::size_t>(segment.type)] += length_of(segment);
        }
        return lengths;
    };
    const auto seen = by_type(at_level(in_mirror.drawing, 1));
    const auto expected = by_type(direct.drawing.segments);
    for (std::size_t type = 0; type < seen.size(); ++type) {
        EXPECT_NEAR(seen[type], expected[type], 2.0) << type;
    }
    EXPECT_GT(expected[static_cast<std::size_t>(LineType::intersection)], 5.0);
    EXPECT_GT(expected[static_cast<std::size_t>(LineType::crease)], 50.0);
}

// Curved mirrors and glass

struct Hit {
    double t = std::numeric_limits<double>::infinity();
    int ball = -1;
};

struct Ray {
    Vec3d origin, dir;
};

/// The reference's scene: balls, of which the first is not asked for.
struct Balls {
    std::vector<std::pair<Vec3d, double>> balls;

    Hit first(const Ray& ray, int but) const {
        Hit hit;
        for (std::size_t k = 0; k < balls.size(); ++k) {
            if (static_cast<int>(k) == but) continue;
            const Vec3d from = ray.origin - balls[k].first;
            const double b = dot(from, ray.dir);
            const double d = b * b - dot(from, from) + balls[k].second * balls[k].second;
            const double t = d < 0.0 ? -1.0 : -b - std::sqrt(d);
            if (t > 0.0 && t < hit.t) hit = {t, static_cast<int>(k)};
        }
        return hit;
    }
};

Vec3d refract(Vec3d dir, Vec3d normal, double eta) {
    const double cosine = -dot(dir, normal);
    const double squared = 1.0 - eta * eta * (1.0 - cosine * cosine);
    return normalize(dir * eta + normal * (eta * cosine - std::sqrt(squared)));
}

/// What is seen at a screen point by way of something specular; nothing beside it.
using Reference = std::function<std::optional<int>(Vec2f)>;

/// Whether lines of a level are where the reference changes, and nowhere else.
void expect_lines(const Result& result, int level, const Reference& see, double least_length) {
    const std::vector<Segment> lines = at_level(result.drawing, level);
    EXPECT_GT(total_length(lines), least_length);
    // Where a segment crosses the lattice, the reference changes within 0.05 pixels. (Between, it
    // is straight where the line may be curved.)
    double wrong = 0.0;
    for (const Segment& segment : lines) {
        const Vec2f d = segment.b - segment.a;
        const auto size = static_cast<float>(length_of(segment));
        if (size < 0.05F) continue;
        const Vec2f across{-0.05F * d.y / size, 0.05F * d.x / size};
        const auto left = see(segment.a + across);
        const auto right = see(segment.a - across);
        if (left && right && *left == *right) wrong += static_cast<double>(size);
    }
    EXPECT_LT(wrong, 0.02 * total_length(lines));
    // On fine scan lines, every change of the reference has its segment.
    int changes = 0;
    int missed = 0;
    constexpr float kStep = 0.04F;
    for (float y = 0.3F; y < kSide; y += 3.7F) {
        std::optional<int> before = see({0.0F, y});
        for (float x = kStep; x < kSide; x += kStep) {
            const std::optional<int> here = see({x, y});
            if (before && here && *before != *here) {
                ++changes;
                missed += nearest(lines, {x - 0.5F * kStep, y}) > 0.1 ? 1 : 0;
            }
            before = here;
        }
    }
    EXPECT_GT(changes, 30);
    EXPECT_LE(missed, changes / 50 + 1) << changes;
}

/// Balls round about and behind the middle.
Balls surroundings() {
    Balls scene;
    for (int k = 0; k < 9; ++k) {
        const double angle = 0.7 * k;
        scene.balls.push_back(
            {{40.0 * std::cos(angle), 40.0 * std::sin(angle), -95.0 + 3.0 * k}, 10.0 + 1.5 * k});
    }
    for (int k = 0; k < 7; ++k) {
        const double angle = 0.9 * k + 0.3;
        scene.balls.push_back(
            {{130.0 * std::cos(angle), 130.0 * std::sin(angle), 25.0 - 9.0 * k}, 22.0 + 4.0 * k});
    }
    return scene;
}

std::vector<Object> objects_of(const Balls& scene) {
    std::vector<Sphere> spheres;
    for (const auto& [centre, radius] : scene.balls) {
        spheres.push_back({to_float(centre), static_cast<float>(radius)});
    }
    return {sphere_object(std::move(spheres))};
}

constexpr double kRadius = 70.0;

TEST(CurvedMirror, ShowsLinesWhereAReferenceHasThem) {
    const Balls scene = surroundings();
    std::vector<Object> objects = objects_of(scene);
    objects.push_back(ball({0, 0, 0}, kRadius, mirror_of(1.0F)));
    const Result result = render_lines(objects, plan_view());
    expect_lines(
        result, 1,
        [&](Vec2f p) -> std::optional<int> {
            const Vec3d q = plan_point(p);
            const double squared = kRadius * kRadius - dot(q, q);
            const Ray ray{{q.x, q.y, 1000.0}, {0, 0, -1}};
            // Where the ball's image is crowded beyond what a lattice can tell apart, no question.
            if (squared < 0.12 * kRadius * kRadius) return std::nullopt;
            const Vec3d point{q.x, q.y, std::sqrt(squared)};
            if (scene.first(ray, -1).t < 1000.0 - point.z) return std::nullopt;
            const Vec3d normal = point / kRadius;
            return scene.first({point, ray.dir - normal * (2.0 * dot(ray.dir, normal))}, -1).ball;
        },
        60.0);
}

TEST(GlassBall, ShowsLinesWhereAReferenceHasThem) {
    const Balls scene = surroundings();
    std::vector<Object> objects = objects_of(scene);
    objects.push_back(ball({0, 0, 0}, kRadius, glass()));
    const Result result = render_lines(objects, plan_view());
    expect_lines(
        result, 2,
        [&](Vec2f p) -> std::optional<int> {
            const Vec3d q = plan_point(p);
            const double squared = kRadius * kRadius - dot(q, q);
            if (squared < 0.12 * kRadius * kRadius) return std::nullopt;
            const Vec3d point{q.x, q.y, std::sqrt(squared)};
            if (scene.first({{q.x, q.y, 1000.0}, {0, 0, -1}}, -1).t < 1000.0 - point.z) {
                return std::nullopt;
            }
            const Vec3d within = refract({0, 0, -1}, point / kRadius, 1.0 / 1.5);
            const Vec3d leaves = point - within * (2.0 * dot(point, within));
            return scene.first({leaves, refract(within, -leaves / kRadius, 1.5)}, -1).ball;
        },
        60.0);
}

TEST(GlassSlab, ShowsLinesWhereAReferenceHasThem) {
    const Balls scene = surroundings();
    std::vector<Object> objects = objects_of({{scene.balls.begin(), scene.balls.begin() + 9}});
    // Turned about y, 40 thick, wider than the picture.
    const double turn = 0.5;
    const Vec3d normal{std::sin(turn), 0, std::cos(turn)};
    Object slab;
    slab.name = "slab";
    slab.kind = ObjectKind::shape;
    slab.material = glass();
    slab.shape = Glyphs{{GlyphKind::box},
                        {{to_float(Vec3d{std::cos(turn), 0, -std::sin(turn)} * 300.0),
                          {0, 300, 0},
                          to_float(normal * 20.0),
                          to_float(normal * 60.0)}},
                        {},
                        {}};
    objects.push_back(slab);
    Settings settings = plan_view();
    const Result result = render_lines(objects, settings);
    const Balls behind{{scene.balls.begin(), scene.balls.begin() + 9}};
    expect_lines(
        result, 2,
        [&](Vec2f p) -> std::optional<int> {
            const Vec3d q = plan_point(p);
            const Ray ray{{q.x, q.y, 1000.0}, {0, 0, -1}};
            const Vec3d enters =
                ray.origin + ray.dir * ((80.0 - dot(ray.origin, normal)) / dot(ray.dir, normal));
            const Vec3d within = refract(ray.dir, normal, 1.0 / 1.5);
            const Vec3d leaves = enters + within * (-40.0 / dot(within, normal));
            return behind.first({leaves, refract(within, normal, 1.5)}, -1).ball;
        },
        60.0);
}

// Transparent surfaces

TEST(TransparentSurface, ShowsTheLinesBehindItAsIfItWereNotThere) {
    const std::vector<Object> behind = random_objects(3, 8, 0);
    Settings settings = plan_view();
    settings.view.eye = Vec3d{0.5, 0.5, 100};
    settings.view.look_at = Vec3d{0.5, 0.5, 0};
    settings.view.orthographic = 1.6;
    const Result direct = render_lines({behind[0]}, settings);
    Object pane =
        mesh_object({{-9, -9, 3}, {9, -9, 3}, {9, 9, 3}, {-9, 9, 3}}, {{0, 1, 2}, {0, 2, 3}});
    pane.material = film_of(0.6F);
    const Result through = render_lines({behind[0], pane}, settings);
    EXPECT_TRUE(at_level(through.drawing, 0).empty());
    const std::vector<Segment> seen = at_level(through.drawing, 1);
    EXPECT_NEAR(total_length(seen), total_length(direct.drawing.segments),
                0.01 * total_length(seen));
    double off = 0.0;
    for (const Segment& segment : seen) {
        if (nearest(direct.drawing.segments, middle(segment)) > 0.05) off += length_of(segment);
    }
    EXPECT_LT(off, 0.005 * total_length(seen));
}

TEST(TransparentSurface, MixesItsColourWithWhatIsBehind) {
    Object back =
        mesh_object({{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}, {{0, 1, 2}, {0, 2, 3}});
    Object front =
        mesh_object({{-9, -9, 1}, {9, -9, 1}, {9, 9, 1}, {-9, 9, 1}}, {{0, 1, 2}, {0, 2, 3}});
    back.material.color = {255, 0, 0};
    front.material = film_of(0.6F);
    front.material.color = {0, 0, 255};
    Settings settings = plan_view();
    settings.size = {16, 16};
    settings.view.orthographic = 4.0;
    settings.shading.mode = ShadeMode::flat;
    const Scene scene({back, front});
    const Film film = draw(scene, settings, {.display = false, .linear = true});
    const auto at = [&](const char* name) { return plane(film, name)[8 * 16 + 8]; };
    EXPECT_NEAR(at("R"), 0.6, 1e-3);
    EXPECT_NEAR(at("G"), 0.0, 1e-3);
    EXPECT_NEAR(at("B"), 0.4, 1e-3);
}

// What must not change

std::vector<Object> mixed_scene(bool specular) {
    std::vector<Object> objects = random_objects(11, 14, 6);
    Object mirror = ball({0.3F, 0.6F, 0.9F}, 0.3F);
    Object lens = ball({0.8F, 0.3F, 1.0F}, 0.25F);
    if (specular) {
        mirror.material = mirror_of(0.8F);
        lens.material = glass();
        objects[1].material = film_of(0.5F);
    }
    objects.push_back(mirror);
    objects.push_back(lens);
    return objects;
}

Settings mixed_view() {
    Settings settings;
    settings.size = {128, 128};
    settings.view.view = View::front;
    settings.aovs = {Aov::lines};
    settings.threads = 1;
    return settings;
}

TEST(DirectLines, AreNotChangedByMirrorsAndGlass) {
    Settings settings = mixed_view();
    settings.line_rules = read_line_rules("all/+:opacity=0");
    const Result specular = render_lines(mixed_scene(true), settings);
    const Result plain = render_lines(mixed_scene(false), settings);
    const auto keys = [](const std::vector<Segment>& segments) {
        std::vector<std::tuple<float, float, float, float, LineType, GeometryId, GeometryId>> all;
        for (const Segment& s : segments) {
            all.emplace_back(s.a.x, s.a.y, s.b.x, s.b.y, s.type, s.left, s.right);
        }
        std::ranges::sort(all);
        return all;
    };
    ASSERT_FALSE(at_level(specular.drawing, 1).empty());
    ASSERT_FALSE(at_level(specular.drawing, 2).empty());
    EXPECT_EQ(keys(at_level(specular.drawing, 0)), keys(plain.drawing.segments));
    const Plane<float>& ink = plane(specular.film, "line.A");
    const Plane<float>& expected = plane(plain.film, "line.A");
    for (std::size_t k = 0; k < ink.size(); ++k) ASSERT_NEAR(ink[k], expected[k], 1e-6);
}

TEST(SpecularPicture, IsTheSameForAnyTilesAndThreads) {
    const Scene scene(mixed_scene(true));
    Settings settings = mixed_view();
    const Film whole = draw(scene, settings);
    settings.tile = 16;
    settings.threads = 2;
    const Film cut = draw(scene, settings);
    EXPECT_EQ(whole.display().pixels, cut.display().pixels);
    EXPECT_EQ(plane(whole, "line.A"), plane(cut, "line.A"));
}

TEST(SpecularDepth, OfZeroLeavesOpaqueSurfaces) {
    Settings settings = mixed_view();
    settings.specular_depth = 0;
    const Scene specular(mixed_scene(true));
    const Scene plain(mixed_scene(false));
    EXPECT_EQ(draw(specular, settings).display().pixels, draw(plain, settings).display().pixels);
}

// Optics

TEST(Fresnel, HasItsClosedForms) {
    EXPECT_NEAR(fresnel(1.0, 1.0 / 1.5), 0.04, 1e-12);
    EXPECT_NEAR(fresnel(1.0, 1.5), 0.04, 1e-12);
    EXPECT_NEAR(fresnel(0.0, 1.0 / 1.5), 1.0, 1e-12);
    // At Brewster's angle one polarisation is not reflected: half of what the other one is.
    const double cosine = std::cos(std::atan(1.5));
    const double beyond = std::sqrt(1.0 - (1.0 - cosine * cosine) / 2.25);
    const double across = (cosine - 1.5 * beyond) / (cosine + 1.5 * beyond);
    EXPECT_NEAR(fresnel(cosine, 1.0 / 1.5), 0.5 * across * across, 1e-12);
    // Total reflection beyond the critical angle.
    const double critical = std::sqrt(1.0 - 1.0 / 2.25);
    EXPECT_EQ(fresnel(0.99 * critical, 1.5), 1.0);
    EXPECT_LT(fresnel(1.01 * critical, 1.5), 1.0);
}

TEST(Optics, GivesAwayAllLightAndNoMore) {
    std::vector<Object> objects{ball({0, 0, 0}, 1.0F, glass()),
                                ball({3, 0, 0}, 1.0F, mirror_of(0.7F)),
                                ball({6, 0, 0}, 1.0F, film_of(0.6F))};
    const Scene scene(objects);
    const Optics optics(scene);
    for (std::uint32_t k = 0; k < 3; ++k) {
        const auto& sphere = std::get<Spheres>(scene.objects()[k].shape).spheres[0];
        const Vec3d centre = to_double(sphere.centre);
        const auto radius = static_cast<double>(sphere.radius);
        const Vec3d normal = normalize(Vec3d{0.3, 0.2, 0.8});
        const Vec3d dir{0, 0, -1};
        const Vec3d origin = centre + normal * radius - dir * 0.5;
        const Scattering result = optics.scatter({origin, dir, 0.5, normal, normal, k, 0, {}});
        EXPECT_NEAR(result.own + result.main.share + result.side.share, 1.0, 1e-12);
    }
}

// Styles

TEST(LineRules, TellLevelsApart) {
    const auto rules = read_line_rules("crease@2/1:width=1px;all/+:opacity=0.5;all/0:color=red");
    EXPECT_TRUE(rules[0].applies(LineType::crease, 2, 1, false));
    EXPECT_FALSE(rules[0].applies(LineType::crease, 2, 2, false));
    EXPECT_FALSE(rules[1].applies(LineType::crease, 2, 0, false));
    EXPECT_TRUE(rules[1].applies(LineType::silhouette, 1, 7, false));
    EXPECT_TRUE(rules[2].applies(LineType::silhouette, 1, 0, false));
    EXPECT_EQ(print(read_line_rules(print(rules))), print(rules));
    EXPECT_THROW(read_line_rules("all/x:width=1px"), UsageError);
    EXPECT_THROW(read_line_rules("all/-1:width=1px"), UsageError);
}

}  // namespace
}  // namespace ink::test
