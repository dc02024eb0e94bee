#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "drawing.h"
#include "edges_view.h"
#include "lines/coverage.h"
#include "lines/density.h"
#include "scenes.h"

namespace ink::test {
namespace {

// Where lines run

/// A curve on the screen as the zeros of a function, and a point within.
struct Curve {
    std::function<double(double x, double y)> f;  ///< positive inside
    double x, y;

    struct Distance {
        double value;   ///< signed, pixels
        double nx, ny;  ///< unit, inwards
    };
    Distance distance(double px, double py) const {
        constexpr double kStep = 1e-3;
        double x0 = px;
        double y0 = py;
        double nx = 0.0;
        double ny = 0.0;
        for (int step = 0; step < 4; ++step) {  // of Newton's, to the curve
            const double fx = (f(x0 + kStep, y0) - f(x0 - kStep, y0)) / (2 * kStep);
            const double fy = (f(x0, y0 + kStep) - f(x0, y0 - kStep)) / (2 * kStep);
            const double size = std::hypot(fx, fy);
            nx = fx / size;
            ny = fy / size;
            // From the point itself along the normal at the foot, and back onto the curve.
            const double along = (px - x0) * nx + (py - y0) * ny;
            x0 = px - along * nx;
            y0 = py - along * ny;
            const double value = f(x0, y0) / size;
            x0 -= value * nx;
            y0 -= value * ny;
        }
        return {(px - x0) * nx + (py - y0) * ny, nx, ny};
    }
};

/// Compares the ink across the curve, row by row or column by column, with the ink of a band whose
/// middle is the curve: how far apart their centroids are, at the most.
double worst_offset(const Plane<float>& ink, Size size, const Curve& curve, double width) {
    double worst = 0.0;
    for (int k = 0; k < 360; k += 3) {
        const double dx = std::cos(k * kDegrees);
        const double dy = std::sin(k * kDegrees);
        double in = 0.0;
        double out = 0.0;
        while (curve.f(curve.x + out * dx, curve.y + out * dy) > 0.0) out += 0.5;
        for (int step = 0; step < 40; ++step) {
            const double middle = (in + out) / 2;
            (curve.f(curve.x + middle * dx, curve.y + middle * dy) > 0.0 ? in : out) = middle;
        }
        const int x = static_cast<int>(std::floor(curve.x + in * dx));
        const int y = static_cast<int>(std::floor(curve.y + in * dy));
        const auto here = curve.distance(x + 0.5, y + 0.5);
        const bool along_row = std::abs(here.nx) > std::abs(here.ny);
        const int reach = static_cast<int>(width) + 3;
        double drawn = 0.0;
        double drawn_moment = 0.0;
        double expected = 0.0;
        double expected_moment = 0.0;
        for (int s = -reach; s <= reach; ++s) {
            const int px = along_row ? x + s : x;
            const int py = along_row ? y : y + s;
            if (px < 0 || py < 0 || px >= size.width || py >= size.height) continue;
            const auto d = curve.distance(px + 0.5, py + 0.5);
            const double wanted =
                band_coverage(static_cast<float>(std::abs(d.value)), static_cast<float>(width / 2),
                              static_cast<float>(d.nx), static_cast<float>(d.ny));
            drawn += ink[at(size, px, py)];
            drawn_moment += static_cast<double>(ink[at(size, px, py)]) * s;
            expected += wanted;
            expected_moment += wanted * s;
        }
        const double apart = drawn_moment / drawn - expected_moment / expected;
        const double across = std::max(std::abs(here.nx), std::abs(here.ny));
        EXPECT_LT(std::abs(apart) * across, 0.05) << "at " << x << ", " << y;
        EXPECT_NEAR(drawn * across, expected * across, 0.03 * width) << "at " << x << ", " << y;
        worst = std::max(worst, std::abs(apart) * across);
    }
    return worst;
}

TEST(SphereInPerspective, HasItsOutlineOnTheProjectedEllipse) {
    struct View {
        Vec3d centre;
        double radius, fov_deg;
    };
    for (const View& view : {View{{0, 0, 0}, 2.0, 40}, View{{3.1, 1.7, -1}, 1.5, 60},
                             View{{-4, 2, 2}, 1.8, 75}, View{{-6, -3.5, 4}, 1.2, 100}}) {
        for (const int q : {1, 2, 4}) {
            Settings settings;
            settings.size = {200, 150};
            settings.view.eye = Vec3d{0, 0, 10};
            settings.view.look_at = Vec3d{0, 0, 0};
            settings.view.fov_deg = view.fov_deg;
            settings.aovs = {Aov::lines};
            settings.line_width = {3, Length::Unit::px};
            settings.lattice = q;
            const Film film = draw(
                Scene({sphere_object({{to_float(view.centre), static_cast<float>(view.radius)}})}),
                settings);
            const double pixel = 2 * std::tan(view.fov_deg * kDegrees / 2) / 150;
            const Vec3d c = view.centre - Vec3d{0, 0, 10};
            const Curve outline{[=](double x, double y) {
                                    const Vec3d d{(x - 100) * pixel, -(y - 75) * pixel, -1};
                                    const double along = dot(d, c);
                                    return along * along -
                                           (dot(c, c) - view.radius * view.radius) * dot(d, d);
                                },
                                100 - c.x / c.z / pixel, 75 + c.y / c.z / pixel};
            const double worst = worst_offset(plane(film, "line.A"), settings.size, outline, 3.0);
            EXPECT_LT(worst, 0.05) << view.fov_deg << " degrees, q " << q;
        }
    }
}

TEST(SphereSeam, LiesOnTheirRadicalPlane) {
    const Vec3d c{-2, 1, 0};
    const double r = 50;
    for (const Vec3d d : {Vec3d{5, 3, 30}, Vec3d{-5, 9, 28}, Vec3d{1, -4, 33}}) {
        const double s = 30;  // small enough for all of the seam to be seen
        // Both spheres' equations are true where their difference, a plane, is.
        const Vec3d a = 2.0 * (d - c);
        const double rhs = dot(d, d) - dot(c, c) - s * s + r * r;
        const auto on_plane = [=](double x, double y) {
            const double px = x - 80;
            const double py = 64 - y;
            return Vec3d{px, py, (rhs - a.x * px - a.y * py) / a.z};
        };
        const double apart = dot(d - c, d - c);
        const Vec3d middle = c + (d - c) * ((apart + r * r - s * s) / (2 * apart));
        const Curve seam{[=](double x, double y) {
                             const Vec3d v = on_plane(x, y) - c;
                             return r * r - dot(v, v);
                         },
                         80 + middle.x, 64 - middle.y};
        ASSERT_GT(seam.f(seam.x, seam.y), 0.0);
        for (const int q : {1, 2, 4}) {
            Settings settings = plan_view({160, 128});
            set(settings, "lines", "intersection");
            settings.lattice = q;
            const Film film = draw(Scene({sphere_object({{to_float(c), static_cast<float>(r)},
                                                         {to_float(d), static_cast<float>(s)}})}),
                                   settings);
            EXPECT_LT(worst_offset(plane(film, "line.A"), settings.size, seam, 3.0), 0.05);
        }
    }
}

TEST(LinesAtTheBorder, AreThoseOfALargerPicture) {
    std::mt19937 random(7);
    std::vector<Sphere> spheres;
    for (int k = 0; k < 60; ++k) {
        const Vec3f p = uniform_point(random) - Vec3f{0.5F, 0.5F, 0.5F};
        spheres.push_back({p * 110.0F, 3.0F + 9.0F * uniform(random)});
    }
    const Scene scene({sphere_object(spheres)});
    for (const int q : {1, 3}) {
        for (const double width : {2.0, 20.0}) {
            Settings settings = plan_view({64, 48}, width);
            settings.lattice = q;
            settings.line_density = 1.0;  // how dense lines are outside of a picture is not known
            const Film small = draw(scene, settings);
            settings.size = {128, 112};
            settings.view.orthographic = 112.0;
            const Film large = draw(scene, settings);
            double worst = 0.0;
            double sum = 0.0;
            for (int y = 0; y < 48; ++y) {
                for (int x = 0; x < 64; ++x) {
                    const double difference =
                        std::abs(plane(small, "line.A")[at({64, 48}, x, y)] -
                                 plane(large, "line.A")[at({128, 112}, x + 32, y + 32)]);
                    worst = std::max(worst, difference);
                    sum += difference;
                }
            }
            EXPECT_LT(worst, 0.1) << "width " << width << ", q " << q;
            EXPECT_LT(sum / (64 * 48), 1e-3) << "width " << width << ", q " << q;
        }
    }
}

TEST(LinesAtTheBorder, ReachInFromOutside) {
    // The plane's edge is 6 px to the right of the picture.
    const Scene scene(placed({half_plane(90, 500)}, 1.0, {38, 0, 0}));
    const Film film = draw(scene, plan_view({64, 64}, 20.0));
    for (int x = 0; x < 64; ++x) {
        const double expected = x < 60 ? 0.0 : 1.0;
        EXPECT_NEAR(plane(film, "line.A")[at({64, 64}, x, 30)], expected, 0.02) << x;
    }
}

// Against the paper's method

/// Whether the stencil about a pixel sees two IDs at the most: there its strength has a closed
/// form.
std::vector<bool> away_from_junctions(const Film& film, double h) {
    const Size size = film.size();
    const Plane<std::uint32_t>* ids = nullptr;
    for (const Channel& channel : film.channels().channels) {
        if (channel.name == "id.primitive") {
            ids = &std::get<Plane<std::uint32_t>>(channel.values);
        }
    }
    std::vector<bool> away(size.pixels());
    const int reach = static_cast<int>(std::ceil(h)) + 1;
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            std::set<std::uint32_t> seen;
            for (int dy = -reach; dy <= reach; ++dy) {
                for (int dx = -reach; dx <= reach; ++dx) {
                    const int px = std::clamp(x + dx, 0, size.width - 1);
                    const int py = std::clamp(y + dy, 0, size.height - 1);
                    if (std::hypot(dx, dy) <= h + 1) seen.insert((*ids)[at(size, px, py)]);
                }
            }
            away[at(size, x, y)] = seen.size() <= 2;
        }
    }
    return away;
}

