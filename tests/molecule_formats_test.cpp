#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "io/molecule_file.h"
#include "io/reader.h"
#include "read_contents.h"
#include "scene/elements.h"
#include "test_files.h"

namespace ink {
namespace {

using test::data_file;
using test::expect_refused;
using test::positions;
using test::spheres;
using test::TemporaryFolder;

// ---- Elements from names ----

TEST(ElementOfName, DependsOnTheResidue) {
    EXPECT_EQ(element_of_name("CA", "ALA"), 6);
    EXPECT_EQ(element_of_name("CA", "CA"), 20);
    EXPECT_EQ(element_of_name("HG21", "THR"), 1);
    EXPECT_EQ(element_of_name("1HB", "ALA"), 1);
    EXPECT_EQ(element_of_name("SE", "MSE"), 34);
    EXPECT_EQ(element_of_name("OW", "SOL"), 8);
    EXPECT_EQ(element_of_name("NA", "NA"), 11);
    EXPECT_EQ(element_of_name("Na", "ION"), 11);
    EXPECT_EQ(element_of_name("CL1", "LIG"), 17);
    EXPECT_EQ(element_of_name("C12", "LIG"), 6);
    EXPECT_EQ(element_of_name("*", "LIG"), 0);
}

// ---- MOL2 ----

constexpr std::string_view kMol2 =
    "@<TRIPOS>MOLECULE\nwater\n 3 2\nSMALL\nNO_CHARGES\n@<TRIPOS>ATOM\n"
    "10 O 0 0 0 O.3 1 HOH -0.8\n20 H1 1 0 0 H 1 HOH 0.4\n30 H2 0 1 0 H 1 HOH 0.4\n"
    "@<TRIPOS>BOND\n1 10 20 1\n2 10 30 1\n";

TEST(Mol2Reader, ReadsAtomsBondsAndCharges) {
    const TemporaryFolder folder;
    const FileContents contents = read_file(folder.write("a.mol2", kMol2));
    EXPECT_EQ(contents.counts[0], (std::pair<std::string, std::uint64_t>{"atoms", 3}));
    EXPECT_EQ(contents.counts.back(), (std::pair<std::string, std::uint64_t>{"bonds", 2}));
    EXPECT_EQ(spheres(contents).colors[0], element(8).color);
    EXPECT_NEAR(contents.fields.at(0).least, -0.8, 1e-6);
}

TEST(Mol2Reader, CountsMoleculesAsFrames) {
    const TemporaryFolder folder;
    std::string two(kMol2);
    two += "@<TRIPOS>MOLECULE\nlone\n1 0\nSMALL\nX\n@<TRIPOS>ATOM\n1 N 7 0 0 N.3\n";
    const auto file = folder.write("a.mol2", two);
    EXPECT_EQ(read_file(file).frames, 2);
    EXPECT_EQ(positions(read_file(file, {.frame = 1})), (std::vector<Vec3d>{{7, 0, 0}}));
    expect_refused(file, "its 2 frames are 0 to 1", {.frame = 2});
}

TEST(Mol2Reader, RefusesWhatMakesNoSense) {
    const TemporaryFolder folder;
    const auto with = [&](std::string_view what, std::string_view other) {
        std::string text(kMol2);
        text.replace(text.find(what), what.size(), other);
        return folder.write("a.mol2", text);
    };
    expect_refused(with("2 10 30 1", "2 10 77 1"), ":12: the bond names atom '77'");
    expect_refused(with("2 10 30 1", "2 10 10 1"), ":12: the bond joins an atom with itself");
    expect_refused(with(" 3 2", " 4 2"), "announces 4 atoms, but 3 follow");
    expect_refused(with("20 H1 1 0 0 H", "20 H1 1 nan 0 H"), ":8: coordinate y 'nan'");
    expect_refused(folder.write("b.mol2", "hello\n"), "has no line '@<TRIPOS>MOLECULE'");
}

TEST(Mol2Reader, ReadsAtomsBeforeTheFirstResidueThatHasAName) {
    const TemporaryFolder folder;
    const FileContents contents = read_file(folder.write(
        "a.mol2",
        "@<TRIPOS>MOLECULE\nx\n2\nSMALL\nX\n@<TRIPOS>ATOM\n1 C1 0 0 0 C.3\n2 O 9 0 0 O.3 1 HOH\n"));
    EXPECT_EQ(spheres(contents).parts, (std::vector<std::uint32_t>{0, 0}));
}

TEST(Mol2Reader, TakesTheElementFromTheNameWhereTypesAreAForceFields) {
    const TemporaryFolder folder;
    const auto file = folder.write(
        "a.mol2",
        "@<TRIPOS>MOLECULE\nx\n2\nSMALL\nX\n@<TRIPOS>ATOM\n1 C1 0 0 0 ca\n2 O 9 0 0 oh\n");
    EXPECT_EQ(spheres(read_file(file)).colors,
              (std::vector<Rgb8>{element(6).color, element(8).color}));
}

// ---- GRO ----

std::string gro_atom(std::string_view residue, std::string_view name, int number, Vec3d nm) {
    return fmt::format("{:5}{:<5}{:>5}{:5}{:8.3f}{:8.3f}{:8.3f}\n", number, residue, name, number,
                       nm.x, nm.y, nm.z);
}

TEST(GroReader, TurnsNanometresIntoAngstrom) {
    const TemporaryFolder folder;
    const std::string frame = "title\n2\n" + gro_atom("ALA", "CA", 1, {0.1, 0.2, -0.3}) +
                              gro_atom("SOL", "OW", 2, {1, 2, 3}) + "1 1 1\n";
    const auto file = folder.write("a.gro", frame + frame);
    const FileContents contents = read_file(file, {.frame = 1});
    EXPECT_EQ(contents.frames, 2);
    EXPECT_EQ(contents.length_unit, "angstrom");
    EXPECT_NEAR(length(positions(contents)[0] - Vec3d{1, 2, -3}), 0.0, 1e-6);
    EXPECT_EQ(spheres(contents).colors[0], element(6).color);
}

TEST(GroReader, FindsColumnsOfAnyPrecision) {
    const TemporaryFolder folder;
    const auto file = folder.write(
        "a.gro", "t\n1\n    1ALA     CA    1   0.12345  -1.00000   2.50000  0.1 0.1 0.1\n1 1 1\n");
    EXPECT_NEAR(length(positions(read_file(file))[0] - Vec3d{1.2345, -10, 25}), 0.0, 1e-5);
}

TEST(GroReader, RefusesACountThatTheFileDoesNotHold) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.gro", "t\n3\n" + gro_atom("ALA", "CA", 1, {}) + "1 1 1\n");
    expect_refused(file, ":2: announces 3 atoms");
    expect_refused(folder.write("b.gro", "t\nmany\n"), ":2: expected the number of atoms");
}

// ---- PQR ----

TEST(PqrReader, DrawsTheRadiiOfTheFile) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.pqr",
                                   "REMARK x\nATOM 1 N ALA 1 0 0 0 -0.4 1.5\n"
                                   "ATOM 2 CA ALA A 1 3.0 0 0 0.1 2.0\n"
                                   "ATOM 3 HA ALA A 1 4.0 0 0 0.1 0.0\nTER\n");
    const FileContents contents = read_file(file);
    ASSERT_EQ(spheres(contents).spheres.size(), 2U);
    EXPECT_FLOAT_EQ(spheres(contents).spheres[0].radius, 1.5F);
    EXPECT_FLOAT_EQ(spheres(contents).spheres[1].radius, 2.0F);
    ASSERT_EQ(contents.warnings.size(), 1U);
    EXPECT_NE(contents.warnings[0].find("1 atom has no radius"), std::string::npos);
    EXPECT_EQ(spheres(read_file(file, {.data = {.radius = "0.5"}})).spheres.size(), 3U);
}

