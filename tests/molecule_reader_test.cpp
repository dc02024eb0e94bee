#include <gtest/gtest.h>
#include <zlib.h>

#include <map>
#include <set>

#include "base/error.h"
#include "io/file_text.h"
#include "io/reader.h"
#include "molecule_texts.h"
#include "paths.h"
#include "read_contents.h"
#include "test_files.h"

namespace ink::test {
namespace {

void expect_same_spheres(const FileContents& a, const FileContents& b, double tolerance) {
    EXPECT_EQ(elements(a), elements(b));
    const std::vector<Vec3d> pa = positions(a);
    const std::vector<Vec3d> pb = positions(b);
    ASSERT_EQ(pa.size(), pb.size());
    for (std::size_t i = 0; i < pa.size(); ++i) EXPECT_LE(length(pa[i] - pb[i]), tolerance) << i;
}

std::filesystem::path write_gzip(const TemporaryFolder& folder, std::string_view name,
                                 const std::string& content) {
    const std::filesystem::path file = folder.path() / name;
    const gzFile out = gzopen(file.c_str(), "wb");
    gzwrite(out, content.data(), static_cast<unsigned>(content.size()));
    gzclose(out);
    return file;
}

TEST(MoleculeReader, FindsTheSameSpheresInEveryFormat) {
    const TemporaryFolder folder;
    const FileContents xyz = read_file(folder.write("a.xyz", kXyz));
    EXPECT_EQ(elements(xyz), "COHH");
    EXPECT_EQ(xyz.length_unit, "angstrom");
    const std::map<std::string, std::string> others{{"a.pdb", formaldehyde_pdb()},
                                                    {"a.cif", cif(kCifRows)},
                                                    {"a.sdf", std::string(kSdf)},
                                                    {"a.mol", std::string(kV3000)}};
    for (const auto& [name, content] : others) {
        SCOPED_TRACE(name);
        expect_same_spheres(xyz, read_file(folder.write(name, content)), 1e-6);
    }
}

TEST(MoleculeReader, FindsTheSameSpheresInAnyFrameOfReference) {
    const TemporaryFolder folder;
    const FileContents contents =
        read_file(folder.write("far.xyz", "2\n\nC 1e9 0 0\nO 1e9 1.2 0\n"));
    EXPECT_NEAR(spheres(contents).spheres[1].centre.y, 1.2, 1e-6);
}

TEST(MoleculeReader, UnpacksGzip) {
    const TemporaryFolder folder;
    const FileContents plain = read_file(folder.write("a.xyz", kXyz));
    for (const auto& [name, content] :
         std::map<std::string, std::string>{{"a.xyz.gz", std::string(kXyz)},
                                            {"a.pdb.gz", formaldehyde_pdb()},
                                            {"a.cif.gz", cif(kCifRows)},
                                            {"a.sdf.gz", std::string(kSdf)}}) {
        const FileContents packed = read_file(write_gzip(folder, name, content));
        expect_same_spheres(plain, packed, 1e-6);
        EXPECT_EQ(packed.objects[0].name, "a");
    }
}

TEST(MoleculeReader, RefusesGzipThatWasCutOrDamaged) {
    const TemporaryFolder folder;
    std::string text;
    for (int i = 0; i < 1000; ++i) text += pdb_atom(" C1 ", "FOR", i, {i / 7.0, i / 3.0, 0}, "C");
    std::string bytes = read_bytes(write_gzip(folder, "whole.pdb.gz", text));
    const auto cut = folder.write("cut.pdb.gz", bytes.substr(0, bytes.size() / 2));
    expect_refused(cut, ": the compressed data", "copy or download it again");
    bytes[bytes.size() / 2] = static_cast<char>(~bytes[bytes.size() / 2]);
    const auto damaged = folder.write("damaged.pdb.gz", bytes);
    expect_refused(damaged, ": the compressed data are damaged", "copy or download it again");
}

TEST(FileText, RefusesGzipThatUnpacksToMoreThanTheLimit) {
    const TemporaryFolder folder;
    const auto file = write_gzip(folder, "bomb.xyz.gz", std::string(5 << 20, ' '));
    EXPECT_LT(std::filesystem::file_size(file), 10000u);
    EXPECT_EQ(read_text(file, 5 << 20).size(), std::size_t{5} << 20);
    EXPECT_THROW(read_text(file, (5 << 20) - 1), InputError);
}

TEST(MoleculeReader, NamesAFrameThatIsNotThere) {
    const TemporaryFolder folder;
    const auto xyz = folder.write("a.xyz", std::string(kXyz) + std::string(kXyz));
    expect_refused(xyz, ": has no frame 2", "its 2 frames are 0 to 1", 2);
    expect_refused(xyz, ": has no frame -1", "its 2 frames are 0 to 1", -1);
    expect_refused(folder.write("a.pdb", formaldehyde_pdb()), ": has no frame 1",
                   "its only frame is 0", 1);
    expect_refused(folder.write("a.cif", cif(kCifRows)), ": has no frame 1", "its only frame is 0",
                   1);
    expect_refused(folder.write("a.sdf", kSdf), ": has no frame 1", "its only frame is 0", 1);
}

TEST(MoleculeReader, WarnsOnceOfUnknownElements) {
    const TemporaryFolder folder;
    const FileContents contents =
        read_file(folder.write("a.xyz", "3\n\nC 0 0 0\nDu 1 0 0\nQ 2 0 0\n"));
    EXPECT_EQ(elements(contents), "CXxXx");
    ASSERT_EQ(contents.warnings.size(), 1u);
    EXPECT_NE(contents.warnings[0].find("2 atoms have no known element"), std::string::npos);
}
// ---- XYZ ----

TEST(XyzReader, ReadsSymbolsNumbersAndLabels) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.xyz",
                                   "6\n\nC 0 0 0\n8 1 0 0\ncl 2 0 0\nFe3+ 3 0 0\n"
                                   "H12\t4\t0\t0 0.1 0.2\n\tD 5 0 0\r\n");
    EXPECT_EQ(elements(read_file(file)), "COClFeHH");
}