class PapersLook : public testing::TestWithParam<const char*> {};

TEST_P(PapersLook, IsThatOfStencilsWithManyRings) {
    const Scene scene = acetaminophen();
    Settings settings;
    settings.size = {192, 192};
    settings.line_width = {8, Length::Unit::px};
    settings.line_density = 1.0;  // stencils know no other
    settings.aovs = {Aov::lines, Aov::id};
    set(settings, "metric", GetParam());
    const Film edges = draw(scene, settings);
    settings.method = Method::stencil;
    settings.rings = 16;
    const Film stencils = draw(scene, settings);

    const auto& a = plane(edges, "line.A");
    const auto& b = plane(stencils, "line.A");
    const std::vector<bool> away = away_from_junctions(edges, 4.0);
    double away_sum = 0.0;
    double line_sum = 0.0;
    double near_sum = 0.0;
    int away_count = 0;
    int line_count = 0;
    int near_count = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        const double difference = std::abs(a[k] - b[k]);
        (away[k] ? away_sum : near_sum) += difference;
        ++(away[k] ? away_count : near_count);
        if (!away[k] || (a[k] == 0.0F && b[k] == 0.0F)) continue;
        line_sum += difference;
        ++line_count;
    }
    EXPECT_LT(away_sum / away_count, 0.01);
    EXPECT_LT(line_sum / line_count, 0.03);
    EXPECT_GT(line_count, 2000);
    RecordProperty("away", std::to_string(away_sum / away_count));
    RecordProperty("away_on_lines", std::to_string(line_sum / line_count));
    RecordProperty("near", std::to_string(near_sum / near_count));
    RecordProperty("share_away", std::to_string(static_cast<double>(away_count) / 192 / 192));
}

