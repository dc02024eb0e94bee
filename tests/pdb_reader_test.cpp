#include <gtest/gtest.h>

#include <string>

#include "io/reader.h"
#include "molecule_texts.h"
#include "read_contents.h"
#include "test_files.h"

namespace ink::test {
namespace {

// ---- PDB ----

TEST(PdbReader, TakesTheElementFromTheAtomNameWhereThereIsNoColumn) {
    const TemporaryFolder folder;
    const auto name_only = [&](std::string_view name, std::string_view residue) {
        const std::string line = pdb_atom(name, residue, 1, {1, 2, 3}, "").substr(0, 66);
        return elements(read_file(folder.write("a.pdb", line + "\n")));
    };
    EXPECT_EQ(name_only(" CA ", "ALA"), "C");
    EXPECT_EQ(name_only("CA  ", " CA"), "Ca");
    EXPECT_EQ(name_only("CA  ", "ALA"), "C") << "starts one column too early";
    EXPECT_EQ(name_only("HG11", "VAL"), "H");
    EXPECT_EQ(name_only("HG  ", "SER"), "H") << "starts one column too early";
    EXPECT_EQ(name_only("1HB ", "ALA"), "H");
    EXPECT_EQ(name_only("FE  ", "HEM"), "Fe");
    EXPECT_EQ(name_only("SE  ", "MSE"), "Se");
}

TEST(PdbReader, MakesChainsParts) {
    const TemporaryFolder folder;
    const FileContents contents = read_file(
        folder.write("a.pdb", pdb_atom(" CA ", "ALA", 1, {0, 0, 0}, "C", ' ', 'A') +
                                  pdb_atom(" CA ", "ALA", 1, {3, 0, 0}, "C", ' ', 'B') + "TER\n" +
                                  pdb_atom(" O  ", "HOH", 2, {6, 0, 0}, "O", ' ', 'A')));
    EXPECT_EQ(contents.objects[0].part_names, (std::vector<std::string>{"A", "B"}));
    EXPECT_EQ(spheres(contents).parts, (std::vector<std::uint32_t>{0, 1, 0}));
    EXPECT_EQ(count(contents, "residues"), 3u);
    EXPECT_EQ(count(contents, "chains"), 2u);
}

TEST(PdbReader, KeepsTheFirstOfAlternateLocationsAndSaysSo) {
    const TemporaryFolder folder;
    const FileContents contents =
        read_file(folder.write("a.pdb", pdb_atom(" N  ", "SER", 1, {0, 0, 0}, "N") +
                                            pdb_atom(" CA ", "SER", 1, {1, 0, 0}, "C", 'B') +
                                            pdb_atom(" CA ", "SER", 1, {2, 0, 0}, "C", 'A') +
                                            pdb_atom(" CA ", "PRO", 2, {3, 0, 0}, "C", 'A') +
                                            pdb_atom(" SG ", "CYS", 2, {4, 0, 0}, "S", 'B') +
                                            pdb_atom(" SG ", "CYS", 3, {5, 0, 0}, "S", 'B')));
    EXPECT_EQ(elements(contents), "NCCS");
    EXPECT_EQ(positions(contents)[1].x, 1.0);
    EXPECT_EQ(count(contents, "residues"), 3u);
    ASSERT_EQ(contents.warnings.size(), 1u);
    EXPECT_NE(contents.warnings[0].find("2 atoms have been left out"), std::string::npos);
}

TEST(PdbReader, ReturnsTheModelThatIsAskedFor) {
    const TemporaryFolder folder;
    const auto model = [](int number, double x) {
        return fmt::format("MODEL {:8}\n", number) + pdb_atom(" CA ", "ALA", 1, {x, 0, 0}, "C") +
               "ENDMDL\n";
    };
    // Equal numbers are wrong, but harmless.
    const auto file = folder.write("a.pdb", model(1, 5) + model(1, 6) + model(1, 7) + "END\n");
    const FileContents contents = read_file(file, {.frame = 1});
    EXPECT_EQ(contents.frames, 3);
    EXPECT_EQ(positions(contents).at(0).x, 6.0);
}

TEST(PdbReader, CountsFramesThatOnlyEndSeparates) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.pdb", formaldehyde_pdb() + formaldehyde_pdb());
    EXPECT_EQ(read_file(file).frames, 2);
    EXPECT_EQ(count(read_file(file, {.frame = 1}), "atoms"), 4u);
}

TEST(PdbReader, RefusesCoordinatesThatAreNoNumbers) {
    const TemporaryFolder folder;
    const std::string good = pdb_atom(" CA ", "ALA", 1, {1, 2, 3}, "C");
    const auto with_x = [&](std::string_view x) {
        return folder.write("a.pdb", good + std::string(good).replace(30, 8, x));
    };
    EXPECT_EQ(refusal(with_x("   1.500")), "(it was read)");
    expect_refused(with_x("     nan"), ":2: coordinate x 'nan' is not a number",
                   "repair or remove the atom");
    expect_refused(with_x("     inf"), ":2: coordinate x 'inf' is not a number", "repair");
    expect_refused(with_x("********"), ":2: coordinate x '********' is not a number", "repair");
    expect_refused(with_x("        "), ":2: coordinate x is missing", "repair");
    expect_refused(with_x(" 1.5 2.5"), ":2: coordinate x '1.5 2.5' is not a number", "repair");
    expect_refused(with_x("    1e40"), ":2: coordinate x '1e40' is too large", "repair");
}

TEST(PdbReader, RefusesALineThatEndsInsideTheCoordinates) {
    const TemporaryFolder folder;
    const std::string good = pdb_atom(" CA ", "ALA", 1, {1, 2, 3}, "C");
    const auto file = folder.write("a.pdb", "HEADER\n" + good + good.substr(0, 47));
    expect_refused(file, ":3: the line ends at column 47", "repair or remove the atom");
    EXPECT_EQ(refusal(folder.write("b.pdb", good + good.substr(0, 54))), "(it was read)");
}

TEST(PdbReader, SurvivesBytesThatAreNoText) {
    const TemporaryFolder folder;
    std::string atom = pdb_atom(" CA ", "ALA", 1, {1, 2, 3}, "C");
    atom[7] = '\0';
    atom[12] = '\xff';
    atom[60] = '\0';
    EXPECT_EQ(elements(read_file(folder.write("a.pdb", atom + atom))), "CC");
}

TEST(PdbReader, RefusesAFileWithoutAtoms) {
    const TemporaryFolder folder;
    expect_refused(folder.write("a.pdb", "HEADER    NOTHING\nEND\n"), ": holds no atoms",
                   "coordinates");
}

// ---- mmCIF ----

TEST(MmcifReader, ReturnsTheModelThatIsAskedFor) {
    const TemporaryFolder folder;
    const auto file =
        folder.write("a.cif", cif("ATOM C . ALA A 1 5 0 0 1\n"
                                  "ATOM N . ALA A 1 6 0 0 2\nATOM O . ALA A 1 7 0 0 2\n"));
    EXPECT_EQ(read_file(file).frames, 2);
    EXPECT_EQ(elements(read_file(file)), "C");
    EXPECT_EQ(elements(read_file(file, {.frame = 1})), "NO");
}

TEST(MmcifReader, KeepsTheFirstOfAlternateLocationsAndSaysSo) {
    const TemporaryFolder folder;
    const FileContents contents = read_file(
        folder.write("a.cif", cif("ATOM N . SER A 1 0 0 0 1\nATOM C B SER A 1 1 0 0 1\n"
                                  "ATOM C A SER A 1 2 0 0 1\nATOM C A PRO A 2 3 0 0 1\n"
                                  "ATOM S B CYS A 2 4 0 0 1\nATOM S B CYS A 3 5 0 0 1\n")));
    EXPECT_EQ(elements(contents), "NCCS");
    EXPECT_EQ(count(contents, "residues"), 3u);
    ASSERT_EQ(contents.warnings.size(), 1u);
    EXPECT_NE(contents.warnings[0].find("2 atoms have been left out"), std::string::npos);
}

TEST(MmcifReader, NamesTheLineOfACoordinateThatIsNoNumber) {
    const TemporaryFolder folder;
    const auto second_atom_x = [&](std::string_view x) {
        return folder.write("a.cif", cif(fmt::format("ATOM C . ALA A 1 5 0 0 1\n"
                                                     "ATOM C . ALA A 1\n{} 0 0 1\n",
                                                     x)));
    };
    expect_refused(second_atom_x("nan"), ":15: coordinate x 'nan' is not a number", "repair");
    expect_refused(second_atom_x("?"), ":15: coordinate x is missing", "repair");
    expect_refused(second_atom_x("1.2.3"), ":15: coordinate x '1.2.3' is not a number", "repair");
    expect_refused(second_atom_x("-1e16"), ":15: coordinate x '-1e16' is too large", "repair");
}

TEST(MmcifReader, RefusesATableThatWasCut) {
    const TemporaryFolder folder;
    expect_refused(folder.write("a.cif", cif("ATOM C . ALA A 1 5 0 0 1\nATOM C . ALA A")),
                   ":14: the last row of the atom table has 5 of 10 values", "copy the file again");
}

TEST(MmcifReader, NamesTheCoordinateColumnThatIsMissing) {
    const TemporaryFolder folder;
    expect_refused(
        folder.write("a.cif", "data_a\nloop_\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n1 2\n"),
        ":5: the atom table has no column _atom_site.Cartn_z", "it needs Cartn_x");
}

TEST(MmcifReader, NamesTheLineOfASyntaxError) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.cif", "data_a\n_a.b\n;never closed\nand so on\n");
    expect_refused(file, ":", "repair the file");
    EXPECT_NE(refusal(file).find("unterminated text field"), std::string::npos);
    expect_refused(folder.write("b.cif", "this is not CIF\n"), ":1: expected block header",
                   "repair");
}

}  // namespace
}  // namespace ink::test
