#include "scene/representation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "base/error.h"
#include "scene/bonds.h"
#include "scene/colormap.h"
#include "scene/elements.h"
#include "scene/selection.h"

namespace ink {
namespace {

/// Alanine and glycine in chain A, a water and a zinc ion in chain B.
Molecule small_complex() {
    Molecule m;
    m.chains = {"A", "B"};
    m.asyms = m.chains;
    m.entities = {"protein", "HOH", "ZN"};
    m.residue_table = {{"ALA", 1, 0, 0, 0, ResidueKind::protein},
                       {"GLY", 2, 0, 0, 0, ResidueKind::protein},
                       {"HOH", 7, 1, 1, 1, ResidueKind::water},
                       {"ZN", 8, 1, 1, 2, ResidueKind::ion}};
    const auto add = [&](std::uint32_t residue, const char* name, std::uint8_t element, float b) {
        m.positions.push_back({static_cast<double>(m.positions.size()), 0, 0});
        m.elements.push_back(element);
        m.atom_names.push_back(atom_name(name));
        m.residues.push_back(residue);
        if (m.fields.empty()) m.fields.push_back({"bfactor", 1, {}});
        m.fields[0].values.push_back(b);
    };
    add(0, "N", 7, 10);
    add(0, "CA", 6, 20);
    add(0, "CB", 6, 30);
    add(1, "CA", 6, 40);
    add(1, "HA", 1, 50);
    add(2, "O", 8, 60);
    add(3, "ZN", 30, 70);
    return m;
}

/// "1100000": which atoms a text selects.
std::string selected(std::string_view text) {
    std::string out;
    for (const std::uint8_t entry : Selection::parse(text).evaluate(small_complex())) {
        out += entry != 0 ? '1' : '0';
    }
    return out;
}

TEST(Selection, KnowsTheWordsOfPymolAndChimera) {
    EXPECT_EQ(selected("all"), "1111111");
    EXPECT_EQ(selected("protein"), "1111100");
    EXPECT_EQ(selected("water"), "0000010");
    EXPECT_EQ(selected("solvent"), "0000010");
    EXPECT_EQ(selected("ions"), "0000001");
    EXPECT_EQ(selected("hydrogens"), "0000100");
    EXPECT_EQ(selected("backbone"), "1101000");
    EXPECT_EQ(selected("sidechain"), "0010100");
    EXPECT_EQ(selected("chain B"), "0000011");
    EXPECT_EQ(selected("resn ALA+ZN"), "1110001");
    EXPECT_EQ(selected("resi 2-7"), "0001110");
    EXPECT_EQ(selected("name CA"), "0101000");
    EXPECT_EQ(selected("elem C,zn"), "0111001");
    EXPECT_EQ(selected("b >= 50"), "0000111");
    EXPECT_EQ(selected("bfactor<20"), "1000000");
}

TEST(Selection, BindsNotBeforeAndBeforeOr) {
    EXPECT_EQ(selected("not protein and not water"), "0000001");
    EXPECT_EQ(selected("water or protein and name CA"), "0101010");
    EXPECT_EQ(selected("(water or protein) and not (name CA or elem H)"), "1010010");
    EXPECT_EQ(selected("!protein & !water|elem N"), "1000001");
}

TEST(Selection, SaysWhatItDoesNotUnderstand) {
    const auto complaint = [](std::string_view text) -> std::string {
        try {
            Selection::parse(text);
        } catch (const UsageError& error) {
            return error.what();
        }
        return "(none)";
    };
    EXPECT_NE(complaint("protien").find("did you mean protein?"), std::string::npos);
    EXPECT_NE(complaint("chain").find("what follows 'chain' is missing"), std::string::npos);
    EXPECT_NE(complaint("(water").find("closing bracket"), std::string::npos);
    EXPECT_NE(complaint("water)").find("')' was not expected"), std::string::npos);
    EXPECT_NE(complaint("resi x").find("'x' is not a residue number"), std::string::npos);
    EXPECT_NE(complaint("elem Qq").find("'Qq' is not an element"), std::string::npos);
    EXPECT_NE(complaint("bfactor < hot").find("'hot' is not a number"), std::string::npos);
    EXPECT_NE(complaint(std::string(1000, '(')).find("too deeply"), std::string::npos);
    EXPECT_THROW(Selection::parse("speed < 3").evaluate(small_complex()), Error);
}

TEST(Molecules, KeepBondsBetweenTheAtomsThatAreKept) {
    Molecule m = small_complex();
    m.bonds = {{0, 1}, {1, 2}, {3, 4}};
    const Molecule kept = filtered(m, {1, 1, 0, 1, 1, 0, 0});
    EXPECT_EQ(kept.atom_count(), 4U);
    EXPECT_EQ(kept.bonds, (std::vector<Bond>{{0, 1}, {2, 3}}));
    EXPECT_EQ(kept.fields[0].values, (std::vector<float>{10, 20, 40, 50}));
}

const Spheres& spheres(const std::vector<Object>& objects) {
    return std::get<Spheres>(objects.at(0).shape);
}

TEST(Representation, MakesPartsOfAnyLevel) {
    const Molecule m = small_complex();
    using Parts = std::vector<std::uint32_t>;
    EXPECT_EQ(spheres(represent(m, {.parts = "chain"})).parts, (Parts{0, 0, 0, 0, 0, 1, 1}));
    EXPECT_EQ(spheres(represent(m, {.parts = "residue"})).parts, (Parts{0, 0, 0, 1, 1, 2, 3}));
    EXPECT_EQ(spheres(represent(m, {.parts = "entity"})).parts, (Parts{0, 0, 0, 0, 0, 1, 2}));
    EXPECT_EQ(spheres(represent(m, {.parts = "element"})).parts, (Parts{7, 6, 6, 6, 1, 8, 30}));
    EXPECT_EQ(represent(m, {.parts = "residue"})[0].part_names[3], "B/ZN 8");
    EXPECT_THROW(represent(m, {.parts = "shoe"}), Error);
}

TEST(Representation, ColoursByChainWhereAtomsAreMany) {
    Molecule m = small_complex();
    m.units = {{0, m.atom_count(), std::vector<Copy>(1500)}};  // 10,500 atoms
    EXPECT_EQ(spheres(represent(m, {})).colors[0], category_color(0));
    EXPECT_EQ(spheres(represent(m, {.color_by = "element"})).colors[0], element(7).color);
    m.chains.resize(1);
    for (Residue& residue : m.residue_table) residue.chain = 0;
    EXPECT_EQ(spheres(represent(m, {})).colors[0], element(7).color);
}

TEST(Representation, ColoursByHierarchyAndByField) {
    const Molecule m = small_complex();
    const auto colors = [&](const DataSettings& settings) {
        return spheres(represent(m, settings)).colors;
    };
    EXPECT_EQ(colors({})[0], element(7).color);
    EXPECT_EQ(colors({.color_by = "chain"})[6], category_color(1));
    EXPECT_EQ(colors({.color_by = "chain-hetero"})[0], element(7).color);
    EXPECT_EQ(colors({.color_by = "chain-hetero"})[1], category_color(0));
    EXPECT_EQ(colors({.color_by = "red"})[3], (Rgb8{255, 0, 0}));
    EXPECT_TRUE(colors({.color_by = "none"}).empty());
    const ColorMap& viridis = *find_color_map("viridis");
    EXPECT_EQ(colors({.color_by = "bfactor"}).front(), viridis.at(0));
    EXPECT_EQ(colors({.color_by = "bfactor"}).back(), viridis.at(1));
    EXPECT_EQ(colors({.color_by = "bfactor", .color_range = std::pair{20.0, 60.0}})[3],
              (colors({.color_by = "bfactor", .color_range = std::pair{-20.0, 100.0}})[3]));
    EXPECT_EQ(colors({.color_by = "rainbow"})[0], viridis.at(0));
    EXPECT_EQ(colors({.color_by = "rainbow"})[3], viridis.at(1));
    EXPECT_THROW(represent(m, {.color_by = "speed"}), Error);
}

TEST(Representation, TakesRadiiFromATableANumberOrAField) {
    const Molecule m = small_complex();
    const auto radius = [&](const DataSettings& settings) {
        return spheres(represent(m, settings)).spheres[4].radius;
    };
    EXPECT_FLOAT_EQ(radius({}), 1.10F);
    EXPECT_FLOAT_EQ(radius({.radii = RadiiTable::bondi}), 1.20F);
    EXPECT_FLOAT_EQ(radius({.radius = "0.25"}), 0.25F);
    EXPECT_FLOAT_EQ(radius({.radius = "bfactor"}), 50.0F);
    EXPECT_THROW(represent(m, {.radius = "-1"}), UsageError);
    EXPECT_THROW(represent(m, {.radius = "speed"}), Error);
}

/// Carbons at random places of a box, about one bond apart.
Molecule carbon_gas(std::size_t count, double side) {
    std::mt19937 random(7);
    Molecule m;
    for (std::size_t i = 0; i < count; ++i) {
        const auto place = [&] { return static_cast<double>(random()) * 0x1p-32 * side; };
        const double x = place();
        const double y = place();
        m.positions.push_back({x + 1e6, y - 1e6, place()});
        m.elements.push_back(6);
    }
    return m;
}

TEST(Bonds, AreThoseThatEveryPairOfAtomsWouldGive) {
    const Molecule m = carbon_gas(2000, 20.0);
    std::vector<Bond> expected;
    for (std::uint32_t a = 0; a < m.atom_count(); ++a) {
        for (std::uint32_t b = a + 1; b < m.atom_count(); ++b) {
            const double distance = length(m.positions[a] - m.positions[b]);
            if (distance > 0.4 && distance < 2 * static_cast<double>(0.76F) + 0.45) {
                expected.push_back({a, b});
            }
        }
    }
    EXPECT_GT(expected.size(), 1000U);
    EXPECT_EQ(bonds_by_distance(m.positions, m.elements), expected);
}

TEST(Bonds, LinkNeitherHydrogensNorAtomsInOnePlace) {
    Molecule m;
    m.positions = {{0, 0, 0}, {0.7, 0, 0}, {0, 0.96, 0}, {0, 0.96, 0}};
    m.elements = {1, 1, 8, 8};
    EXPECT_EQ(bonds_by_distance(m.positions, m.elements),
              (std::vector<Bond>{{0, 2}, {0, 3}, {1, 2}, {1, 3}}));
}

TEST(Bonds, TakeNoTimeWithoutEndWhereAllAtomsCrowdTogether) {
    Molecule m = carbon_gas(20'000, 1e-3);
    EXPECT_TRUE(bonds_by_distance(m.positions, m.elements).empty());
}

TEST(Representation, DrawsBallsAndSticks) {
    Molecule m;
    m.positions = {{0, 0, 0}, {1.2, 0, 0}, {1.9, 1.1, 0}};
    m.elements = {6, 6, 8};
    const auto objects = represent(m, {.representation = Representation::ball_and_stick});
    ASSERT_EQ(objects.size(), 2U);
    EXPECT_FLOAT_EQ(spheres(objects).spheres[0].radius, 1.70F / 4);
    const auto& sticks = std::get<Glyphs>(objects[1].shape);
    ASSERT_EQ(sticks.placements.size(), 2U);
    EXPECT_TRUE(objects[1].continues_previous);
    EXPECT_EQ(sticks.colors[0], element(6).color);
    const Bounds3f box = glyph_bounds(sticks.shape, sticks.placements[0]);
    EXPECT_NEAR(box.extent().x, 1.2F, 1e-5F);
    EXPECT_NEAR(box.extent().y, 2 * 0.14F, 1e-5F);
}

TEST(Representation, CutsSticksAloneInTheMiddleWhereColoursChange) {
    Molecule m;
    m.positions = {{0, 0, 0}, {1.2, 0, 0}, {1.2, 1.1, 0}};
    m.elements = {6, 6, 8};
    m.has_bond_table = true;
    m.bonds = {{1, 2}, {0, 1}};
    const auto objects =
        represent(m, {.representation = Representation::sticks, .stick_radius = 0.3});
    const auto& sticks = std::get<Glyphs>(objects.at(1).shape);
    const Rgb8 carbon = element(6).color;
    EXPECT_EQ(sticks.colors, (std::vector<Rgb8>{carbon, element(8).color, carbon}));
    EXPECT_EQ(sticks.other_half, (std::vector<std::int8_t>{1, -1, 0}));
    EXPECT_FLOAT_EQ(spheres(objects).spheres[2].radius, 0.3F);
    EXPECT_NEAR(glyph_bounds(sticks.shape, sticks.placements[0]).upper.y, 0.55F, 1e-5F);
    EXPECT_EQ(objects[0].usual_ids, IdLevel::object);
}

TEST(Representation, DrawsNoSticksWithoutBonds) {
    Molecule m;
    m.positions = {{0, 0, 0}, {9, 0, 0}};
    m.elements = {18, 18};
    EXPECT_EQ(represent(m, {.representation = Representation::sticks}).size(), 1U);
}

TEST(ColorMaps, StartAndEndWhereTheirAuthorsSay) {
    EXPECT_EQ(find_color_map("viridis")->at(0.0), (Rgb8{68, 1, 84}));
    EXPECT_EQ(find_color_map("viridis")->at(1.0), (Rgb8{253, 231, 37}));
    EXPECT_EQ(find_color_map("coolwarm")->at(0.0), (Rgb8{59, 76, 192}));
    EXPECT_EQ(find_color_map("coolwarm")->at(1.0), (Rgb8{180, 4, 38}));
    for (const ColorMap& map : color_maps()) {
        if (map.is_categorical()) continue;
        EXPECT_EQ(map.colors.size(), 6U * 52U) << map.name;
        EXPECT_EQ(map.at(-1.0), map.at(0.0));
        EXPECT_EQ(map.at(2.0), map.at(1.0));
        EXPECT_EQ(map.at(NAN), element(0).color);
    }
    EXPECT_EQ(find_color_map("jet"), nullptr);
}

TEST(ColorMaps, OfPerceptualKindGrowLighterAllAlong) {
    const auto lightness = [](Rgb8 c) {
        return 0.2126 * srgb_decode(static_cast<float>(c.r) / 255.0F) +
               0.7152 * srgb_decode(static_cast<float>(c.g) / 255.0F) +
               0.0722 * srgb_decode(static_cast<float>(c.b) / 255.0F);
    };
    for (const char* name : {"viridis", "cividis", "magma", "inferno", "plasma", "gray"}) {
        const ColorMap& map = *find_color_map(name);
        for (int k = 0; k < 50; ++k) {
            EXPECT_LT(lightness(map.at(k / 50.0)), lightness(map.at((k + 1) / 50.0))) << name << k;
        }
    }
}

TEST(ColorField, GivesWholeNumbersTheirOwnColors) {
    const DataSettings settings{.color_map = find_color_map("categories")};
    const Coloring coloring =
        color_field("type", std::vector<float>{2, 1, 2, 1.5F, NAN, -1}, settings);
    const Rgb8 pink = element(0).color;
    EXPECT_EQ(coloring.colors,
              (std::vector<Rgb8>{category_color(2), category_color(1), category_color(2), pink,
                                 pink, category_color(1)}));
    ASSERT_TRUE(coloring.scale);
    EXPECT_EQ(coloring.scale->title, "type");
    EXPECT_EQ(coloring.scale->entries,
              (std::vector<ColorScale::Entry>{
                  {"-1", category_color(1)}, {"1", category_color(1)}, {"2", category_color(2)}}));
}

TEST(ColorField, SaysWhatItsColorsMean) {
    const std::vector<float> values{3, -1, NAN};
    const auto whole = color_field("q", values, {}).scale;
    EXPECT_EQ(whole, (ColorScale{"q", find_color_map("viridis"), -1, 3, {}}));
    const auto set = color_field("q", values, {.color_range = std::pair{0.0, 9.0}}).scale;
    EXPECT_EQ(set, (ColorScale{"q", find_color_map("viridis"), 0, 9, {}}));
    EXPECT_FALSE(color_field("q", std::vector<float>{NAN}, {}).scale);
}

TEST(Fields, GiveComponentsAndLengths) {
    const std::vector<Field> fields{{"v", 3, {3, 4, 0, 0, 0, 2}}, {"m", 1, {5, 6}}};
    EXPECT_EQ(scalar_values(fields, "v"), (std::vector<float>{5, 2}));
    EXPECT_EQ(scalar_values(fields, "v.y"), (std::vector<float>{4, 0}));
    EXPECT_EQ(scalar_values(fields, "v.2"), (std::vector<float>{0, 2}));
    EXPECT_EQ(scalar_values(fields, "m"), (std::vector<float>{5, 6}));
    EXPECT_TRUE(scalar_values(fields, "v.3").empty());
    EXPECT_TRUE(scalar_values(fields, "w").empty());
}

}  // namespace
}  // namespace ink