INSTANTIATE_TEST_SUITE_P(OfMetric, PapersLook, testing::Values("linear", "power:10"));

// Invariances

void expect_same_for_tiles(const Scene& scene, Settings settings) {
    const auto tracer = make_tracer(scene);
    settings.threads = 1;
    settings.tile = 512;
    const Film reference = render(scene, *tracer, settings, {true, true});
    for (const int tile : {4, 20, 36}) {
        settings.tile = tile;
        const Film film = render(scene, *tracer, settings, {true, true});
        EXPECT_TRUE(film.display().pixels == reference.display().pixels) << "tiles of " << tile;
    }
}

TEST(Picture, OfSticksDoesNotDependOnTiles) {
    for (unsigned seed = 0; seed < 12; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene(chain_of_sticks(seed, 400, 1.0F));
        Settings settings;
        settings.size = {160, 120};
        settings.view.view = seed % 2 == 0 ? View::front : View::top;
        expect_same_for_tiles(scene, settings);
    }
}

/// Tones are as soft as light changes between neighbours, which may lie beyond a tile's end.
TEST(Picture, InTonesDoesNotDependOnTiles) {
    for (unsigned seed = 0; seed < 2; ++seed) {
        SCOPED_TRACE(seed);
        std::vector<Object> objects = random_objects(seed, 60, 40);
        if (seed % 2 == 1) objects[0].material.mirror = 0.5F;
        const Scene scene(std::move(objects));
        Settings settings;
        settings.size = {159, 121};
        settings.view.view = View::front;
        set(settings, "look", "toon");
        expect_same_for_tiles(scene, settings);
    }
}