TEST(XyzReader, FindsSpeciesAndPositionByName) {
    const TemporaryFolder folder;
    const auto file = folder.write(
        "a.xyz",
        "1\nLattice=\"1 0 0 0 1 0 0 0 1\" Properties=id:I:1:pos:R:3:species:S:1:radius:R:1\n"
        "7 1.5 2.5 3.5 N 0.3\n");
    const FileContents contents = read_file(file);
    EXPECT_EQ(spheres(contents).colors[0], element(7).color);
    EXPECT_EQ(positions(contents)[0], (Vec3d{1.5, 2.5, 3.5}));
    EXPECT_FLOAT_EQ(spheres(contents).spheres[0].radius, 0.3F);
    EXPECT_TRUE(contents.warnings.empty());
    ASSERT_EQ(contents.fields.size(), 2U);
    EXPECT_EQ(contents.fields[1].name, "id");
}

TEST(XyzReader, RefusesPropertiesThatMakeNoSense) {
    const TemporaryFolder folder;
    for (const std::string value : {"species:S", "species:S:1", "pos:R:2", "species:S:x:pos:R:3",
                                    "species:S:99999999999:pos:R:3", ""}) {
        const auto file = folder.write("a.xyz", "1\nProperties=" + value + "\nC 0 0 0\n");
        expect_refused(file, ":2: ", "species:S:1:pos:R:3");
    }
}

TEST(XyzReader, RefusesACountThatTheFileDoesNotHold) {
    const TemporaryFolder folder;
    expect_refused(folder.write("a.xyz", "1000000000\n\nC 0 0 0\nO 1 0 0\n"),
                   ":1: announces 1000000000 atoms, but only 2 rows follow", "correct the count");
    expect_refused(folder.write("b.xyz", "-3\n\nC 0 0 0\n"), ":1: expected a number of atoms",
                   "count");
    expect_refused(folder.write("c.xyz", "99999999999999999999\n\nC 0 0 0\n"),
                   ":1: expected a number of atoms", "count");
    expect_refused(folder.write("d.xyz", "1\n\nC 0 0 0\nO 1 0 0\n"),
                   ":4: expected a number of atoms, found 'O 1 0 0'", "that many rows");
    expect_refused(folder.write("e.xyz", "0\n\n"), ": holds no atoms", "coordinates");
    expect_refused(folder.write("f.xyz", "\n \n"), ": holds no atoms", "coordinates");
}

