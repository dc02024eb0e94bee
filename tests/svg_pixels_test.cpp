// What an independent renderer, librsvg, makes of our SVGs, beside our own pixels.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "line_art.h"
#include "scenes.h"

namespace ink::test {
namespace {

Object glyph(const UnitShape& shape, Vec3d axis) {
    Object object;
    object.name = "shape";
    Glyphs glyphs;
    glyphs.shape = shape;
    glyphs.placements = {placement_about({}, axis, 1.0)};
    object.shape = std::move(glyphs);
    return object;
}

struct Subject {
    std::string name;
    std::function<std::optional<Scene>()> scene;
};

std::vector<Subject> subjects() {
    const auto file = [](const char* name) { return [name] { return shared_scene(name); }; };
    return {{"acetaminophen", [] { return std::optional(acetaminophen()); }},
            {"box",
             [] {
                 return std::optional(Scene({glyph({GlyphKind::box}, {0.3, 0.5, 1})}));
             }},
            {"torus",
             [] {
                 return std::optional(Scene({glyph({GlyphKind::torus, 0.4}, {0, 0.8, 0.6})}));
             }},
            {"fandisk", file("meshes/fandisk.obj")},
            {"bunny", file("meshes/stanford-bunny.ply")},
            {"4hhb", file("molecules/4hhb.pdb")}};
}

/// Ink on white, row by row.
struct Ink {
    std::vector<float> values;
    int side = 0;

    float at(double x, double y) const {  // bilinear, pixels
        const double u = std::clamp(x - 0.5, 0.0, side - 1.001);
        const double v = std::clamp(y - 0.5, 0.0, side - 1.001);
        const auto i = static_cast<std::size_t>(u);
        const auto j = static_cast<std::size_t>(v);
        const auto a = static_cast<float>(u - std::floor(u));
        const auto b = static_cast<float>(v - std::floor(v));
        const float* p = values.data() + j * static_cast<std::size_t>(side) + i;
        const float upper = p[0] + a * (p[1] - p[0]);
        const float lower = p[side] + a * (p[side + 1] - p[side]);
        return upper + b * (lower - upper);
    }
};

Ink ink_of(const Film& film) {
    Ink ink{{}, film.size().width};
    for (const std::uint32_t pixel : film.display().pixels) {
        ink.values.push_back(1.0F - static_cast<float>(pixel >> 8U & 255U) / 255.0F);
    }
    return ink;
}

Ink ink_of(const LineArt& art, int side) {
    Ink ink{rasterised(svg_of(art), side), side};
    for (float& value : ink.values) value = 1.0F - value;
    return ink;
}

Drawn lines_alone(const Scene& scene, int side = 1024) {
    Settings settings = picture(side);
    settings.compose = Compose::lines;
    return draw(scene, settings, true);
}

double mean_difference(const Ink& a, const Ink& b) {
    if (a.values.size() != b.values.size()) return 1.0;
    double sum = 0.0;
    for (std::size_t k = 0; k < a.values.size(); ++k) {
        sum += static_cast<double>(std::abs(a.values[k] - b.values[k]));
    }
    return sum / static_cast<double>(a.values.size());
}

TEST(Svg, HasTheInkOfThePixels) {
    REQUIRE_RSVG();
    for (const Subject& subject : subjects()) {
        const auto scene = subject.scene();
        if (!scene) continue;
        const Drawn drawn = lines_alone(*scene);
        EXPECT_LT(mean_difference(ink_of(drawn.film), ink_of(drawn.art, 1024)), 0.005)
            << subject.name;
    }
}

/// The middle of the ink across a line: its distance from a point of the line along the normal,
/// pixels.
double middle_across(const Ink& ink, double scale, Vec2d point, Vec2d normal, double reach) {
    constexpr double kStep = 0.0625;
    double sum = 0.0;
    double moment = 0.0;
    for (double s = -reach; s <= reach; s += kStep) {
        const Vec2d at = (point + normal * s) * scale;
        const auto value = static_cast<double>(ink.at(at.x, at.y));
        sum += value;
        moment += value * s;
    }
    return sum > 0.0 ? moment / sum : std::numeric_limits<double>::infinity();
}

/// Points of lines by rows, to find those near a place.
class Neighbours {
  public:
    explicit Neighbours(const LineArt& art) {
        for (std::uint32_t k = 0; k < art.chains.size(); ++k) {
            for (std::uint32_t n = 0; n < art.chains[k].points.size(); ++n) {
                points_.push_back({art.chains[k].points[n], k, n});
            }
        }
        std::ranges::sort(points_, {}, [](const Point& p) { return p.at.y; });
    }
    /// Whether there is a line within a distance that is not a stretch about point n of chain k.
    bool others_near(const LineArt& art, std::uint32_t k, std::uint32_t n, float distance) const {
        const Vec2f at = art.chains[k].points[n];
        auto p = std::ranges::lower_bound(points_, at.y - distance, {},
                                          [](const Point& point) { return point.at.y; });
        for (; p != points_.end() && p->at.y <= at.y + distance; ++p) {
            if (length(p->at - at) > distance) continue;
            const auto count = static_cast<std::uint32_t>(art.chains[k].points.size());
            const std::uint32_t apart = p->n > n ? p->n - n : n - p->n;
            const std::uint32_t along =
                art.chains[k].closed ? std::min(apart, count - apart) : apart;
            if (p->chain != k || static_cast<float>(along) > 3.0F * distance) return true;
        }
        return false;
    }

