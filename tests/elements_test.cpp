#include "scene/elements.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "base/text.h"
#include "scene/representation.h"

namespace ink {
namespace {

TEST(Elements, HaveEachASymbolOfTheirOwn) {
    std::set<std::string_view> symbols;
    for (std::size_t z = 0; z < kElementCount; ++z) {
        const Element& kind = element(static_cast<std::uint8_t>(z));
        EXPECT_FALSE(kind.symbol.empty()) << z;
        EXPECT_TRUE(symbols.insert(kind.symbol).second) << kind.symbol;
    }
}

TEST(Elements, HaveARadiusThatAtomsCanHave) {
    for (std::size_t z = 0; z < kElementCount; ++z) {
        const Element& kind = element(static_cast<std::uint8_t>(z));
        EXPECT_GE(kind.vdw_radius, 1.0f) << kind.symbol;
        EXPECT_LE(kind.vdw_radius, 3.6f) << kind.symbol;
    }
}

TEST(Elements, AreFoundByTheirSymbolInAnyCase) {
    for (std::size_t z = 1; z < kElementCount; ++z) {
        const auto number = static_cast<std::uint8_t>(z);
        const std::string symbol(element(number).symbol);
        std::string upper = symbol;
        if (upper.size() > 1) upper[1] = static_cast<char>(upper[1] - 'a' + 'A');
        EXPECT_EQ(atomic_number(symbol), number);
        EXPECT_EQ(atomic_number(upper), number);
        EXPECT_EQ(atomic_number(to_lower(symbol)), number);
    }
    EXPECT_EQ(atomic_number(" C "), 6);
}

TEST(Elements, CountHydrogenIsotopesAsHydrogen) {
    EXPECT_EQ(atomic_number("D"), 1);
    EXPECT_EQ(atomic_number("T"), 1);
}

TEST(Elements, AreNotMadeOfOtherWords) {
    for (const char* word : {"", "X", "Xx", "XX", "C1", "1", "-", "Abc", "\xc3\xa9", "Zz", "?"}) {
        EXPECT_FALSE(atomic_number(word)) << word;
    }
}

// Mantina et al. 2009, Table 12.
TEST(Elements, HaveThePublishedRadiiOfTheMainGroup) {
    const auto radius = [](const char* symbol) {
        return element(*atomic_number(symbol)).vdw_radius;
    };
    EXPECT_FLOAT_EQ(radius("H"), 1.10f);
    EXPECT_FLOAT_EQ(radius("C"), 1.70f);
    EXPECT_FLOAT_EQ(radius("N"), 1.55f);
    EXPECT_FLOAT_EQ(radius("O"), 1.52f);
    EXPECT_FLOAT_EQ(radius("P"), 1.80f);
    EXPECT_FLOAT_EQ(radius("S"), 1.80f);
    EXPECT_FLOAT_EQ(radius("In"), 1.93f);
    EXPECT_FLOAT_EQ(radius("Sn"), 2.17f);
    EXPECT_FLOAT_EQ(radius("Fr"), 3.48f);
}

TEST(Elements, HaveThePublishedRadiiOfOtherTables) {
    const auto of = [](RadiiTable table, std::string_view symbol) {
        return atom_radius(table, atomic_number(symbol).value());
    };
    EXPECT_FLOAT_EQ(of(RadiiTable::bondi, "H"), 1.20F);
    EXPECT_FLOAT_EQ(of(RadiiTable::bondi, "C"), 1.70F);
    EXPECT_FLOAT_EQ(of(RadiiTable::bondi, "Hg"), 1.55F);
    EXPECT_FLOAT_EQ(of(RadiiTable::covalent, "C"), 0.76F);
    EXPECT_FLOAT_EQ(of(RadiiTable::covalent, "Fe"), 1.32F);
    EXPECT_FLOAT_EQ(of(RadiiTable::covalent, "Au"), 1.36F);
    EXPECT_FLOAT_EQ(of(RadiiTable::covalent, "Cm"), 1.69F);
    EXPECT_FLOAT_EQ(of(RadiiTable::covalent, "Og"), 1.69F);
}

TEST(Elements, BeyondTheTableAreUnknownAndPink) {
    EXPECT_EQ(element(200).symbol, element(0).symbol);
    EXPECT_EQ(element(0).color, (Rgb8{255, 20, 147}));
    EXPECT_FLOAT_EQ(element(0).vdw_radius, 1.5f);
}

Molecule carbon_monoxide_far_away() {
    Molecule molecule;
    molecule.name = "CO";
    molecule.positions = {{1e9, 0, 0}, {1e9 + 1.128, 0, 0}};
    molecule.elements = {6, 8};
    return molecule;
}

TEST(SpaceFilling, KeepsBondLengthsFarFromTheOrigin) {
    const Object object = represent(carbon_monoxide_far_away(), {}).at(0);
    const auto& spheres = std::get<Spheres>(object.shape);
    ASSERT_EQ(spheres.spheres.size(), 2u);
    EXPECT_EQ(object.frame.origin, (Vec3d{1e9, 0, 0}));
    EXPECT_NEAR(spheres.spheres[1].centre.x, 1.128, 1e-6);
    EXPECT_FLOAT_EQ(spheres.spheres[1].radius, 1.52f);
    EXPECT_EQ(spheres.colors[1], element(8).color);
}

TEST(SpaceFilling, HasNoPartsWithoutResidues) {
    const Object object = represent(carbon_monoxide_far_away(), {}).at(0);
    EXPECT_TRUE(object.part_names.empty());
    EXPECT_TRUE(std::get<Spheres>(object.shape).parts.empty());
}

TEST(SpaceFilling, MakesChainsItsParts) {
    Molecule molecule = carbon_monoxide_far_away();
    molecule.chains = {"A", "B"};
    molecule.residue_table = {{"CMO", 1, 1}, {"CMO", 2, 0}};
    molecule.residues = {0, 1};
    const Object object = represent(molecule, {}).at(0);
    EXPECT_EQ(object.part_names, molecule.chains);
    EXPECT_EQ(std::get<Spheres>(object.shape).parts, (std::vector<std::uint32_t>{1, 0}));
}

}  // namespace
}  // namespace ink