TEST(XyzReader, RefusesCoordinatesThatAreNoNumbers) {
    const TemporaryFolder folder;
    expect_refused(folder.write("a.xyz", "2\n\nC 0 0 0\nO 0 nan 0\n"),
                   ":4: coordinate y 'nan' is not a number", "repair or remove the atom");
    expect_refused(folder.write("b.xyz", "2\n\nC 0 0 0\nO 0 0 1e40\n"),
                   ":4: coordinate z '1e40' is too large", "repair or remove the atom");
    expect_refused(folder.write("c.xyz", "2\n\nC 0 0 0\nO 0 0\n"), ":4: the row has 3 of 4 columns",
                   "fewer atoms");
    expect_refused(folder.write("d.xyz", "1\n\n0.5 0 0 1\n"), ":3: expected an element symbol",
                   "C, N or Fe");
}

TEST(XyzReader, ReturnsTheFrameThatIsAskedFor) {
    const TemporaryFolder folder;
    const auto file =
        folder.write("a.xyz", "1\na\nC 0 0 0\n\n2\nb\nN 1 0 0\nO 2 0 0\n1\nc\nS 3 0 0");
    EXPECT_EQ(read_file(file).frames, 3);
    EXPECT_EQ(elements(read_file(file, {.frame = 1})), "NO");
    EXPECT_EQ(elements(read_file(file, {.frame = 2})), "S");
}

TEST(XyzReader, LeavesOutALastFrameThatIsStillBeingWritten) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.xyz", "1\na\nC 0 0 0\n2\nb\nN 1 0 0\n");
    const FileContents contents = read_file(file);
    EXPECT_EQ(contents.frames, 1);
    ASSERT_EQ(contents.warnings.size(), 1u);
    EXPECT_NE(contents.warnings[0].find("cut short"), std::string::npos);
    expect_refused(file, ":4: announces 2 atoms, but only 1 rows follow", "cut", 1);
}

// ---- SDF ----

TEST(SdfReader, ReturnsTheMoleculeThatIsAskedFor) {
    const TemporaryFolder folder;
    std::string second(kSdf);
    second.replace(second.find(" O "), 3, " S ");
    const auto file = folder.write("a.sdf", std::string(kSdf) + second + "\n");
    EXPECT_EQ(read_file(file).frames, 2);
    EXPECT_EQ(elements(read_file(file, {.frame = 1})), "CSHH");
}

TEST(SdfReader, NamesTheLineOfWhatIsWrong) {
    const TemporaryFolder folder;
    const auto with = [&](std::string_view old, std::string_view replacement) {
        std::string text = std::string(kSdf) + std::string(kSdf);
        text.replace(text.rfind(old), old.size(), replacement);
        return folder.write("a.sdf", text);
    };
    expect_refused(with("    1.2000", "       nan"), ":19: coordinate x 'nan' is not a number",
                   "repair or remove the atom", 1);
    expect_refused(with("    1.2000", "*********"), ":19: coordinate x", "repair", 1);
    expect_refused(with("    1.2000", "    1e20  "), ":19: coordinate x '1e20' is too large",
                   "repair", 1);
    expect_refused(with(" O   0", "     0"), ":19: the atom has no element", "repair", 1);
    expect_refused(with("  1  4  1", "  1 99  1"), ":24: the bond names atom '99'", "repair", 1);
    expect_refused(with("  4  3", "  5  3"), ":22: coordinate", "repair", 1);
    expect_refused(with("  4  3", " -4  3"), ":17: expected the number of atoms, found '-4'",
                   "repair", 1);
    expect_refused(with("  4  3  0  0  0  0  0  0  0  0999 V2000", "  4"),
                   ":17: the counts line '  4' is too short", "V2000", 1);
    expect_refused(with("  1  4  1  0\nM  END\n$$$$\n", ""),
                   ":23: the molecule ends inside its bonds", "copy the file again", 1);
    EXPECT_EQ(refusal(with("  4  3", "  5  3")), "(it was read)")
        << "only molecule 1 is damaged";
}