TEST(PqrReader, RefusesRadiiThatNoAtomHas) {
    const TemporaryFolder folder;
    expect_refused(folder.write("a.pqr", "ATOM 1 N ALA 1 0 0 0 0 -1\n"),
                   ":1: the radius is negative");
    expect_refused(folder.write("b.pqr", "ATOM 1 N ALA 1 0 0 0 0 x\n"), ":1: the radius 'x'");
    expect_refused(folder.write("c.pqr", "ATOM 1 N ALA 1 0 0 0\n"),
                   ":1: the atom has 8 of at least");
}

// ---- Small-molecule CIF ----

std::string crystal(std::string_view beta, std::string_view rows) {
    return fmt::format(
        "data_x\n_cell_length_a 10.0(2)\n_cell_length_b 20\n_cell_length_c 5\n"
        "_cell_angle_alpha 90\n_cell_angle_beta {}\n_cell_angle_gamma 90\nloop_\n"
        "_atom_site_label\n_atom_site_type_symbol\n_atom_site_fract_x\n_atom_site_fract_y\n"
        "_atom_site_fract_z\n_atom_site_disorder_group\n{}",
        beta, rows);
}

TEST(CrystalReader, TurnsFractionsOfTheCellIntoAngstrom) {
    const TemporaryFolder folder;
    const FileContents contents = read_file(
        folder.write("a.cif", crystal("120(1)", "C1 C 0.5 0.25(3) 0 .\nFe1 Fe3+ 0 0 1 .\n")));
    const auto p = positions(contents);
    EXPECT_NEAR(length(p[0] - Vec3d{5, 5, 0}), 0.0, 1e-6);
    // c makes 120 degrees with a, in the plane of a and c.
    EXPECT_NEAR(length(p[1] - Vec3d{-2.5, 0, 5 * std::sqrt(0.75)}), 0.0, 1e-6);
    EXPECT_EQ(spheres(contents).colors[1], element(26).color);
}

