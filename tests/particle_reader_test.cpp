#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "io/reader.h"
#include "read_contents.h"
#include "scene/colormap.h"
#include "scene/particles.h"
#include "test_files.h"

namespace ink {
namespace {

using test::data_file;
using test::expect_refused;
using test::positions;
using test::radii;
using test::spheres;
using test::TemporaryFolder;

const FieldSummary& field(const FileContents& contents, std::string_view name) {
    return *std::ranges::find(contents.fields, name, &FieldSummary::name);
}

// ---- Tables ----

TEST(TableReader, FindsColumnsByNameWhateverSeparatesThem) {
    const TemporaryFolder folder;
    const auto expect_two = [&](std::string_view name, std::string_view text) {
        SCOPED_TRACE(text);
        const FileContents contents = read_file(folder.write(name, text));
        EXPECT_EQ(positions(contents), (std::vector<Vec3d>{{1, 2, 3}, {-4, 5.5, 6}}));
        EXPECT_EQ(radii(contents), (std::vector<float>{0.5F, 0.25F}));
    };
    expect_two("a.csv", "id,x,y,z,radius\n7,1,2,3,0.5\n8,-4,5.5,6,0.25\n");
    expect_two("b.csv", "\"Z [mm]\";X (mm);\"y\";r\r\n3;1;2;.5\r\n6;-4;5.5;.25\r\n");
    expect_two("c.tsv", "diameter\tx\ty\tz\n1\t1\t2\t3\n5e-1\t-4\t+5.5\t6\n");
    expect_two("d.txt", "# made by hand\n# x y z radius\n1 2 3 0.5\n\n -4   5.5 6  0.25\n");
    expect_two("e.csv", "radius,Points:0,Points:1,Points:2\n0.5,1,2,3\n0.25,-4,5.5,6");
}

TEST(TableReader, TakesColumnsWithoutNamesInOrderAndSaysSo) {
    const TemporaryFolder folder;
    const FileContents contents = read_file(folder.write("a.csv", "0,0,0,1\n1,0,0,0.5\n"));
    EXPECT_EQ(radii(contents), (std::vector<float>{1, 0.5F}));
    ASSERT_EQ(contents.warnings.size(), 1U);
    EXPECT_NE(contents.warnings[0].find("no line of names"), std::string::npos);
}

TEST(TableReader, ReadsTheCountThatCbGeoWritesFirst) {
    const TemporaryFolder folder;
    const FileContents contents = read_file(folder.write("a.txt", "2\n0\t0\t0\n0\t0\t3\n"));
    EXPECT_EQ(spheres(contents).spheres.size(), 2U);
    ASSERT_EQ(contents.warnings.size(), 1U);
    EXPECT_NE(contents.warnings[0].find("1.5 was chosen"), std::string::npos);
    const FileContents lies = read_file(folder.write("b.txt", "5\n0 0 0\n0 0 3\n"));
    EXPECT_NE(lies.warnings[0].find("announces 5 particles, 2 follow"), std::string::npos);
}

TEST(TableReader, NamesTheRowThatIsWrong) {
    const TemporaryFolder folder;
    expect_refused(folder.write("a.csv", "x,y,z\n0,0,0\n1,0\n"), ":3: the row has 2 of 3 columns");
    expect_refused(folder.write("b.csv", "x,y,z\n0,0,0\n1,up,0\n"), ":3: column 'y' is 'up'");
    expect_refused(folder.write("c.csv", "x,y,radius\n0,0,1\n"), "no column 'z'");
    expect_refused(folder.write("d.csv", "x,y,z\n"), "holds no particles");
    expect_refused(folder.write("e.txt", "hello\n"), ":1: expected columns x, y and z");
}

TEST(TableReader, LeavesOutParticlesWithoutAPlaceOrASize) {
    const TemporaryFolder folder;
    const FileContents contents = read_file(folder.write(
        "a.csv",
        "x,y,z,radius\n0,0,0,1\nnan,0,0,1\n0,inf,0,1\n1,0,0,-1\n2,0,0,0\n3,0,0,1e30\n5,0,0,2\n"));
    EXPECT_EQ(positions(contents), (std::vector<Vec3d>{{0, 0, 0}, {5, 0, 0}}));
    EXPECT_NE(contents.warnings.at(0).find("5 of 7 particles"), std::string::npos);
    expect_refused(folder.write("b.csv", "x,y,z\nnan,0,0\n"), "no particle has a finite place");
}

// ---- What is drawn ----

constexpr std::string_view kTable =
    "x,y,z,radius,vx,vy,vz,type,s[1],s[2]\n0,0,0,1,3,4,0,2,1,9\n2,0,0,1,0,0,1,1,2,9\n"
    "4,0,0,1,0,0,3,2,4,9\n";

TEST(Particles, TakeColoursFromAnyFieldOrVector) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.csv", kTable);
    const auto colors = [&](const DataSettings& data) {
        return spheres(read_file(file, {.data = data})).colors;
    };
    const ColorMap& viridis = *find_color_map("viridis");
    EXPECT_TRUE(colors({.color_by = "none"}).empty());
    EXPECT_EQ(colors({.color_by = "vz"})[0], viridis.at(0));
    EXPECT_EQ(colors({.color_by = "vz"})[2], viridis.at(1));
    // Lengths 5, 1 and 3.
    EXPECT_EQ(colors({.color_by = "v"}),
              (std::vector<Rgb8>{viridis.at(1), viridis.at(0), viridis.at(512.0 / 1023)}));
    EXPECT_EQ(colors({.color_by = "v.z"}), colors({.color_by = "vz"}));
    EXPECT_EQ(colors({.color_by = "s[1]", .color_range = std::pair{1.0, 2.0}})[2], viridis.at(1));
    EXPECT_EQ(colors({.color_by = "s"}).size(), 3U);
    expect_refused(file, "--color-by: there is no field 'mass'", {.data = {.color_by = "mass"}});
}

TEST(Particles, OfSeveralKindsHaveAColourEach) {
    const TemporaryFolder folder;
    const auto expect_kinds = [&](std::string_view name, std::string_view text) {
        SCOPED_TRACE(text);
        for (const bool facts : {false, true}) {
            const FileContents contents = read_file(folder.write(name, text), {.facts = facts});
            EXPECT_EQ(spheres(contents).colors,
                      (std::vector<Rgb8>{category_color(3), category_color(1), category_color(3)}));
            ASSERT_EQ(contents.names.size(), 1U);
            EXPECT_EQ(contents.names[0].first, "types");
            EXPECT_EQ(contents.names[0].second, (std::vector<std::string>{"1", "3"}));
            EXPECT_EQ(contents.objects[0].color_scale->title, "type");
        }
    };
    expect_kinds("a.csv", "x,y,z,type\n0,0,0,3\n1,0,0,1\n2,0,0,3\n");
    expect_kinds(
        "a.dump",
        "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n3\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n"
        "0 9\nITEM: ATOMS id type x y z\n1 3 0 0 0\n2 1 1 0 0\n3 3 2 0 0\n");
    expect_kinds("a.xyz", "3\nProperties=type:I:1:pos:R:3\n3 0 0 0\n1 1 0 0\n3 2 0 0\n");
    expect_kinds("a.vtp",
                 "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"3\"><Points>"
                 "<DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">"
                 "0 0 0 1 0 0 2 0 0</DataArray></Points><PointData>"
                 "<DataArray type=\"Int32\" Name=\"type\" format=\"ascii\">3 1 3</DataArray>"
                 "</PointData></Piece></PolyData></VTKFile>");
    expect_kinds("a.ply",
                 "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                 "property float z\nproperty int type\nend_header\n0 0 0 3\n1 0 0 1\n2 0 0 3\n");
}

TEST(Particles, HaveOneColourWhereTypesTellNoKindsApart) {
    const TemporaryFolder folder;
    for (const std::string_view types : {"1 1", "1 1.5", "1 nan", "sand sand", "1 clay"}) {
        SCOPED_TRACE(types);
        const auto file = folder.write("a.txt", fmt::format("x y z type\n0 0 0 {}\n1 0 0 {}\n",
                                                            types.substr(0, types.find(' ')),
                                                            types.substr(types.find(' ') + 1)));
        EXPECT_TRUE(spheres(read_file(file)).colors.empty());
        EXPECT_TRUE(spheres(read_file(file, {.facts = true})).colors.empty());
    }
    std::string names = "x,y,z,type\n";
    for (int k = 0; k < 100; ++k) names += fmt::format("{},0,0,{}\n", k, k);
    EXPECT_TRUE(spheres(read_file(folder.write("b.csv", names))).colors.empty());
}

TEST(Particles, HaveAColourForEachWordInTheirOrderAndNumbersWhereNumbersAreNeeded) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.csv",
                                   "x,y,z,type,heat\n0,0,0,sand,1\n1,0,0,\"clay\",2\n2,0,0,sand,3\n"
                                   "3,0,0,wet sand,4\n");
    const std::vector<Rgb8> colors{category_color(1), category_color(0), category_color(1),
                                   category_color(2)};
    for (const DataSettings& data : {DataSettings{}, DataSettings{.color_by = "type"}}) {
        for (const bool facts : {false, true}) {
            const FileContents contents = read_file(file, {.data = data, .facts = facts});
            EXPECT_EQ(spheres(contents).colors, colors);
            const auto& entries = contents.objects[0].color_scale->entries;
            ASSERT_EQ(entries.size(), 3U);
            EXPECT_EQ(entries[0].name, "clay");
            EXPECT_EQ(entries[2].name, "wet sand");
            if (!facts) continue;
            const Facts told = contents.objects[0].facts(3);
            EXPECT_NE(
                std::ranges::find(told, std::pair<std::string, std::string>("type", "wet sand")),
                told.end());
        }
    }
    const FileContents parts = read_file(file, {.data = {.parts = "type"}});
    EXPECT_EQ(parts.objects[0].part_names, (std::vector<std::string>{"clay", "sand", "wet sand"}));
    expect_refused(file, "column 'type' is 'sand', not a number; choose a column",
                   {.data = {.radius = "type"}});
    expect_refused(folder.write("b.csv", "x,y,z,heat\n0,0,0,NA\n1,0,0,2.5\n"),
                   "column 'heat' is '2.5', a number among words", {.data = {.color_by = "heat"}});
    expect_refused(folder.write("c.csv", "x,y,z,heat\n0,0,0,2.5\n1,0,0,NA\n"),
                   "column 'heat' is 'NA', not a number", {.data = {.color_by = "heat"}});
}