/// Small prisms of nine sides as meshes, turned and placed at random, so that they hide each
/// other: lines between faces, creases and outlines run through cells beside each other.
Scene random_prisms(unsigned seed, int count) {
    constexpr std::uint32_t kSides = 9;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-1.0, 1.0);
    std::vector<Object> prisms;
    for (int n = 0; n < count; ++n) {
        const Vec3d x = normalize(Vec3d{place(random), place(random), place(random)});
        const Vec3d y = normalize(cross(x, Vec3d{place(random), place(random), place(random)}));
        const Vec3d z = cross(x, y);
        const Vec3d middle{place(random), place(random), place(random)};
        std::vector<Vec3f> corners;
        std::vector<Mesh::Triangle> triangles;
        for (std::uint32_t k = 0; k < kSides; ++k) {
            const double angle = 2.0 * std::numbers::pi * k / kSides;
            const Vec3d rim = middle + (x * std::cos(angle) + y * std::sin(angle)) * 0.06;
            corners.push_back(to_float(rim - z * 0.08));
            corners.push_back(to_float(rim + z * 0.08));
            const std::uint32_t own = 2 * k;
            const std::uint32_t next = 2 * ((k + 1) % kSides);
            triangles.push_back({own, next, next + 1});
            triangles.push_back({own, next + 1, own + 1});
            if (k + 2 < kSides) triangles.push_back({0, own + 4, own + 2});
            if (k + 2 < kSides) triangles.push_back({1, own + 3, own + 5});
        }
        prisms.push_back(mesh_object(corners, triangles));
    }
    return Scene(std::move(prisms));
}

/// Where outlines do not cover their ends, lines between faces are joined beside them.
TEST(Picture, OfLinesBetweenFacesAloneDoesNotDependOnTiles) {
    for (unsigned seed = 0; seed < 8; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = random_prisms(seed, 300);
        Settings settings;
        settings.size = {160, 120};
        settings.view.view = View::front;
        set(settings, "lines", "mesh");
        expect_same_for_tiles(scene, settings);
    }
}

TEST(Picture, OfLocatedLinesDoesNotDependOnThreadsOrTiles) {
    const Scene scene(random_objects(5, 60, 40));
    const auto tracer = make_tracer(scene);
    for (int q = 1; q <= 4; ++q) {
        for (const bool transparent : {false, true}) {
            Settings settings;
            settings.size = {90, 70};
            settings.line_width = {transparent ? 9.0 : 2.5, Length::Unit::px};
            settings.view.view = View::front;
            settings.lattice = q;
            settings.shading.transparent_background = transparent;
            settings.aovs = {Aov::id, Aov::depth, Aov::normal, Aov::position, Aov::lines};
            settings.threads = 1;
            const Film reference = render(scene, *tracer, settings, {true, true});
            // The reference has tiles of 64; of 512 there is only one.
            struct Cut {
                int threads, tile;
            };
            for (const auto& [threads, tile] :
                 {Cut{1, 4}, Cut{1, 20}, Cut{1, 512}, Cut{3, 4}, Cut{3, 20}, Cut{3, 64}}) {
                settings.threads = threads;
                settings.tile = tile;
                const Film film = render(scene, *tracer, settings, {true, true});
                EXPECT_TRUE(film.display().pixels == reference.display().pixels)
                    << "q " << q << ", " << threads << " threads, tiles of " << tile;
                ASSERT_EQ(film.channels().channels.size(), reference.channels().channels.size());
                for (std::size_t k = 0; k < film.channels().channels.size(); ++k) {
                    EXPECT_TRUE(film.channels().channels[k].values ==
                                reference.channels().channels[k].values)
                        << film.channels().channels[k].name << ", q " << q << ", " << threads
                        << " threads, tiles of " << tile;
                }
            }
        }
    }
}

