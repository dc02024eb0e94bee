// Light and shade as regions of their own.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "line_art.h"
#include "scenes.h"

namespace ink::test {
namespace {

Settings two_tone(int side = 512) {
    Settings settings = picture(side);
    settings.fill = Fill::two_tone;
    return settings;
}

/// Parallel light from the viewer's right, `angle` off the direction of sight, and nothing else.
Settings lit_from_the_right(double angle) {
    Settings settings = two_tone();
    settings.view.view = View::front;
    settings.view.orthographic = 2.5;
    LightRule light;
    light.kind = LightRule::Kind::camera;
    light.from = {std::sin(angle), 0.0, std::cos(angle)};
    settings.shading.lights = {light};
    return settings;
}

/// Of a region, by the shoelace formula.
double area(const Region& region) {
    double sum = 0.0;
    for (const Curve& outline : region.outlines) {
        Vec2d at = to_double(outline.start);
        Vec2f start = outline.start;
        for (const CurvePiece& piece : outline.pieces) {
            for (int k = 1; k <= 32; ++k) {
                const Vec2d next = point_at(start, piece, k / 32.0);
                sum -= 0.5 * cross(at, next);
                at = next;
            }
            start = piece.end;
        }
    }
    return sum;
}

Scene ball() { return Scene({sphere_object({{{0, 0, 0}, 1.0F}})}); }

TEST(Tones, OfABallPartWhereLightFallsAtSixtyDegrees) {
    // Half of the full light: the circle n . l = 1/2 on the sphere, in orthographic projection the
    // half of an ellipse about l / 2, with half axes sqrt(3/4) and that times cos(angle).
    for (const double angle : {0.4, 0.9}) {
        const LineArt art = draw(ball(), lit_from_the_right(angle)).art;
        ASSERT_EQ(art.regions.size(), 2U);
        const double radius = 512 / 2.5;
        const double half = std::sqrt(0.75) * radius;
        double worst = 0.0;
        std::size_t on_border = 0;
        for (const Region& region : art.regions) {
            for (const Curve& outline : region.outlines) {
                Vec2f start = outline.start;
                for (const CurvePiece& piece : outline.pieces) {
                    for (int k = 0; k < 8; ++k) {
                        const Vec2d p = point_at(start, piece, k / 8.0) - Vec2d{256, 256};
                        if (length(p) > radius - 1.0) continue;  // the ball's own outline
                        const double u =
                            (p.x - 0.5 * radius * std::sin(angle)) / (half * std::cos(angle));
                        const double off = std::hypot(u, p.y / half) - 1.0;
                        worst = std::max(worst, std::abs(off) * half * std::cos(angle));
                        ++on_border;
                    }
                    start = piece.end;
                }
            }
        }
        EXPECT_GT(on_border, 20U);
        EXPECT_LT(worst, 0.15) << angle;
    }
}

TEST(Tones, AreTwoRegionsThatMakeUpTheWhole) {
    for (const double angle : {0.4, 0.9, 1.4}) {
        const LineArt art = draw(ball(), lit_from_the_right(angle)).art;
        ASSERT_EQ(art.regions.size(), 2U);
        EXPECT_EQ(art.regions[0].id, art.regions[1].id);
        EXPECT_EQ(art.regions[0].tone, Region::Tone::light);
        EXPECT_EQ(art.regions[1].tone, Region::Tone::shade);
        EXPECT_GT(art.regions[0].color.g, art.regions[1].color.g);
        const double radius = 512 / 2.5;
        EXPECT_NEAR(area(art.regions[0]) + area(art.regions[1]), std::numbers::pi * radius * radius,
                    60.0);
    }
}

TEST(Tones, MeetInTheSameCurvesAsEachOtherAndTheLines) {
    const LineArt art = draw(acetaminophen(), two_tone()).art;
    // Each curve between two regions is in both; one beside the background, in one.
    using Piece = std::array<float, 8>;
    std::map<Piece, int> uses;
    for (const Region& region : art.regions) {
        for (const Curve& outline : region.outlines) {
            Vec2f start = outline.start;
            for (const CurvePiece& p : outline.pieces) {
                const Piece way{start.x,      start.y,      p.control1.x, p.control1.y,
                                p.control2.x, p.control2.y, p.end.x,      p.end.y};
                const Piece back{p.end.x,      p.end.y,      p.control2.x, p.control2.y,
                                 p.control1.x, p.control1.y, start.x,      start.y};
                ++uses[std::min(way, back)];
                start = p.end;
            }
        }
    }
    for (const auto& [piece, count] : uses) EXPECT_LE(count, 2);
    int checked = 0;
    for (std::size_t k = 0; k < art.chains.size(); ++k) {
        const bool outer = art.chains[k].left == kBackground || art.chains[k].right == kBackground;
        Vec2f start = art.curves[k].start;
        for (const CurvePiece& p : art.curves[k].pieces) {
            const Piece way{start.x,      start.y,      p.control1.x, p.control1.y,
                            p.control2.x, p.control2.y, p.end.x,      p.end.y};
            const Piece back{p.end.x,      p.end.y,      p.control2.x, p.control2.y,
                             p.control1.x, p.control1.y, start.x,      start.y};
            const auto found = uses.find(std::min(way, back));
            ASSERT_NE(found, uses.end());
            EXPECT_EQ(found->second, outer ? 1 : 2);
            start = p.end;
            ++checked;
        }
    }
    EXPECT_GT(checked, 100);
}

TEST(Tones, OfABoxPartAtItsEdges) {
    Object box;
    box.name = "box";
    Glyphs glyphs;
    glyphs.shape = {GlyphKind::box};
    glyphs.placements = {placement_about({}, {0.3, 0.5, 1}, 1.0)};
    box.shape = std::move(glyphs);
    const LineArt art = draw(Scene({box}), two_tone()).art;
    ASSERT_EQ(art.regions.size(), 2U);
    // All that divides them is a crease: nothing but lines is within.
    std::set<std::pair<float, float>> nodes;
    for (const Curve& curve : art.curves) {
        nodes.insert({curve.start.x, curve.start.y});
        for (const CurvePiece& piece : curve.pieces) nodes.insert({piece.end.x, piece.end.y});
    }
    for (const Region& region : art.regions) {
        for (const Curve& outline : region.outlines) {
            for (const CurvePiece& piece : outline.pieces) {
                EXPECT_TRUE(nodes.contains({piece.end.x, piece.end.y}));
            }
        }
    }
}

TEST(Tones, LeaveTheLinesWhereTheyAre) {
    const auto length_by_type = [](const LineArt& art) {
        std::map<LineType, double> lengths;
        for (const Chain& chain : art.chains) lengths[chain.type] += length_of(chain);
        return lengths;
    };
    Settings settings = two_tone();
    settings.shading.ambient = 0.0F;  // light with smooth borders: few of them end on lines
    const LineArt with_tones = draw(acetaminophen(), settings).art;
    const auto toned = length_by_type(with_tones);
    settings.fill = Fill::flat;
    const LineArt without = draw(acetaminophen(), settings).art;
    const auto flat = length_by_type(without);
    ASSERT_EQ(toned.size(), flat.size());
    for (const auto& [type, length] : flat) EXPECT_NEAR(toned.at(type), length, 0.01 * length);
    // Where borders of tones end on lines, most of them are one again.
    EXPECT_LE(with_tones.chains.size(), without.chains.size() + without.chains.size() / 5);
}

TEST(Tones, AreTheSameForAnyThreadsAndTiles) {
    const Scene scene = acetaminophen();
    Settings settings = two_tone(300);
    std::string expected;
    for (const int variant : {0, 1, 2}) {
        settings.threads = variant == 1 ? 5 : 1;
        settings.tile = variant == 2 ? 20 : 64;
        const std::string svg = svg_of(draw(scene, settings).art);
        if (variant == 0) expected = svg;
        EXPECT_EQ(svg, expected);
    }
    EXPECT_NE(expected.find("data-tone=\"shade\""), std::string::npos);
}

}  // namespace
}  // namespace ink::test