TEST(Particles, OfAnExtendedXyzWithoutElementsAreThoseOfATable) {
    const TemporaryFolder folder;
    const auto file = folder.write(
        "a.xyz", "2\nProperties=id:I:1:pos:R:3:name:S:1:v:R:3\n1 0 0 0 a 3 4 0\n2 0 0 5 b 0 0 1\n");
    const FileContents contents = read_file(file, {.data = {.color_by = "v"}});
    EXPECT_EQ(contents.objects[0].kind, ObjectKind::particles);
    EXPECT_EQ(positions(contents), (std::vector<Vec3d>{{0, 0, 0}, {0, 0, 5}}));
    EXPECT_EQ(radii(contents), (std::vector<float>{2.5F, 2.5F}));  // they touch
    EXPECT_EQ(spheres(contents).colors[0], find_color_map("viridis")->at(1));
    expect_refused(folder.write("b.xyz", "1\nProperties=id:I:1:pos:R:3\n1 0 0\n"),
                   ":3: the row has 3 of 4 columns");
}

TEST(Particles, TakeRadiiFromAFieldANumberOrTheirNeighbours) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.csv", kTable);
    EXPECT_EQ(radii(read_file(file, {.data = {.radius = "0.25"}}))[0], 0.25F);
    EXPECT_EQ(radii(read_file(file, {.data = {.radius = "type"}}))[0], 2.0F);
    const auto bare = folder.write("b.csv", "x,y,z\n0,0,0\n3,0,0\n6,0,0\n9,0,0\n");
    EXPECT_EQ(radii(read_file(bare))[0], 1.5F);
}