  private:
    struct Point {
        Vec2f at;
        std::uint32_t chain, n;
    };
    std::vector<Point> points_;
};

Vec2d normal_at(const Chain& chain, std::uint32_t n) {
    const Vec2d along = to_double(chain.points[n + 2]) - to_double(chain.points[n - 2]);
    return Vec2d{-along.y, along.x} * (1.0 / length(along));
}

/// Whether a line bends by half a right angle about one of its points.
bool turns(const Chain& chain, std::uint32_t n, std::uint32_t reach) {
    const Vec2f before = chain.points[n] - chain.points[n - reach];
    const Vec2f after = chain.points[n + reach] - chain.points[n];
    return dot(before, after) < 0.7F * length(before) * length(after);
}

TEST(Svg, DisplacesNoLineByMoreThanATenthOfAPixel) {
    REQUIRE_RSVG();
    constexpr int kSide = 1024;
    constexpr double kWidthPx = 3.0;
    // librsvg itself flattens curves within a tenth of a pixel of its picture.
    constexpr int kScale = 4;
    for (const Subject& subject : subjects()) {
        const auto scene = subject.scene();
        if (!scene) continue;
        const Drawn drawn = lines_alone(*scene, kSide);
        const Ink pixels = ink_of(drawn.film);
        const Ink curves = ink_of(drawn.art, kScale * kSide);
        const Neighbours neighbours(drawn.art);
        constexpr double reach = 0.5 * kWidthPx + 1.5;
        const auto clear = static_cast<std::uint32_t>(std::ceil(2.0 * reach));
        std::size_t places = 0;
        for (std::uint32_t k = 0; k < drawn.art.chains.size(); ++k) {
            const Chain& chain = drawn.art.chains[k];
            for (std::uint32_t n = clear; n + clear < chain.points.size(); n += 2) {
                const Vec2d at = to_double(chain.points[n]);
                const bool inside = std::min(at.x, at.y) > 10 && std::max(at.x, at.y) < kSide - 10;
                if (!inside || chain.strengths[n] < 0.9F) continue;
                if (neighbours.others_near(drawn.art, k, n, static_cast<float>(2.0 * reach))) {
                    continue;
                }
                if (turns(chain, n, clear)) continue;  // a corner is sharper as a curve
                ++places;
                // Over a few points, for a ruler finer than the pixels.
                double moved = 0.0;
                for (const std::uint32_t m : {n - 2, n - 1, n, n + 1, n + 2}) {
                    const Vec2d point = to_double(chain.points[m]);
                    const Vec2d normal = normal_at(chain, m);
                    moved += 0.2 * (middle_across(curves, kScale, point, normal, reach) -
                                    middle_across(pixels, 1.0, point, normal, reach));
                }
                EXPECT_LT(std::abs(moved), 0.1) << subject.name << " at " << at.x << ", " << at.y;
            }
        }
        EXPECT_GT(places, 500U) << subject.name;
    }
}

TEST(Svg, ThinsLinesWhereTheyAreDenseAsThePixelsDo) {
    REQUIRE_RSVG();
    // A raster of small balls that grows coarser to one side.
    std::vector<Sphere> balls;
    for (int i = 0; i < 40; ++i) {
        for (int j = 0; j < 30; ++j) {
            const float size = 0.1F + 0.01F * static_cast<float>(i);
            balls.push_back({{0.0125F * static_cast<float>(i * i), size * static_cast<float>(j), 0},
                             0.8F * size});
        }
    }
    const Drawn drawn = lines_alone(Scene({sphere_object(std::move(balls))}), 512);
    const Ink pixels = ink_of(drawn.film);
    const Ink curves = ink_of(drawn.art, 512);
    EXPECT_LT(mean_difference(pixels, curves), 0.01);
    const auto [thinnest, widest] = std::ranges::minmax(
        drawn.art.strokes, {}, [](const Stroke& stroke) { return stroke.width_px; });
    EXPECT_LT(thinnest.width_px, 1.8);
    EXPECT_GT(widest.width_px, 2.9);
}

/// Two planes that meet in a ridge along x, whose angle grows from nothing at x = -1.
Object growing_crease() {
    std::vector<Vec3f> vertices;
    std::vector<Mesh::Triangle> triangles;
    constexpr std::uint32_t kSteps = 64;
    for (std::uint32_t k = 0; k <= kSteps; ++k) {
        const float x = -1.0F + 2.0F * static_cast<float>(k) / kSteps;
        const float drop = 0.15F * (x + 1.0F);
        for (const float y : {-0.6F, 0.0F, 0.6F}) {
            vertices.push_back({x, y, -drop * std::abs(y) / 0.6F});
        }
    }
    for (std::uint32_t k = 0; k < kSteps; ++k) {
        for (const std::uint32_t row : {0U, 1U}) {
            const std::uint32_t a = 3 * k + row;
            triangles.push_back({a, a + 3, a + 1});
            triangles.push_back({a + 3, a + 4, a + 1});
        }
    }
    return mesh_object(std::move(vertices), std::move(triangles));
}

TEST(Svg, FadesACreaseWhereItFlattens) {
    REQUIRE_RSVG();
    Settings settings = picture(400);
    settings.compose = Compose::lines;
    settings.lines = {};
    settings.lines.add(LineType::crease);
    settings.view.view = View::front;
    settings.shading.normals = NormalSource::geometric;
    const Drawn drawn = draw(Scene({growing_crease()}), settings, true);
    const Ink pixels = ink_of(drawn.film);
    const Ink curves = ink_of(drawn.art, 400);
    std::vector<float> across;
    for (int x = 40; x < 360; x += 8) {
        float difference = 0.0F;
        float ink = 0.0F;
        for (int y = 150; y < 250; ++y) {
            const auto k = static_cast<std::size_t>(y) * 400 + static_cast<std::size_t>(x);
            difference += std::abs(pixels.values[k] - curves.values[k]);
            ink += curves.values[k];
        }
        EXPECT_LT(difference, 0.3F) << x;
        across.push_back(ink);
    }
    EXPECT_LT(across.front(), 0.1F);
    EXPECT_GT(across.back(), 2.5F);
    EXPECT_TRUE(std::ranges::any_of(across, [](float ink) { return ink > 0.8F && ink < 2.2F; }));
}

TEST(Svg, DrawsTranslucentLinesOfOneInkWithoutDarkSpotsWhereTheyMeet) {
    REQUIRE_RSVG();
    Settings settings = picture(512);
    settings.compose = Compose::lines;
    settings.line_rules = read_line_rules("all:opacity=0.5");
    const Drawn drawn = draw(acetaminophen(), settings, true);
    const Ink curves = ink_of(drawn.art, 512);
    EXPECT_LT(std::ranges::max(curves.values), 0.51F);
    EXPECT_GT(std::ranges::max(curves.values), 0.49F);
    EXPECT_LT(mean_difference(ink_of(drawn.film), curves), 0.003);
}

/// Draws regions alone in colours of their own, so that any two that are neighbours differ from
/// each other, on paper of a third colour, and counts pixels of the picture that show the paper.
void expect_no_gaps(Fill fill) {
    constexpr int kSide = 256;
    Settings settings = picture(kSide);
    settings.fill = fill;
    settings.shading.transparent_background = true;
    Drawn drawn = draw(acetaminophen(), settings);
    drawn.art.strokes.clear();
    std::uint8_t next = 0;
    for (Region& region : drawn.art.regions) {
        next = static_cast<std::uint8_t>(next + 37);
        region.color = {next, 0, static_cast<std::uint8_t>(255 - next)};  // no green, as paper has
    }
    constexpr int kScale = 4;
    const std::vector<float> green = rasterised(svg_of(drawn.art), kSide * kScale);
    ASSERT_EQ(green.size(), 256U * kScale * 256U * kScale);
    const auto& pixels = drawn.film.display().pixels;
    const auto inside = [&](int x, int y) {
        for (int k = 0; k < 9; ++k) {
            const int at = (y + k / 3 - 1) * kSide + x + k % 3 - 1;
            if (pixels[static_cast<std::size_t>(at)] >> 24U != 255U) return false;
        }
        return true;
    };
    int checked = 0;
    for (int y = kScale; y < (kSide - 1) * kScale; ++y) {
        for (int x = kScale; x < (kSide - 1) * kScale; ++x) {
            if (!inside(x / kScale, y / kScale)) continue;
            ++checked;
            ASSERT_LT(green[static_cast<std::size_t>(y * kSide * kScale + x)], 0.01F)
                << x << ", " << y;
        }
    }
    EXPECT_GT(checked, 100000);
}

TEST(Regions, LeaveNoGapsBetweenNeighbours) {
    REQUIRE_RSVG();
    expect_no_gaps(Fill::flat);
    expect_no_gaps(Fill::two_tone);
}

}  // namespace
}  // namespace ink::test
