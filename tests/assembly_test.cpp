// Biological assemblies: all copies are drawn, what they have in common is stored once.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "accel/cost.h"
#include "io/reader.h"
#include "read_contents.h"
#include "scene/bonds.h"
#include "test_files.h"

namespace ink {
namespace {

using test::data_file;
using test::expect_refused;
using test::positions;
using test::spheres;
using test::TemporaryFolder;

constexpr std::string_view kPdbAssembly =
    "REMARK 350 BIOMOLECULE: 1\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n"
    "REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000\n"
    "REMARK 350   BIOMT1   2  0.000000 -1.000000  0.000000       10.00000\n"
    "REMARK 350   BIOMT2   2  1.000000  0.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT3   2  0.000000  0.000000  1.000000        0.00000\n"
    "ATOM      1  CA  ALA A   1       1.000   2.000   3.000  1.00 10.00           C\n"
    "ATOM      2  CA  ALA B   1       4.000   5.000   6.000  1.00 20.00           C\n";

constexpr std::string_view kCifAssembly =
    "data_x\nloop_\n_pdbx_struct_assembly_gen.assembly_id\n"
    "_pdbx_struct_assembly_gen.oper_expression\n_pdbx_struct_assembly_gen.asym_id_list\n"
    "1 '(1-2)' X\n2 (1)(2) X,Y\nloop_\n_pdbx_struct_oper_list.id\n"
    "_pdbx_struct_oper_list.matrix[1][1]\n_pdbx_struct_oper_list.matrix[1][2]\n"
    "_pdbx_struct_oper_list.matrix[1][3]\n_pdbx_struct_oper_list.vector[1]\n"
    "_pdbx_struct_oper_list.matrix[2][1]\n_pdbx_struct_oper_list.matrix[2][2]\n"
    "_pdbx_struct_oper_list.matrix[2][3]\n_pdbx_struct_oper_list.vector[2]\n"
    "_pdbx_struct_oper_list.matrix[3][1]\n_pdbx_struct_oper_list.matrix[3][2]\n"
    "_pdbx_struct_oper_list.matrix[3][3]\n_pdbx_struct_oper_list.vector[3]\n"
    "1 1 0 0 0 0 1 0 0 0 0 1 0\n2 0 -1 0 10 1 0 0 0 0 0 1 0\n"
    "loop_\n_atom_site.type_symbol\n_atom_site.label_asym_id\n_atom_site.auth_asym_id\n"
    "_atom_site.auth_seq_id\n_atom_site.label_comp_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n"
    "_atom_site.Cartn_z\nC X A 1 ALA 1 2 3\nC Y B 1 ALA 4 5 6\n";

TEST(Assemblies, CopyTheirChainsByTheirMotions) {
    const TemporaryFolder folder;
    for (const auto& file :
         {folder.write("a.pdb", kPdbAssembly), folder.write("a.cif", kCifAssembly)}) {
        SCOPED_TRACE(file);
        const FileContents contents = read_file(file, {.data = {.assembly = "1"}});
        const auto p = positions(contents);
        ASSERT_EQ(p.size(), 2U);
        EXPECT_NEAR(length(p[0] - Vec3d{1, 2, 3}), 0.0, 1e-6);
        EXPECT_NEAR(length(p[1] - Vec3d{8, 1, 3}), 0.0, 1e-6);
        const Object& object = contents.objects[0];
        EXPECT_EQ(spheres(contents).spheres.size(), 1U) << "stored once";
        EXPECT_EQ(object.part_name(part_of(object.shape, 0)), "A");
        EXPECT_EQ(object.part_name(part_of(object.shape, 1)), "A-2");
    }
}

TEST(Assemblies, OfMotionsThatStretchAreNotCopies) {
    const TemporaryFolder folder;
    std::string text(kCifAssembly);
    text.replace(text.find("2 0 -1 0 10"), 11, "2 0 -2 0 10");
    const FileContents contents =
        read_file(folder.write("a.cif", text), {.data = {.assembly = "1"}});
    EXPECT_TRUE(spheres(contents).copies.empty());
    EXPECT_NEAR(length(positions(contents).at(1) - Vec3d{6, 1, 3}), 0.0, 1e-6);
}

TEST(Assemblies, MultiplyGroupsOfOperators) {
    const TemporaryFolder folder;
    const FileContents contents =
        read_file(folder.write("a.cif", kCifAssembly), {.data = {.assembly = "2"}});
    EXPECT_NEAR(length(positions(contents).at(1) - Vec3d{5, 4, 6}), 0.0, 1e-6);
}

TEST(Assemblies, ThatAreNotThereAreNamed) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.cif", kCifAssembly);
    expect_refused(file, "--assembly: there is no '3'; the file describes 1, 2",
                   {.data = {.assembly = "3"}});
    expect_refused(folder.write("a.xyz", "1\n\nC 0 0 0\n"), "the file describes none",
                   {.data = {.assembly = "1"}});
}

TEST(Assemblies, RefuseOperatorsThatAreNotThereOrTooMany) {
    const TemporaryFolder folder;
    const auto with = [&](std::string_view expression) {
        std::string text(kCifAssembly);
        text.replace(text.find("'(1-2)'"), 7, expression);
        return folder.write("a.cif", text);
    };
    expect_refused(with("1,9"), "an unknown operator");
    expect_refused(with("(1-2"), "brackets that do not match");
    expect_refused(with("(1-999999999)"), "too many operators");
}

TEST(Assemblies, OfChainsThatAreCopiedDifferentlyHaveAUnitForEach) {
    const TemporaryFolder folder;
    std::string text(kCifAssembly);
    text.replace(text.find("1 '(1-2)' X"), 11, "1 '(1-2)' X\n1 2 Y\n1 '(2,1)' Y");
    const FileContents contents =
        read_file(folder.write("a.cif", text), {.data = {.assembly = "1"}});
    // X as 1, 2; Y as 2, 1; and Y once more as 2.
    ASSERT_EQ(contents.objects.size(), 3U);
    std::vector<std::string> names;
    for (const Object& object : contents.objects) {
        EXPECT_EQ(std::get<Spheres>(object.shape).spheres.size(), 1U);
        for (std::size_t i = 0; i < object.primitive_count(); ++i) {
            names.push_back(object.part_name(part_of(object.shape, i)));
        }
    }
    EXPECT_EQ(names, (std::vector<std::string>{"A", "A-2", "B", "B-2", "B"}));
    EXPECT_TRUE(contents.objects[1].continues_previous);
}

TEST(Assemblies, OfOneMotionForSeveralChainsAreOneUnit) {
    const TemporaryFolder folder;
    std::string text(kCifAssembly);
    text.replace(text.find("1 '(1-2)' X"), 11, "1 '(1-2)' X\n1 1,2 Y");
    const FileContents contents =
        read_file(folder.write("a.cif", text), {.data = {.assembly = "1"}});
    ASSERT_EQ(contents.objects.size(), 1U);
    EXPECT_EQ(spheres(contents).spheres.size(), 2U);
    EXPECT_EQ(spheres(contents).count(), 4U);
}

// ---- A capsid of sixty copies ----

class Capsid : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(file_)) GTEST_SKIP() << "no real files here";
    }
    FileContents read(const DataSettings& settings) const {
        return read_file(file_, {.data = settings});
    }

    const std::filesystem::path file_ = data_file("molecules/1rb8_capsid_asu.pdb.gz");
};