TEST(Particles, AreCutByABoxAndGroupedByAField) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.csv", kTable);
    const ClipBox box{.lower = {1, -1, -1}, .upper = {9, 1, 1}};
    const FileContents contents =
        read_file(file, {.data = {.clip = box, .color_by = "vz", .parts = "type"}});
    EXPECT_EQ(positions(contents), (std::vector<Vec3d>{{2, 0, 0}, {4, 0, 0}}));
    EXPECT_EQ(spheres(contents).parts, (std::vector<std::uint32_t>{0, 1}));
    EXPECT_EQ(contents.objects[0].part_names, (std::vector<std::string>{"1", "2"}));
    EXPECT_EQ(spheres(contents).colors.size(), 2U);
    const ClipBox nowhere{.lower = {50, 50, 50}};
    expect_refused(file, "--clip: no particle is inside the box", {.data = {.clip = nowhere}});
}

TEST(Particles, ListTheirFieldsWithRangesWhenAsked) {
    const TemporaryFolder folder;
    const FileContents contents = read_file(folder.write("a.csv", kTable), {.summarize = true});
    EXPECT_EQ(contents.fields.size(), 7U);
    EXPECT_EQ(field(contents, "vy").most, 4.0);
    EXPECT_EQ(field(contents, "type").least, 1.0);
}