TEST(SdfReader, NamesTheLineOfWhatIsWrongInV3000) {
    const TemporaryFolder folder;
    const auto with = [&](std::string_view old, std::string_view replacement) {
        std::string text(kV3000);
        text.replace(text.find(old), old.size(), replacement);
        return folder.write("a.mol", text);
    };
    expect_refused(with("-0.6 0.9", "nan 0.9"), ":11: coordinate x 'nan'", "repair");
    expect_refused(with("COUNTS 4", "COUNTS 3"), ":12: expected END ATOM after 3 atoms", "counts");
    expect_refused(with("COUNTS 4", "COUNTS 5"), ":13: expected an atom", "announces 5 atoms");
    expect_refused(with("COUNTS 4", "COUNTS x"), ":6: expected the number of atoms", "repair");
    expect_refused(with("3 1 1 9", "3 1 1 8"), ":17: the bond names atom '8'", "repair");
    expect_refused(with("M  V30 END ATOM", "END ATOM"), ":13: expected 'M  V30'", "copy");
}

TEST(SdfReader, SpendsNoTimeOnTheChemistryOfLargeMolecules) {
    // Toolkits take a minute to look for stereo centres in this sheet.
    constexpr int kSide = 30;
    std::string atoms;
    std::string bonds;
    for (int i = 0; i < kSide * kSide; ++i) {
        atoms += fmt::format("{:10.4f}{:10.4f}{:10.4f} C   0  0\n", 1.4 * (i / kSide),
                             1.4 * (i % kSide), 0.1 * (i % 7));
        if (i + kSide < kSide * kSide)
            bonds += fmt::format("{:3}{:3}  1  0\n", i + 1, i + 1 + kSide);
    }
    const TemporaryFolder folder;
    const auto file = folder.write(
        "a.sdf", fmt::format("sheet\n\n\n{:3}{:3}  0  0  0  0  0  0  0  0999 V2000\n{}{}M  END\n",
                             kSide * kSide, kSide * (kSide - 1), atoms, bonds));
    EXPECT_EQ(count(read_file(file), "atoms"), 900u);
}

TEST(SdfReader, CallsAtomsThatAreNoElementsUnknown) {
    const TemporaryFolder folder;
    std::string text(kSdf);
    text.replace(text.find(" O   "), 5, " R#  ");
    text.replace(text.find(" H   "), 5, " D   ");
    const FileContents contents = read_file(folder.write("a.sdf", text));
    EXPECT_EQ(elements(contents), "CXxHH");
    EXPECT_EQ(contents.warnings.size(), 1u);
}

TEST(SdfReader, WarnsOfAFlatDrawing) {
    const TemporaryFolder folder;
    std::string text(kSdf);
    text.replace(text.find("0.1000"), 6, "0.0000");
    const FileContents contents = read_file(folder.write("a.sdf", text));
    ASSERT_EQ(contents.warnings.size(), 1u);
    EXPECT_NE(contents.warnings[0].find("flat drawing"), std::string::npos);
}

// ---- Real files ----

struct RealFile {
    const char* name;
    std::uint64_t atoms;
    int frames = 1;
    int frame = 0;
};