TEST(Picture, OfLocatedLinesIsTheSameForTheScreenAloneAndWithNumbers) {
    const Scene scene(random_objects(5, 60, 40));
    Settings settings;
    settings.size = {90, 70};
    settings.view.view = View::front;
    const Film alone = draw(scene, settings);
    const Film both = draw(scene, settings, {true, true});
    int largest = 0;
    for (std::size_t k = 0; k < alone.display().pixels.size(); ++k) {
        for (unsigned shift = 0; shift < 32; shift += 8) {
            largest = std::max(
                largest, std::abs(static_cast<int>(alone.display().pixels[k] >> shift & 0xFFU) -
                                  static_cast<int>(both.display().pixels[k] >> shift & 0xFFU)));
        }
    }
    EXPECT_LE(largest, 1);
}

Plane<float> halved(const Plane<float>& large, Size size) {
    Plane<float> small(size.pixels(), 0.0F);
    const Size from{2 * size.width, 2 * size.height};
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            small[at(size, x, y)] =
                (large[at(from, 2 * x, 2 * y)] + large[at(from, 2 * x + 1, 2 * y)] +
                 large[at(from, 2 * x, 2 * y + 1)] + large[at(from, 2 * x + 1, 2 * y + 1)]) /
                4;
        }
    }
    return small;
}

TEST(Picture, AtTwiceTheResolutionShowsTheSameLines) {
    std::vector<Object> objects = random_objects(5, 60, 0);
    objects.pop_back();
    const Scene random(objects);
    const Scene molecule = acetaminophen();
    for (const Scene* scene : {&molecule, &random}) {
        for (const double percent : {1.0, 2.0, 5.0}) {
            Settings settings;
            settings.size = {160, 160};
            settings.line_width = {percent, Length::Unit::percent};
            settings.aovs = {Aov::lines};
            const Film small = draw(*scene, settings);
            settings.size = {320, 320};
            const Film large = draw(*scene, settings);
            const double difference = mean_difference(plane(small, "line.A"),
                                                      halved(plane(large, "line.A"), small.size()));
            EXPECT_LT(difference, 0.01) << percent << " %";
            RecordProperty((scene == &random ? "random_" : "molecule_") + std::to_string(percent),
                           std::to_string(difference));
        }
    }
}

TEST(Picture, Of2048PixelsShowsTheLinesOf1024) {
    const Scene scene = acetaminophen();
    Settings settings;
    settings.size = {1024, 1024};
    settings.line_width = {0.3, Length::Unit::percent};
    settings.aovs = {Aov::lines};
    const Film small = draw(scene, settings);
    settings.size = {2048, 2048};
    const Film large = draw(scene, settings);
    EXPECT_LT(mean_difference(plane(small, "line.A"), halved(plane(large, "line.A"), small.size())),
              0.001);
}

TEST(Picture, OfLocatedLinesHasTheSameLinesOnAnyLattice) {
    const Scene scene = acetaminophen();
    Settings settings;
    settings.size = {160, 160};
    settings.line_width = {3, Length::Unit::px};
    settings.aovs = {Aov::lines};
    const Film one = draw(scene, settings);
    for (int q = 2; q <= 4; ++q) {
        settings.lattice = q;
        EXPECT_LT(mean_difference(plane(one, "line.A"), plane(draw(scene, settings), "line.A")),
                  0.005)
            << q;
    }
}

}  // namespace
}  // namespace ink::test