TEST(TouchingRadius, IsHalfTheSpacingOfALatticeInAnyNumberOfDimensions) {
    for (const int dimensions : {1, 2, 3}) {
        std::vector<Vec3f> lattice;
        const int y_end = dimensions > 1 ? 12 : 1;
        const int z_end = dimensions > 2 ? 12 : 1;
        for (int x = 0; x < 12; ++x) {
            for (int y = 0; y < y_end; ++y) {
                for (int z = 0; z < z_end; ++z) {
                    lattice.push_back(Vec3f{float(x), float(y), float(z)} * 1e-6F);
                }
            }
        }
        EXPECT_NEAR(touching_radius(lattice), 0.5e-6, 1e-12) << dimensions;
    }
    EXPECT_GT(touching_radius(std::vector<Vec3f>(1000, Vec3f{1, 2, 3})), 0.0);
    EXPECT_GT(touching_radius({{0, 0, 0}}), 0.0);
    // Places that are none, and distances that only a double can divide by.
    EXPECT_NEAR(touching_radius({{0, 0, 0}, {NAN, 0, 0}, {2, 0, 0}, {0, INFINITY, 0}}), 1.0, 1e-6);
    EXPECT_GT(touching_radius({{0, 0, 0}, {1e-44F, 0, 0}, {0, 1e-44F, 0}}), 0.0);
}

// ---- LAMMPS ----

std::string dump(std::string_view box, std::string_view columns, std::string_view rows,
                 int atoms = 2) {
    return fmt::format(
        "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{}\nITEM: BOX BOUNDS {}\nITEM: ATOMS {}\n{}",
        atoms, box, columns, rows);
}

constexpr std::string_view kBox = "pp pp pp\n-1 1\n0 10\n0 4";

TEST(LammpsReader, ReadsPlainAndUnwrappedCoordinates) {
    const TemporaryFolder folder;
    for (const char* columns : {"id x y z", "id xu yu zu"}) {
        const FileContents contents =
            read_file(folder.write("a.dump", dump(kBox, columns, "1 0.5 1 2\n2 1 2 3\n")));
        EXPECT_EQ(positions(contents), (std::vector<Vec3d>{{0.5, 1, 2}, {1, 2, 3}}));
    }
}