TEST(RealMolecules, HaveTheAtomsThatTheirPagesCount) {
    const RealFile files[] = {{"1crn.pdb", 327},
                              {"1crn.cif", 327},
                              {"1crn.gro", 327},
                              {"1a80.pqr", 1301},
                              {"cod_1544173.cif", 50},
                              {"imatinib.mol2", 68},
                              {"acetaminophen_gen3d.mol2", 20},
                              {"lysozyme.gro", 1960, 3, 2},
                              {"1d66_dna_protein.pdb", 1762},
                              {"1ffk_ribosome50S.cif.gz", 64281},
                              {"1rb8_capsid_asu.pdb.gz", 5112},
                              {"4hhb.cif.gz", 4779},
                              {"4hhb.pdb", 4779},
                              {"MOF-5.pdb", 65},
                              {"acetaminophen_4a9k_TYL.sdf", 20},
                              {"acetaminophen_gen3d.pdb", 20},
                              {"acetaminophen_gen3d.sdf", 20},
                              {"acetaminophen_gen3d.xyz", 20},
                              {"aspirin.sdf", 21},
                              {"caffeine_3rfm_CFF.sdf", 24},
                              {"caffeine_3rfm_CFF.xyz", 24},
                              {"extended_frames.xyz", 192, 3, 0},
                              {"extended_frames.xyz", 62, 3, 1},
                              {"extended_frames.xyz", 8, 3, 2},
                              {"helium_traj.xyz.gz", 125, 397, 396},
                              {"md_traj_51models.pdb.gz", 183, 51, 50},
                              {"trajectory_small.xyz", 9, 2, 1}};
    if (!std::filesystem::exists(data_file("molecules"))) GTEST_SKIP() << "no real files here";
    for (const RealFile& file : files) {
        SCOPED_TRACE(file.name);
        // Of the atoms of the PQR file, 382 have a radius of 0.
        const DataSettings all{.radius = std::string_view(file.name).ends_with("pqr") ? "1" : ""};
        const FileContents contents =
            read_file(data_file("molecules") / file.name, {.frame = file.frame, .data = all});
        EXPECT_EQ(spheres(contents).spheres.size(), file.atoms);
        EXPECT_EQ(count(contents, "atoms"), file.atoms);
        EXPECT_EQ(contents.frames, file.frames);
        EXPECT_EQ(std::ranges::count(spheres(contents).colors, element(0).color), 0);
    }
}

TEST(RealMolecules, AgreeBetweenTheFormatsOfOneStructure) {
    const std::filesystem::path folder = data_file("molecules");
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no real files here";
    const auto agree = [&](const char* a, const char* b, double tolerance) {
        SCOPED_TRACE(fmt::format("{} {}", a, b));
        expect_same_spheres(read_file(folder / a), read_file(folder / b), tolerance);
    };
    agree("1crn.pdb", "1crn.cif", 1e-5);
    agree("1crn.pdb", "broken/1crn_no_element_column.pdb", 0);
    agree("1crn.pdb", "1crn.gro", 9e-3);
    agree("acetaminophen_gen3d.xyz", "acetaminophen_gen3d.mol2", 2e-4);
    agree("acetaminophen_gen3d.xyz", "acetaminophen_gen3d.pdb", 2e-3);
    agree("acetaminophen_gen3d.xyz", "acetaminophen_gen3d.sdf", 2e-4);
    agree("caffeine_3rfm_CFF.xyz", "caffeine_3rfm_CFF.sdf", 2e-4);
    const FileContents pdb = read_file(folder / "4hhb.pdb");
    const FileContents mmcif = read_file(folder / "4hhb.cif.gz");
    EXPECT_EQ(count(pdb, "residues"), count(mmcif, "residues"));
    EXPECT_EQ(pdb.objects[0].part_names, mmcif.objects[0].part_names);
}

TEST(RealMolecules, AreRefusedWithAMessageWhereBroken) {
    const std::filesystem::path folder = data_file("molecules/broken");
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no real files here";
    const std::set<std::string> valid{"1crn_no_element_column.pdb", "1crn_unknown_element.pdb",
                                      "coincident.xyz", "odd_start.pdb"};
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::filesystem::path& file = entry.path();
        SCOPED_TRACE(file.filename());
        const std::string message = refusal(file);
        EXPECT_EQ(message == "(it was read)", valid.contains(file.filename())) << message;
    }
}

TEST(RealMolecules, IncludeTheSample) {
    const std::filesystem::path sample = source_dir() / "samples/acetaminophen.xyz";
    const FileContents contents = read_file(sample);
    EXPECT_EQ(count(contents, "atoms"), 20u);
    // Centred, long axis along x, ring facing z.
    Bounds3d box;
    Vec3d sum;
    for (const Vec3d p : positions(contents)) {
        box.add(p);
        sum = sum + p;
    }
    EXPECT_LT(length(sum), 1e-2);
    EXPECT_GT(box.extent().x, 1.5 * box.extent().y);
    EXPECT_GT(box.extent().y, 2.0 * box.extent().z);
}

}  // namespace
}  // namespace ink::test