/// An atom where it is drawn.
struct Drawn {
    Vec3d place;
    std::uint8_t element = 0;
    std::string part;
};

/// All atoms with their copies, in the order of their places.
std::vector<Drawn> drawn_atoms(const FileContents& contents) {
    std::vector<Drawn> atoms;
    for (const Object& object : contents.objects) {
        const auto* balls = std::get_if<Spheres>(&object.shape);
        if (balls == nullptr) continue;
        for (std::size_t i = 0; i < balls->count(); ++i) {
            atoms.push_back({object.frame.to_world(balls->at(i).centre),
                             object.elements[balls->numbering().source(i)],
                             object.part_name(part_of(object.shape, i))});
        }
    }
    std::ranges::sort(atoms, {}, [](const Drawn& d) {
        return std::array{d.place.x, d.place.y, d.place.z};
    });
    return atoms;
}

TEST_F(Capsid, IsAShellOfSixtyUnits) {
    const FileContents contents = read({.assembly = "1"});
    EXPECT_EQ(spheres(contents).count(), 306'720U);
    // As long in every direction.
    const Bounds3d box = contents.objects[0].world_bounds();
    EXPECT_NEAR(box.lower.x, -box.upper.x, 0.01 * box.upper.x);
    EXPECT_NEAR(box.extent().x, box.extent().y, 0.05 * box.extent().x);
}

TEST_F(Capsid, IsClippedAtomByAtom) {
    const ClipBox clip{{-ClipBox::kFar, -40, -ClipBox::kFar}, {20, ClipBox::kFar, 3}};
    const auto all = drawn_atoms(read({.assembly = "1"}));
    const auto cut = drawn_atoms(read({.assembly = "1", .clip = clip}));
    std::vector<Drawn> expected;
    std::ranges::copy_if(all, std::back_inserter(expected),
                         [&](const Drawn& atom) { return clip.holds(atom.place); });
    ASSERT_GT(expected.size(), 10'000U);
    // The digits of a float decide for atoms on the faces of the box.
    ASSERT_NEAR(static_cast<double>(cut.size()), static_cast<double>(expected.size()), 3.0);
    for (std::size_t i = 0; i < std::min(cut.size(), expected.size()); i += 97) {
        const auto same = std::ranges::find_if(
            expected, [&](const Drawn& atom) { return length(atom.place - cut[i].place) < 1e-4; });
        ASSERT_NE(same, expected.end());
        EXPECT_EQ(same->part, cut[i].part);
        EXPECT_EQ(same->element, cut[i].element);
    }
}

TEST_F(Capsid, StoresOnlyTheCopiesThatTheBoxCuts) {
    const FileContents contents = read({.assembly = "1", .clip = {.upper = {1e9, 1e9, 0}}});
    ASSERT_EQ(contents.objects.size(), 2U);
    const auto& whole = std::get<Spheres>(contents.objects[0].shape);
    const auto& cut = std::get<Spheres>(contents.objects[1].shape);
    EXPECT_EQ(whole.spheres.size(), 5112U);
    EXPECT_GE(whole.copies.size(), 15U);
    EXPECT_TRUE(cut.copies.empty());
    EXPECT_LT(cut.spheres.size(), 30 * 5112U);
}

/// Bytes of what has copies, or of what has none.
double stored_bytes(const FileContents& contents, bool with_copies) {
    double bytes = 0.0;
    for (const Object& object : contents.objects) {
        const bool has_copies = !numbering(object.shape).copies.empty();
        if (has_copies == with_copies) bytes += cost_of({&object, 1}).stored_bytes;
    }
    return bytes;
}

TEST_F(Capsid, TakesTheMemoryOfOneCopyHoweverItIsDrawn) {
    for (const auto how :
         {Representation::spheres, Representation::ball_and_stick, Representation::sticks}) {
        const double one = stored_bytes(read({.representation = how, .color_by = "chain"}), false);
        const double motions = (how == Representation::spheres ? 60.0 : 120.0) * sizeof(Copy);
        const ClipBox far{{-1e9, -1e9, -1e9}, {1e9, 1e9, 1e9}};
        for (const ClipBox& clip : {ClipBox{}, far}) {
            const FileContents all = read({.assembly = "1", .clip = clip, .representation = how});
            EXPECT_EQ(stored_bytes(all, true), one + motions);
            // Bonds from copy to copy, of which there are 30 a copy, in halves.
            EXPECT_LT(stored_bytes(all, false), 0.5 * one);
        }
    }
}

TEST_F(Capsid, HasTheBondsThatItsAtomsHaveWrittenOut) {
    for (const ClipBox& clip : {ClipBox{}, ClipBox{{-200, -200, -200}, {200, 30, 200}}}) {
        const FileContents contents =
            read({.assembly = "1", .clip = clip, .representation = Representation::ball_and_stick});
        std::vector<Vec3d> places;
        std::vector<std::uint8_t> elements;
        for (const Drawn& atom : drawn_atoms(contents)) {
            places.push_back(atom.place);
            elements.push_back(atom.element);
        }
        std::size_t sticks = 0;
        for (const Object& object : contents.objects) {
            const auto* glyphs = std::get_if<Glyphs>(&object.shape);
            if (glyphs != nullptr) sticks += glyphs->count();
        }
        EXPECT_EQ(sticks, bonds_by_distance(places, elements).size());
    }
}

// ---- Bonds between copies ----

TEST(BondsBetweenCopies, JoinWhatLiesNear) {
    // A chain of carbons, 1.4 apart: two atoms, copied along x.
    Molecule m;
    m.positions = {{0, 0, 0}, {1.4, 0, 0}};
    m.elements = {6, 6};
    std::vector<Copy> along(5);
    for (std::uint32_t k = 0; k < along.size(); ++k) along[k] = {{.shift = {2.8 * k, 0, 0}}, k};
    m.units = {{0, 2, along}};
    const auto bonds = bonds_between_copies(m);
    ASSERT_EQ(bonds.size(), 4U);
    for (std::uint32_t k = 0; k < 4; ++k) {
        EXPECT_EQ(bonds[k].a.atom, 2 * k + 1);
        EXPECT_EQ(bonds[k].b.atom, 2 * k + 2);
    }
}

}  // namespace
}  // namespace ink