TEST(LammpsReader, PutsScaledCoordinatesIntoTheBox) {
    const TemporaryFolder folder;
    const FileContents contents =
        read_file(folder.write("a.dump", dump(kBox, "xs ys zs id", "0.5 0.5 0.5 1\n0 1 0.25 2\n")));
    EXPECT_EQ(positions(contents), (std::vector<Vec3d>{{0, 5, 2}, {-1, 10, 1}}));
}

TEST(LammpsReader, TiltsATriclinicBox) {
    const TemporaryFolder folder;
    // A cube of side 2 at the origin, tilted by xy = 1: its bounding box reaches from 0 to 3.
    const auto file = folder.write(
        "a.dump", dump("xy xz yz pp pp pp\n0 3 1\n0 2 0\n0 2 0", "xs ys zs", "0 1 0\n0.5 0.5 1\n"));
    EXPECT_EQ(positions(read_file(file)), (std::vector<Vec3d>{{1, 2, 0}, {1.5, 1, 2}}));
}

TEST(LammpsReader, ReturnsTheFrameThatIsAskedFor) {
    const TemporaryFolder folder;
    const std::string first = dump(kBox, "x y z radius", "0 0 0 1\n1 0 0 1\n");
    const std::string second = dump(kBox, "x y z radius", "7 0 0 1\n", 1);
    const auto file = folder.write("a.dump", first + second);
    const FileContents contents = read_file(file, {.frame = 1});
    EXPECT_EQ(contents.frames, 2);
    EXPECT_EQ(positions(contents), (std::vector<Vec3d>{{7, 0, 0}}));
    expect_refused(file, "its 2 frames are 0 to 1", {.frame = 2});
}

TEST(LammpsReader, LeavesOutALastFrameThatIsStillBeingWritten) {
    const TemporaryFolder folder;
    const std::string whole = dump(kBox, "x y z radius", "0 0 0 1\n1 0 0 1\n");
    const std::string cut = dump(kBox, "x y z radius", "0 0 0 1\n");
    const FileContents contents = read_file(folder.write("a.dump", whole + cut));
    EXPECT_EQ(contents.frames, 1);
    EXPECT_EQ(contents.warnings.size(), 1U);
    EXPECT_EQ(read_file(folder.write("b.dump", whole + "ITEM: TIMESTEP\n9\n")).frames, 1);
    expect_refused(folder.write("c.dump", cut), ":9: the frame announces 2 atoms, but only 1 rows");
}

TEST(LammpsReader, NamesTheLineThatIsWrong) {
    const TemporaryFolder folder;
    expect_refused(folder.write("a.dump", dump(kBox, "x y", "0 0\n1 0\n")), "no column 'z'");
    expect_refused(folder.write("b.dump", dump(kBox, "x y z", "0 0 0\n1 0\n")),
                   ":11: the row has 2 of 3 columns");
    expect_refused(
        folder.write("c.dump", dump("pp pp pp\nDUMMY\n0 1\n0 1", "xs ys zs", "0 0 0\n1 0 0\n")),
        ":6: the bounds of the box 'DUMMY' are not numbers");
    expect_refused(folder.write("d.dump", "ITEM: NUMBER OF ATOMS\nmany\n"),
                   ":2: expected a number");
    expect_refused(folder.write("e.dump", "hello\n"), ":1: expected an 'ITEM:' line");
}

// ---- PLY points ----

TEST(PlyReader, DrawsPointsWithTheirRadiusAndColour) {
    const TemporaryFolder folder;
    const FileContents contents = read_file(folder.write(
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
        "property float z\nproperty float radius\nproperty uchar red\nproperty uchar green\n"
        "property uchar blue\nproperty float mass\nend_header\n1 2 3 0.5 10 20 30 7\n"
        "-4 5.5 6 0.25 40 50 60 8\n"));
    EXPECT_EQ(positions(contents), (std::vector<Vec3d>{{1, 2, 3}, {-4, 5.5, 6}}));
    EXPECT_EQ(radii(contents), (std::vector<float>{0.5F, 0.25F}));
    EXPECT_EQ(spheres(contents).colors, (std::vector<Rgb8>{{10, 20, 30}, {40, 50, 60}}));
}

