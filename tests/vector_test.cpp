// Lines as curves: from scenes to SVG, PDF and JSON.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "line_art.h"
#include "scenes.h"
#include "test_files.h"
#include "vector/lines_json.h"
#include "vector/pdf_writer.h"
#include "vector/xml_text.h"

namespace ink::test {
namespace {

/// Ends of the chains that meet at each vertex.
std::map<std::uint32_t, int> degrees(const std::vector<Chain>& chains) {
    std::map<std::uint32_t, int> degrees;
    for (const Chain& chain : chains) {
        if (chain.closed) continue;
        ++degrees[chain.first_vertex];
        ++degrees[chain.last_vertex];
    }
    return degrees;
}

double total_length(const std::vector<Chain>& chains) {
    double sum = 0.0;
    for (const Chain& chain : chains) sum += length_of(chain);
    return sum;
}

TEST(LineArt, OutlinesOfAMoleculeCloseOrEndAtJunctions) {
    const LineArt art = draw(acetaminophen(), picture(1024)).art;
    const auto ends = degrees(art.chains);
    ASSERT_GT(art.chains.size(), 30U);
    for (const Chain& chain : art.chains) {
        if (chain.closed) continue;
        for (const std::uint32_t vertex : {chain.first_vertex, chain.last_vertex}) {
            EXPECT_GE(ends.at(vertex), 2) << "a line that ends in the open";
        }
    }
}

TEST(LineArt, CurvesMeetExactlyWhereTheirChainsDo) {
    const LineArt art = draw(acetaminophen(), picture()).art;
    std::map<std::uint32_t, Vec2f> places;
    for (std::size_t k = 0; k < art.chains.size(); ++k) {
        if (art.chains[k].closed) continue;
        const auto [first, is_new] =
            places.emplace(art.chains[k].first_vertex, art.curves[k].start);
        EXPECT_EQ(first->second, art.curves[k].start);
        const Vec2f end = art.curves[k].pieces.back().end;
        EXPECT_EQ(places.emplace(art.chains[k].last_vertex, end).first->second, end);
    }
}

TEST(LineArt, ASphereIsOneClosedChainOfAtMostSixNodes) {
    const LineArt art = draw(Scene({sphere_object({{{0, 0, 0}, 1.0F}})}), picture(1024)).art;
    ASSERT_EQ(art.chains.size(), 1U);
    EXPECT_TRUE(art.chains[0].closed);
    EXPECT_LE(art.curves[0].pieces.size(), 6U);
    EXPECT_EQ(front(art.chains[0]), 1U);
    EXPECT_EQ(behind(art.chains[0]), kBackground);
}

Object glyphs(const UnitShape& shape, std::vector<Placement> placements) {
    Object object;
    object.name = "shapes";
    object.kind = ObjectKind::shape;
    object.shape = Glyphs{shape, std::move(placements), {}, {}};
    return object;
}

/// Scenes without edges.
std::vector<std::pair<std::string, Scene>> smooth_scenes() {
    const Placement tilted{{1.0F, 0.1F, 0.2F}, {-0.2F, 0.5F, 0.1F}, {0.1F, -0.2F, 0.8F}, {}};
    const Placement nearer{
        {0.3F, 0.1F, 0}, {-0.2F, 0.9F, 0.1F}, {0, -0.1F, 0.4F}, {0.6F, 0.4F, 0.5F}};
    const Vec3d axis{0, 0.8, 0.6};
    std::vector<std::pair<std::string, Scene>> scenes;
    const auto add = [&](const char* name, std::vector<Object> objects) {
        scenes.emplace_back(name, Scene(std::move(objects)));
    };
    add("torus", {glyphs({GlyphKind::torus, 0.4}, {placement_about({}, axis, 1.0)})});
    add("two tori",
        {glyphs({GlyphKind::torus, 0.3},
                {placement_about({}, axis, 1.0), placement_about({1, 0, 0}, {1, 0.3, 0.2}, 0.9)})});
    add("overlapping spheres", {sphere_object({{{0, 0, 0}, 1.0F},
                                               {{1.2F, 0.3F, 0.4F}, 0.8F},
                                               {{-0.7F, 0.8F, 0.9F}, 0.6F},
                                               {{0.5F, -1.0F, 0.4F}, 0.5F}})});
    add("ellipsoids", {glyphs({GlyphKind::ellipsoid}, {tilted, nearer})});
    add("superellipsoids", {glyphs({GlyphKind::superellipsoid, 0.5, 0.3}, {tilted, nearer})});
    scenes.emplace_back("acetaminophen", acetaminophen());
    if (auto crambin = shared_scene("molecules/1crn.pdb")) {
        scenes.emplace_back("1crn", std::move(*crambin));
    }
    return scenes;
}

TEST(LineArt, OfSmoothScenesHardlyChangesWithTheLattice) {
    Settings settings = picture(512);
    settings.fill = Fill::none;
    for (const auto& [name, scene] : smooth_scenes()) {
        settings.lattice = 1;
        const LineArt coarse = draw(scene, settings).art;
        settings.lattice = 3;
        const LineArt fine = draw(scene, settings).art;
        const double count = static_cast<double>(coarse.chains.size());
        EXPECT_NEAR(static_cast<double>(fine.chains.size()) / count, 1.0, 0.02) << name;
        EXPECT_NEAR(total_length(fine.chains) / total_length(coarse.chains), 1.0, 0.02) << name;
    }
}

TEST(LineArt, OfManySpheresHardlyChangesWithTheLattice) {
    // Much of what is seen of them is smaller than a pixel: a finer lattice comes upon more of it.
    std::vector<std::pair<std::string, Scene>> scenes;
    for (unsigned seed = 0; seed < 4; ++seed) {
        std::mt19937 random(seed);
        const auto uniform = [&](float from, float to) {
            return from + (to - from) * static_cast<float>(random() >> 8U) * 0x1p-24F;
        };
        std::vector<Sphere> spheres;
        for (int k = 0; k < 150; ++k) {
            const float x = uniform(-5, 5);
            const float y = uniform(-5, 5);
            const float z = uniform(-5, 5);
            spheres.push_back({{x, y, z}, uniform(0.4F, 1.0F)});
        }
        scenes.emplace_back("seed " + std::to_string(seed), Scene({sphere_object(spheres)}));
    }
    if (auto haemoglobin = shared_scene("molecules/4hhb.pdb")) {
        scenes.emplace_back("4hhb", std::move(*haemoglobin));
    }
    for (const auto& [name, scene] : scenes) {
        Settings settings = picture(name == "4hhb" ? 1024 : 512);
        settings.fill = Fill::none;
        const LineArt coarse = draw(scene, settings).art;
        settings.lattice = 3;
        const LineArt fine = draw(scene, settings).art;
        const auto count = static_cast<double>(coarse.chains.size());
        EXPECT_NEAR(static_cast<double>(fine.chains.size()) / count, 1.0, 0.02)
            << name << ": " << coarse.chains.size() << " and " << fine.chains.size();
        EXPECT_NEAR(total_length(fine.chains) / total_length(coarse.chains), 1.0, 0.02) << name;
    }
}

TEST(LineArt, HasNoPinholesWhereTheHoleOfATorusCloses) {
    Settings settings = picture(512);
    settings.fill = Fill::none;
    settings.view.look_at = Vec3d{0, 0, 0};
    const auto counts = [&](Vec3d axis, double radius, double tube, Vec3d eye) {
        const Scene scene({glyphs({GlyphKind::torus, static_cast<float>(tube / radius)},
                                  {placement_about({}, axis, radius)})});
        settings.view.eye = eye;
        std::vector<std::size_t> found;
        for (const int lattice : {1, 3}) {
            settings.lattice = lattice;
            found.push_back(draw(scene, settings).art.chains.size());
        }
        return found;
    };
    const auto first = counts({0.72754, -0.659394, 0.189434}, 0.676524, 0.247692,
                              {-0.100538, 3.212086, -7.326144});
    EXPECT_EQ(first[0], first[1]);
    const auto second =
        counts({0.965511, 0.188308, 0.17980}, 0.893427, 0.267552, {-2.845025, 5.958366, -4.517046});
    EXPECT_EQ(second[0], second[1]);
}

TEST(LineArt, EndsOutsideThePictureInOnePlaceForEveryOddLattice) {
    // A circle that reaches 3.7 pixels beyond the picture on each of its sides.
    Settings settings = picture(64);
    settings.fill = Fill::none;
    settings.view.view = View::front;
    settings.view.eye = Vec3d{0, 0, 100};
    settings.view.look_at = Vec3d{0, 0, 0};
    settings.view.orthographic = 10.0;
    const Scene scene({sphere_object({{{0, 0, 0}, 35.7F * 10.0F / 64.0F}})});
    for (const int lattice : {1, 3}) {
        settings.lattice = lattice;
        const LineArt art = draw(scene, settings).art;
        EXPECT_EQ(art.chains.size(), 4U) << lattice;
        for (const Chain& chain : art.chains) {
            for (const Vec2f end : {chain.points.front(), chain.points.back()}) {
                EXPECT_NEAR(
                    static_cast<double>(std::max(std::abs(end.x - 32), std::abs(end.y - 32))), 35.5,
                    1e-3);
            }
        }
    }
}

TEST(LineArt, OfABoxIsSplitAtTheCornersOfItsOutline) {
    // Three faces show: three creases, and six sides of the outline, three of whose corners are no
    // junctions.
    Settings settings = picture(512);
    settings.view.view = View::iso;
    const LineArt art = draw(Scene({glyphs({GlyphKind::box}, {{}})}), settings).art;
    const auto ends = degrees(art.chains);
    EXPECT_EQ(art.chains.size(), 9U);
    EXPECT_EQ(ends.size(), 7U);
    for (const Curve& curve : art.curves) EXPECT_EQ(curve.pieces.size(), 1U);
}

TEST(LineArt, KnowsNamesDepthsAndTheNearerSide) {
    const LineArt art = draw(acetaminophen(), picture()).art;
    std::set<std::string> elements;
    for (const Chain& chain : art.chains) {
        elements.insert(art.names(front(chain)).element);
        EXPECT_EQ(art.names(front(chain)).object, art.title);
        ASSERT_EQ(chain.t.size(), chain.points.size());
        for (const float t : chain.t) EXPECT_TRUE(t > 1.0F && t < 1000.0F);
        if (chain.left == kBackground || chain.right == kBackground) {
            EXPECT_NE(front(chain), kBackground);
        }
    }
    EXPECT_EQ(elements, (std::set<std::string>{"C", "H", "N", "O"}));
}

TEST(LineArt, LeavesOutWhatIsShorterThanAsked) {
    Settings settings = picture();
    const std::size_t all = draw(acetaminophen(), settings).art.chains.size();
    settings.min_length = {40.0, Length::Unit::px};
    const LineArt art = draw(acetaminophen(), settings).art;
    EXPECT_LT(art.chains.size(), all);
    for (const Chain& chain : art.chains) EXPECT_GE(length_of(chain), 40.0);
}

TEST(Regions, ShareTheCurvesOfTheLinesAroundThem) {
    const LineArt art = draw(acetaminophen(), picture()).art;
    using Corner = std::pair<float, float>;
    std::map<GeometryId, std::set<Corner>> nodes;
    for (const Region& region : art.regions) {
        for (const Curve& outline : region.outlines) {
            EXPECT_EQ(outline.start, outline.pieces.back().end);
            for (const CurvePiece& piece : outline.pieces) {
                nodes[region.id].insert({piece.end.x, piece.end.y});
            }
        }
    }
    for (std::size_t k = 0; k < art.chains.size(); ++k) {
        for (const GeometryId id : {art.chains[k].left, art.chains[k].right}) {
            if (id == kBackground) continue;
            for (const CurvePiece& piece : art.curves[k].pieces) {
                EXPECT_TRUE(nodes[id].contains({piece.end.x, piece.end.y}) ||
                            piece.end == art.curves[k].pieces.back().end);
            }
        }
    }
}

TEST(Regions, HaveTheirOwnColorAndNoneOfWhatLiesAround) {
    Settings settings = picture(48);
    settings.shading.mode = ShadeMode::flat;
    settings.shading.background = {255, 0, 255};
    Object ball = sphere_object({{{0, 0, 0}, 1.0F}});
    ball.material.color = {250, 20, 20};
    const LineArt art = draw(Scene({ball}), settings).art;
    ASSERT_EQ(art.regions.size(), 1U);
    EXPECT_EQ(art.regions[0].color, ball.material.color);
}

TEST(Regions, GoOnAlongTheBorderOfThePicture) {
    // A sphere much larger than the picture, and a small one in front of it.
    Settings settings = picture(64);
    settings.view.view = View::front;
    settings.view.eye = Vec3d{0, 0, 100};
    settings.view.look_at = Vec3d{0, 0, 0};
    settings.view.orthographic = 10.0;
    const Scene scene(
        {sphere_object({{{-20, 0, 0}, 21.0F}, {{2, 2, 5}, 1.0F}, {{-2, 2, 40}, 1.0F}})});
    const LineArt art = draw(scene, settings).art;
    ASSERT_EQ(art.regions.size(), 3U);
    // By the shoelace formula: all that is left of about the middle, without the small sphere.
    double area = 0.0;
    for (const Curve& outline : art.regions[0].outlines) {
        Vec2f at = outline.start;
        for (const CurvePiece& piece : outline.pieces) {
            for (const Vec2f next : {piece.control1, piece.control2, piece.end}) {
                area -= 0.5 * static_cast<double>(cross(at, next));
                at = next;
            }
        }
    }
    EXPECT_GT(area, 0.5 * 64 * 64);
    EXPECT_LT(area, 0.9 * 80 * 80);
}

TEST(Files, AreTheSameForAnyThreadsAndTiles) {
    const Scene scene = acetaminophen();
    Settings settings = picture(300);
    const TemporaryFolder folder;
    std::vector<std::string> expected;
    for (const int variant : {0, 1, 2}) {
        settings.threads = variant == 1 ? 5 : 1;
        settings.tile = variant == 2 ? 20 : 64;
        const LineArt art = draw(scene, settings).art;
        write_svg(folder.path() / "x.svg", art);
        write_pdf(folder.path() / "x.pdf", art);
        write_lines_json(folder.path() / "x.json", art);
        std::vector<std::string> files;
        for (const char* name : {"x.svg", "x.pdf", "x.json"}) {
            files.push_back(read_bytes(folder.path() / name));
            EXPECT_GT(files.back().size(), 1000U);
        }
        if (variant == 0) expected = files;
        EXPECT_EQ(files, expected);
    }
}

TEST(Svg, OfASmallMoleculeIsSmall) {
    EXPECT_LT(svg_of(draw(acetaminophen(), picture(1024)).art).size(), 60000U);
}

TEST(Svg, HasItsSizeOnPaperAndALayerForEachType) {
    Settings settings = picture(600);
    settings.dpi = 300.0;
    const std::string text = svg_of(draw(acetaminophen(), settings).art);
    EXPECT_NE(text.find("width=\"50.8000mm\" height=\"50.8000mm\" viewBox=\"0 0 600 600\""),
              std::string::npos);
    EXPECT_NE(text.find("<g id=\"silhouette\""), std::string::npos);
    EXPECT_NE(text.find("<g id=\"intersection\""), std::string::npos);
    EXPECT_NE(text.find("data-element=\"N\""), std::string::npos);
}

TEST(Svg, CanCarryTheShadedPictureWithoutLines) {
    Settings settings = picture(64);
    settings.fill = Fill::image;
    const std::string text = svg_of(draw(acetaminophen(), settings).art);
    EXPECT_NE(text.find("<image"), std::string::npos);
    EXPECT_NE(text.find("data:image/png;base64,iVBORw0KGgo"), std::string::npos);
    EXPECT_EQ(text.find("id=\"regions\""), std::string::npos);
    settings.compose = Compose::lines;
    EXPECT_EQ(svg_of(draw(acetaminophen(), settings).art).find("<image"), std::string::npos);
}

/// Two halves of a stick, of a red and a blue atom, that count as one.
std::vector<Object> stick_of_two_colors() {
    Object stick;
    stick.name = "stick";
    stick.kind = ObjectKind::molecule;
    Glyphs halves;
    halves.shape = {.kind = GlyphKind::frustum, .capped = false};
    halves.placements = {placement_between({-2, 0, 0}, {0, 0, 0}, 0.5),
                         placement_between({0, 0, 0}, {2, 0, 0}, 0.5)};
    halves.colors = {{255, 0, 0}, {0, 0, 255}};
    stick.shape = std::move(halves);
    stick.usual_ids = IdLevel::object;
    return {std::move(stick)};
}

TEST(Svg, ShowsAGeometryOfSeveralColoursAsItsShadedPicture) {
    const auto regions_and_image = [](std::vector<Object> objects, Settings settings) {
        const LineArt art = draw(Scene(std::move(objects)), settings).art;
        return std::pair(!art.regions.empty(), art.image.has_value());
    };
    Settings settings = picture(64);
    EXPECT_EQ(regions_and_image(stick_of_two_colors(), settings), std::pair(false, true));
    settings.ids = IdLevel::primitive;
    EXPECT_EQ(regions_and_image(stick_of_two_colors(), settings), std::pair(true, false));
    settings.ids.reset();
    settings.fill = Fill::flat;
    EXPECT_EQ(regions_and_image(stick_of_two_colors(), settings), std::pair(true, false));
}

TEST(Json, HoldsThePolylines) {
    const LineArt art = draw(acetaminophen(), picture(128)).art;
    const TemporaryFolder folder;
    write_lines_json(folder.path() / "x.json", art);
    const auto json = nlohmann::json::parse(read_bytes(folder.path() / "x.json"));
    EXPECT_EQ(json["width"], 128);
    ASSERT_EQ(json["lines"].size(), art.chains.size());
    for (std::size_t k = 0; k < art.chains.size(); ++k) {
        const auto& line = json["lines"][k];
        const Chain& chain = art.chains[k];
        EXPECT_EQ(line["type"], name_of(chain.type));
        ASSERT_EQ(line["points"].size(), chain.points.size());
        EXPECT_NEAR(line["points"][0][0].get<double>(), double{chain.points[0].x}, 1e-3);
        EXPECT_NEAR(line["points"][0][2].get<double>(), double{chain.t[0]}, 1e-4);
        const GeometryId id = front(chain);
        EXPECT_EQ(json["geometries"][std::to_string(id)]["element"], art.names(id).element);
    }
}

// Names

const std::string kWildName =
    "<&\"'>\x01\x1B caf\xC3\xA9 \xF0\x9F\xA7\xAA \xFF\xC3( \xED\xA0\x80 ]]>";

TEST(XmlText, EscapesWhatHasAMeaningAndReplacesWhatMayNotBeThere) {
    EXPECT_EQ(xml_text("a<b>&\"'"), "a&lt;b&gt;&amp;&quot;&#39;");
    EXPECT_EQ(xml_text("caf\xC3\xA9"), "caf\xC3\xA9");
    const std::string bad = "\xEF\xBF\xBD";
    EXPECT_EQ(xml_text(std::string_view("\0x", 2)), bad + "x");
    EXPECT_EQ(xml_text("\x1F"), bad);
    EXPECT_EQ(xml_text("\xC3"), bad);            // cut off
    EXPECT_EQ(xml_text("\xC0\xAF"), bad + bad);  // overlong
    EXPECT_EQ(xml_text("\xED\xA0\x80"), bad);    // surrogate
    EXPECT_EQ(xml_text("\xEF\xBF\xBE"), bad);    // non-character
    EXPECT_EQ(xml_text("\n"), "&#10;");
    EXPECT_EQ(class_name("o-", "a b<c>"), "o-a-b-c");
}

Scene with_wild_name() {
    std::vector<Object> objects{sphere_object({{{0, 0, 0}, 1.0F}, {{1, 0, 0}, 0.7F}})};
    objects[0].name = kWildName;
    return Scene(std::move(objects));
}

TEST(Svg, IsWellFormedForAnyName) {
    REQUIRE_RSVG();
    const LineArt art = draw(with_wild_name(), picture(64)).art;
    EXPECT_FALSE(rasterised(svg_of(art), 64).empty());
    const TemporaryFolder folder;
    write_pdf(folder.path() / "x.pdf", art);
    write_lines_json(folder.path() / "x.json", art);
    EXPECT_TRUE(nlohmann::json::accept(read_bytes(folder.path() / "x.json")));
}

}  // namespace
}  // namespace ink::test