TEST(CrystalReader, KeepsTheFirstDisorderGroup) {
    const TemporaryFolder folder;
    const FileContents contents = read_file(
        folder.write("a.cif", crystal("90", "C1 C 0 0 0 .\nC2 C 0.5 0 0 1\nC3 C 0.6 0 0 2\n")));
    EXPECT_EQ(spheres(contents).spheres.size(), 2U);
}

TEST(CrystalReader, RefusesACellThatIsNone) {
    const TemporaryFolder folder;
    expect_refused(folder.write("a.cif", crystal("0", "C1 C 0 0 0 .\n")), "_cell_angle_beta '0'");
    expect_refused(folder.write("b.cif", crystal("90", "C1 C 0 ? 0 .\n")),
                   "coordinate y is missing");
    expect_refused(folder.write("c.cif",
                                "data_x\nloop_\n_atom_site_fract_x\n_atom_site_fract_y\n"
                                "_atom_site_fract_z\n0 0 0\n"),
                   "no _cell_length_a");
}

// ---- Symmetry ----

/// What a file with its CRYST1 record, or nothing, is warned about.
std::string warning_of_pdb(std::string_view group, std::string_view residue) {
    const TemporaryFolder folder;
    const FileContents contents = read_file(folder.write(
        "a.pdb", fmt::format("CRYST1   25.669   25.669   25.669  90.00  90.00  90.00 {:<11}   1\n"
                             "HETATM    1  C   {}     1       1.000   2.000   3.000  1.00  0.00"
                             "           C\n",
                             group, residue)));
    return contents.warnings.empty() ? "" : contents.warnings.front();
}

constexpr std::string_view kNotApplied = "Only the atoms of the file are drawn";

TEST(Symmetry, IsMissedWhereACrystalIsOfNoMacromolecule) {
    EXPECT_EQ(warning_of_pdb("F m -3 m", "LIG"),
              "Only the atoms of the file are drawn: the symmetry of its crystal (F m -3 m) is not "
              "applied.");
    EXPECT_EQ(warning_of_pdb("P 1", "LIG"), "");
    EXPECT_EQ(warning_of_pdb("", "LIG"), "");
    EXPECT_EQ(warning_of_pdb("P 21 21 21", "ALA"), "");
    EXPECT_EQ(warning_of_pdb("P 21 21 21", " DA"), "");
}

TEST(Symmetry, OfCifIsThatOfItsSpaceGroup) {
    const TemporaryFolder folder;
    const auto expect = [&](bool warned, std::string_view text) {
        SCOPED_TRACE(text);
        const auto contents = read_file(folder.write("a.cif", text));
        ASSERT_EQ(contents.warnings.size(), warned ? 1U : 0U);
        for (const std::string& warning : contents.warnings) {
            EXPECT_TRUE(warning.starts_with(kNotApplied)) << warning;
        }
    };
    const std::string atoms = crystal("90", "C1 C 0 0 0 .\n");
    expect(true, atoms);  // nothing is said
    expect(true, atoms + "_symmetry_space_group_name_H-M 'P 1 21 1'\n");
    expect(true, atoms + "loop_\n_symmetry_equiv_pos_as_xyz\n'x, y, z'\n'-x, y+1/2, -z'\n");
    expect(false, atoms + "_space_group_name_H-M_alt 'P 1'\n");
    expect(false, atoms + "loop_\n_space_group_symop_operation_xyz\n'x, y, z'\n");
    const auto macromolecule = [](std::string_view residue) {
        return fmt::format(
            "data_x\n_symmetry.space_group_name_H-M 'C 2 2 21'\nloop_\n_atom_site.type_symbol\n"
            "_atom_site.label_comp_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n"
            "_atom_site.Cartn_z\nC {} 1 2 3\n",
            residue);
    };
    expect(true, macromolecule("LIG"));
    expect(false, macromolecule("GLY"));
}

TEST(MmcifReader, ReadsALoneAtomWithoutALoop) {
    const TemporaryFolder folder;
    const auto file = folder.write(
        "a.cif",
        "data_x\n_atom_site.type_symbol Zn\n_atom_site.Cartn_x 1\n_atom_site.Cartn_y 2\n"
        "_atom_site.Cartn_z 3\n");
    EXPECT_EQ(positions(read_file(file)), (std::vector<Vec3d>{{1, 2, 3}}));
}

}  // namespace
}  // namespace ink
