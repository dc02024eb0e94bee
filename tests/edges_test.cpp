#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/error.h"
#include "drawing.h"
#include "io/reader.h"
#include "lines/coverage.h"
#include "paths.h"
#include "render/render.h"
#include "scenes.h"

namespace ink::test {
namespace {

constexpr double kDegrees = std::numbers::pi / 180.0;

/// Orthographic, straight on, one scene unit a pixel, the origin in the middle of the picture.
Settings plan_view(Size size, double width_px = 3.0) {
    Settings settings;
    settings.size = size;
    settings.view.view = View::front;
    settings.view.eye = Vec3d{0, 0, 100};
    settings.view.look_at = Vec3d{0, 0, 0};
    settings.view.orthographic = static_cast<double>(size.height);
    settings.aovs = {Aov::lines};
    settings.line_width = {width_px, Length::Unit::px};
    settings.threads = 2;
    return settings;
}

void set(Settings& settings, std::string_view name, std::string_view value) {
    find_setting(name).set(settings, value);
}

Scene acetaminophen() {
    return Scene(read_file(source_dir() / "samples/acetaminophen.xyz").objects);
}

std::size_t at(Size size, int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
           static_cast<std::size_t>(x);
}

double mean_difference(const std::vector<float>& a, const std::vector<float>& b) {
    EXPECT_EQ(a.size(), b.size());
    double sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += std::abs(a[k] - b[k]);
    return sum / static_cast<double>(a.size());
}

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
double worst_offset(const std::vector<float>& ink, Size size, const Curve& curve, double width) {
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
    const std::vector<std::uint32_t>* ids = nullptr;
    for (const Channel& channel : film.channels().channels) {
        if (channel.name == "id.primitive") {
            ids = &std::get<std::vector<std::uint32_t>>(channel.values);
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

// Lines denser than they are wide

/// Spheres side by side in a square of 100 x 100, in a picture of `side` pixels.
std::vector<float> ink_of_packed_spheres(int side, double density, double width_px = 3.0) {
    std::mt19937 random(3);
    std::vector<Sphere> spheres;
    for (int k = 0; k < 20000; ++k) {
        const Vec3f p = uniform_point(random) - Vec3f{0.5F, 0.5F, 0.5F};
        spheres.push_back({{p.x * 120.0F, p.y * 120.0F, p.z * 4.0F}, 1.2F});
    }
    Settings settings = plan_view({side, side}, width_px);
    settings.view.orthographic = 100.0;
    settings.line_density = density;
    return plane(draw(Scene({sphere_object(spheres)}), settings), "line.A");
}

double mean(const std::vector<float>& values) {
    double sum = 0.0;
    for (const float value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

TEST(DenseLines, BecomeAToneHoweverSmallThePicture) {
    double before = 0.0;
    for (const int side : {600, 400, 280, 200, 140, 100, 70, 50, 35}) {
        const double tone = mean(ink_of_packed_spheres(side, 0.75));
        EXPECT_LT(tone, 0.7) << side;
        EXPECT_GT(tone, 0.2) << side;
        // No step in tone between pictures of similar size.
        EXPECT_NEAR(tone, before > 0.0 ? before : tone, 0.12) << side;
        before = tone;
    }
    EXPECT_GT(mean(ink_of_packed_spheres(100, 1.0)), 0.95);
}

TEST(DenseLines, KeepTheirWidthWhereThereIsRoom) {
    const std::vector<float> sparse = ink_of_packed_spheres(1400, 0.75, 1.5);
    EXPECT_EQ(sparse, ink_of_packed_spheres(1400, 1.0, 1.5));
}

// Invariances

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
            for (const int threads : {1, 3}) {
                for (const int tile : {4, 20, 64, 512}) {
                    settings.threads = threads;
                    settings.tile = tile;
                    const Film film = render(scene, *tracer, settings, {true, true});
                    EXPECT_TRUE(film.display().pixels == reference.display().pixels)
                        << "q " << q << ", " << threads << " threads, tiles of " << tile;
                    ASSERT_EQ(film.channels().channels.size(),
                              reference.channels().channels.size());
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

std::vector<float> halved(const std::vector<float>& large, Size size) {
    std::vector<float> small(size.pixels());
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

// Shading

TEST(EdgeSmoothing, GivesAPixelTheMeanOfItsTwoSidesByArea) {
    for (const int q : {1, 2, 3, 4}) {
        double worst = 0.0;
        for (double angle_deg = 0.0; angle_deg < 360.0; angle_deg += 7.5) {
            const Vec3d shift{0.137, 0.211, 0};
            Object object = half_plane(angle_deg, 300);
            object.material.color = {255, 255, 255};
            Settings settings = plan_view({32, 32});
            settings.compose = Compose::shaded;
            settings.shading.mode = ShadeMode::flat;
            settings.shading.background = {0, 0, 0};
            settings.aa = AntiAliasing{AntiAliasing::Kind::edges, 1};
            settings.lattice = q;
            const Film film = draw(Scene(placed({object}, 1.0, shift)), settings, {false, true});
            const double nx = -std::sin(angle_deg * kDegrees);
            const double ny = std::cos(angle_deg * kDegrees);
            for (int y = 0; y < 32; ++y) {
                for (int x = 0; x < 32; ++x) {
                    const double inside =
                        (x + 0.5 - 16 - shift.x) * nx + (16 - y - 0.5 - shift.y) * ny;
                    const double area = square_coverage(
                        static_cast<float>(inside), static_cast<float>(nx), static_cast<float>(ny));
                    const double grey = plane(film, "R")[at({32, 32}, x, y)];
                    EXPECT_NEAR(grey, area, 0.02)
                        << angle_deg << " degrees, q " << q << ", at " << x << ", " << y;
                    worst = std::max(worst, std::abs(grey - area));
                }
            }
        }
        RecordProperty("worst_" + std::to_string(q), std::to_string(worst));
    }
}

TEST(EdgeSmoothing, KeepsTheAreaOfADisc) {
    for (const int q : {1, 2, 4}) {
        for (const double radius : {2.0, 5.0, 12.3}) {
            Settings settings = plan_view({32, 32});
            settings.compose = Compose::shaded;
            settings.shading.transparent_background = true;
            settings.lattice = q;
            const Scene scene(placed({sphere_object({{{0, 0, 0}, static_cast<float>(radius)}})},
                                     1.0, {0.137, 0.211, 0}));
            const Film film = draw(scene, settings, {false, true});
            double area = 0.0;
            for (const float alpha : plane(film, "A")) area += alpha;
            EXPECT_NEAR(area, std::numbers::pi * radius * radius,
                        0.65 / (q * q) + 0.1)  // chords cut off pi / 6 at a spacing of 1
                << radius << ", q " << q;
        }
    }
}

TEST(EdgeSmoothing, LeavesPixelsAwayFromLinesAsTheyAre) {
    const Scene scene = acetaminophen();
    Settings settings;
    settings.size = {96, 96};
    settings.aovs = {Aov::lines};
    settings.line_width = {4, Length::Unit::px};
    const Film with_lines = draw(scene, settings);
    settings.compose = Compose::shaded;
    settings.aa = AntiAliasing{AntiAliasing::Kind::none, 1};
    const Film plain = draw(scene, settings);
    settings.aa = AntiAliasing{AntiAliasing::Kind::edges, 1};
    const Film smooth = draw(scene, settings);
    int changed = 0;
    for (std::size_t k = 0; k < plain.display().pixels.size(); ++k) {
        if (plain.display().pixels[k] == smooth.display().pixels[k]) continue;
        ++changed;
        EXPECT_GT(plane(with_lines, "line.A")[k], 0.9F);
    }
    EXPECT_GT(changed, 100);
}

// Compositing

TEST(LinesAlone, OnATransparentGroundAreAsOpaqueAsTheirCoverage) {
    const Scene scene(random_objects(5, 60, 40));
    Settings settings;
    settings.size = {90, 70};
    settings.view.view = View::front;
    settings.compose = Compose::lines;
    settings.shading.transparent_background = true;
    settings.line_color = {200, 30, 10};
    settings.aovs = {Aov::lines};
    for (const int q : {1, 2}) {
        settings.lattice = q;
        const Film film = draw(scene, settings);
        for (std::size_t k = 0; k < film.display().pixels.size(); ++k) {
            const std::uint32_t pixel = film.display().pixels[k];
            const float coverage = plane(film, "line.A")[k];
            EXPECT_NEAR(static_cast<float>(pixel >> 24U), 255.0F * coverage, 0.51F);
            if (pixel >> 24U < 4U) continue;
            EXPECT_NEAR(static_cast<int>(pixel & 0xFFU), 200, 1);
            EXPECT_NEAR(static_cast<int>(pixel >> 8U & 0xFFU), 30, 1);
            EXPECT_NEAR(static_cast<int>(pixel >> 16U & 0xFFU), 10, 1);
        }
    }
}

TEST(LinesAlone, AreThoseDrawnOverTheShading) {
    const Scene scene(random_objects(5, 60, 40));
    Settings settings;
    settings.size = {90, 70};
    settings.view.view = View::front;
    settings.aovs = {Aov::lines};
    const Film both = draw(scene, settings);
    settings.compose = Compose::lines;
    const Film alone = draw(scene, settings);
    EXPECT_EQ(plane(both, "line.A"), plane(alone, "line.A"));
    for (std::size_t k = 0; k < alone.display().pixels.size(); ++k) {
        const float expected = 255.0F * (1.0F - plane(alone, "line.A")[k]);
        EXPECT_NEAR(static_cast<float>(alone.display().pixels[k] & 0xFFU), expected, 0.51F);
    }
}

TEST(LineTypes, AreDrawnAsAskedFor) {
    const Scene scene({sphere_object({{{-8, 0, 0}, 12}, {{8, 0, 0}, 12}})});
    Settings settings = plan_view({64, 48});
    const auto ink = [&](std::string_view lines, int x, int y) {
        set(settings, "lines", lines);
        return plane(draw(scene, settings), "line.A")[at({64, 48}, x, y)];
    };
    // The seam is at x = 32, the outline's left end at 12.
    EXPECT_FLOAT_EQ(ink("silhouette", 32, 24), 0.0F);
    EXPECT_FLOAT_EQ(ink("silhouette", 12, 24), 1.0F);
    EXPECT_FLOAT_EQ(ink("intersection", 32, 24), 1.0F);
    EXPECT_FLOAT_EQ(ink("intersection", 12, 24), 0.0F);
    EXPECT_FLOAT_EQ(ink("crease,self-occlusion", 32, 24), 0.0F);
    EXPECT_FLOAT_EQ(ink("crease,self-occlusion", 12, 24), 0.0F);
    EXPECT_FLOAT_EQ(ink("none", 12, 24), 0.0F);
    EXPECT_FLOAT_EQ(ink("all", 32, 24), 1.0F);
    EXPECT_FLOAT_EQ(ink("all", 12, 24), 1.0F);
}

/// A box with sides of 20 that lies in the view of its parallel projection.
Object box() {
    std::vector<Vec3f> corners;
    for (int k = 0; k < 8; ++k) {
        corners.push_back({k & 1 ? 10.0F : -10.0F, k & 2 ? 10.0F : -10.0F, k & 4 ? 10.0F : -10.0F});
    }
    return mesh_object(corners, {{0, 2, 1},
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
}

TEST(Box, HasCreasesAtItsThreeInnerEdgesAndASilhouetteAroundThem) {
    for (const double fov_deg : {0.0, 5.0, 60.0}) {
        Settings settings;
        settings.size = {96, 96};
        settings.view.view = View::iso;
        settings.aovs = {Aov::lines};
        if (fov_deg == 0.0) settings.view.orthographic = 48.0;
        if (fov_deg > 0.0) settings.view.fov_deg = fov_deg;
        settings.line_width = {2, Length::Unit::px};
        for (const int q : {1, 2, 3}) {
            settings.lattice = q;
            const auto total = [&](std::string_view lines) {
                set(settings, "lines", lines);
                double sum = 0.0;
                const Film film = draw(Scene({box()}), settings);
                for (const float alpha : plane(film, "line.A")) sum += alpha;
                return sum;
            };
            EXPECT_EQ(total("self-occlusion"), 0.0) << fov_deg << ", q " << q;
            EXPECT_EQ(total("intersection"), 0.0);
            if (fov_deg > 0.0) continue;
            // Each edge of a cube seen along its diagonal is sqrt(2 / 3) as long.
            const double edge = 20 * std::sqrt(2.0 / 3.0) * 96 / 48;
            EXPECT_NEAR(total("silhouette"), 6 * edge * 2, 6) << "q " << q;
            EXPECT_NEAR(total("crease"), 3 * edge * 2, 6) << "q " << q;
        }
    }
}

// Types and styles

/// Pixels whose line on top is of that type: see LinePlanes.
std::size_t pixels_of(const Film& film, LineType type) {
    for (const Channel& channel : film.channels().channels) {
        if (channel.name != "line.type") continue;
        return static_cast<std::size_t>(
            std::ranges::count(std::get<std::vector<std::uint32_t>>(channel.values),
                               static_cast<std::uint32_t>(type) + 1));
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
    EXPECT_GT(with.crossings, without.crossings + 20);
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
        const auto& ids = std::get<std::vector<std::uint32_t>>(channel.values);
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