// ---- Real files ----

TEST(RealParticles, HaveTheCountsThatTheirPagesState) {
    struct RealFile {
        const char* name;
        std::size_t count;
        int frames = 1;
    };
    const RealFile files[] = {{"dem_funnel_rawzlib.vtp", 2000},
                              {"dem_pile10192.vtu", 10192},
                              {"dem_pile10192_points.ply", 10192},
                              {"dem_pile2048.csv", 2048},
                              {"dem_pile2048.vtu", 2048},
                              {"dem_pile2048_extended.xyz", 2048},
                              {"lammps_fcc_Al_dislocation.dump.gz", 32640},
                              {"lammps_funnel_2frames.lammpstrj", 2000, 2},
                              {"lammps_peri_3frames.lammpstrj", 3487, 3},
                              {"lammps_properties.lammpstrj.gz", 4000, 4},
                              {"mpm_cbgeo_cylinder_stresses098.vtp", 5184},
                              {"mpm_cbgeo_cylinder_velocities010.vtp", 5184},
                              {"mpm_cbgeo_dambreak3d_initial.txt.gz", 102'400},
                              {"mpm_karamelo_taylorbar3d_step1600.lammpstrj.gz", 30'780}};
    if (!std::filesystem::exists(data_file("particles"))) GTEST_SKIP() << "no real files here";
    for (const RealFile& file : files) {
        SCOPED_TRACE(file.name);
        const FileContents contents =
            read_file(data_file("particles") / file.name, {.frame = file.frames - 1});
        EXPECT_EQ(spheres(contents).spheres.size(), file.count);
        EXPECT_EQ(contents.frames, file.frames);
    }
}

TEST(RealParticles, AgreeBetweenTheFormatsOfOneRun) {
    const std::filesystem::path folder = data_file("particles");
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no real files here";
    const auto agree = [&](const char* a, const char* b, double tolerance, int frame = 0) {
        SCOPED_TRACE(fmt::format("{} {}", a, b));
        const FileContents one = read_file(folder / a);
        const FileContents two = read_file(folder / b, {.frame = frame});
        const auto p = positions(one);
        const auto q = positions(two);
        ASSERT_EQ(p.size(), q.size());
        double worst = 0.0;
        for (std::size_t i = 0; i < p.size(); ++i) {
            worst = std::max(worst, length(p[i] - q[i]));
            worst = std::max<double>(worst, std::abs(radii(one)[0] - radii(two)[0]));
        }
        EXPECT_LE(worst, tolerance);
    };
    agree("dem_pile2048.csv", "dem_pile2048.vtu", 1e-6);
    agree("dem_pile2048.csv", "dem_pile2048_extended.xyz", 1e-6);
    agree("dem_pile10192.vtu", "dem_pile10192_points.ply", 1e-6);
}

TEST(RealParticles, AreRefusedWithAMessageWhereBroken) {
    const std::filesystem::path folder = data_file("particles/broken");
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no real files here";
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        SCOPED_TRACE(entry.path().filename());
        try {
            EXPECT_GT(read_file(entry.path()).objects.at(0).primitive_count(), 0U);
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(entry.path().string()), std::string::npos);
        }
    }
}

TEST(LammpsReader, WarnsOfABoxThatIsNoneWhereNothingNeedsIt) {
    const TemporaryFolder folder;
    const FileContents contents = read_file(
        folder.write("a.dump",
                     "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n0 1\n"
                     "DUMMY\n0 1\nITEM: ATOMS x y z radius\n1 2 3 1\n"));
    ASSERT_EQ(contents.warnings.size(), 1U);
    EXPECT_TRUE(contents.warnings[0].starts_with("Line 7: the bounds of the box are not numbers"));
}

}  // namespace
}  // namespace ink
