#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>

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
using test::spheres;
using test::TemporaryFolder;

std::vector<float> radii(const FileContents& contents) {
    std::vector<float> out;
    for (const Sphere& sphere : spheres(contents).spheres) out.push_back(sphere.radius);
    return out;
}

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
    for (const std::string_view types : {"1 1", "1 1.5", "1 nan", "sand clay", "1 clay"}) {
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
    // Words are refused where numbers are asked for.
    expect_refused(folder.write("c.csv", "x,y,z,type\n0,0,0,sand\n"), "column 'type' is 'sand'",
                   {.data = {.color_by = "type"}});
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

// ---- VTK ----

constexpr std::array<float, 6> kPlaces{1, 2, 3, -4, 5.5F, 6};
constexpr std::array<double, 2> kRadii{0.5, 0.25};

template <class T, std::size_t N>
std::string raw(const std::array<T, N>& values, bool swap = false) {
    std::string bytes;
    for (const T value : values) {
        auto one = std::bit_cast<std::array<char, sizeof(T)>>(value);
        if (swap) std::ranges::reverse(one);
        bytes.append(one.data(), one.size());
    }
    return bytes;
}

std::string number(std::uint32_t value, bool swap = false) {
    return raw(std::array<std::uint32_t, 1>{value}, swap);
}

std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        const std::size_t count = std::min<std::size_t>(bytes.size() - i, 3);
        for (std::size_t k = 0; k < 3; ++k) {
            group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            text += k <= count ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
        }
    }
    return text;
}

/// Blocks of `block` bytes, each deflated on its own: header and data.
std::pair<std::string, std::string> deflated(std::string_view bytes, std::size_t block) {
    const std::size_t blocks = (bytes.size() + block - 1) / block;
    std::string header = number(static_cast<std::uint32_t>(blocks)) +
                         number(static_cast<std::uint32_t>(block)) +
                         number(static_cast<std::uint32_t>(bytes.size() % block));
    std::string data;
    for (std::size_t b = 0; b < blocks; ++b) {
        const std::string_view part = bytes.substr(b * block, block);
        std::string packed(compressBound(part.size()), '\0');
        uLongf size = packed.size();
        compress(reinterpret_cast<Bytef*>(packed.data()), &size,
                 reinterpret_cast<const Bytef*>(part.data()), part.size());
        header += number(static_cast<std::uint32_t>(size));
        data += packed.substr(0, size);
    }
    return {header, data};
}

std::string vtk(std::string_view type, std::string_view attributes, std::string_view format,
                std::string_view radii_text, std::string_view places_text,
                std::string_view appended = {}, std::string_view count = "2") {
    return fmt::format(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"{0}\" {1}>\n<{0}><Piece NumberOfPoints=\"{6}\">\n"
        "<PointData><DataArray type=\"Float64\" Name=\"radius\" {2}>{3}</DataArray></PointData>\n"
        "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" "
        "{4}>{5}</DataArray></Points>\n"
        "</Piece></{0}>{7}</VTKFile>\n",
        type, attributes, format, radii_text, format, places_text, count, appended);
}

TEST(VtkReader, ReadsTheSamePointsFromEveryEncoding) {
    const TemporaryFolder folder;
    const std::string r = raw(kRadii);
    const std::string p = raw(kPlaces);
    const auto [r_head, r_data] = deflated(r, 10);
    const auto [p_head, p_data] = deflated(p, 10);
    constexpr std::string_view kLittle = "byte_order=\"LittleEndian\"";
    const std::string zlib = std::string(kLittle) + " compressor=\"vtkZLibDataCompressor\"";
    const auto appended = [&](std::string_view encoding, const std::string& radii_bytes,
                              const std::string& places_bytes, std::string_view attributes) {
        std::string text = vtk("PolyData", attributes, "format=\"appended\" offset=\"0\"", "", "",
                               fmt::format("<AppendedData encoding=\"{}\">\n  _", encoding));
        const std::string second = fmt::format("offset=\"{}\"", radii_bytes.size());
        text.replace(text.rfind("offset=\"0\""), 10, second);
        const std::size_t end = text.find("</VTKFile>");
        return text.insert(end, radii_bytes + places_bytes + "\n</AppendedData>");
    };
    const std::map<std::string, std::string> files{
        {"ascii.vtp", vtk("PolyData", kLittle, "format=\"ascii\"", "0.5\n 0.25", "1 2 3 -4 5.5 6")},
        {"ascii.vtu",
         vtk("UnstructuredGrid", kLittle, "format=\"ascii\"", "0.5 0.25", "1 2 3 -4 +5.5 6e0")},
        {"base64.vtp",
         vtk("PolyData", kLittle, "format=\"binary\"", fmt::format("\n{}", base64(number(16) + r)),
             base64(number(24) + p) + "\n")},
        {"zlib.vtp", vtk("PolyData", zlib, "format=\"binary\"", base64(r_head) + base64(r_data),
                         base64(p_head) + base64(p_data))},
        {"raw.vtp", appended("raw", number(16) + r, number(24) + p, kLittle)},
        {"big.vtp", appended("raw", number(16, true) + raw(kRadii, true),
                             number(24, true) + raw(kPlaces, true), "byte_order=\"BigEndian\"")},
        {"rawzlib.vtp", appended("raw", r_head + r_data, p_head + p_data, zlib)},
        {"appended64.vtp",
         appended("base64", base64(number(16) + r), base64(number(24) + p), kLittle)},
        {"wide.vtp", appended("raw", raw(std::array<std::uint64_t, 1>{16}) + r,
                              raw(std::array<std::uint64_t, 1>{24}) + p,
                              std::string(kLittle) + " header_type=\"UInt64\"")}};
    for (const auto& [name, text] : files) {
        SCOPED_TRACE(name);
        const FileContents contents = read_file(folder.write(name, text));
        EXPECT_EQ(positions(contents), (std::vector<Vec3d>{{1, 2, 3}, {-4, 5.5, 6}}));
        EXPECT_EQ(radii(contents), (std::vector<float>{0.5F, 0.25F}));
    }
}

TEST(VtkReader, RefusesDataThatDoNotHoldWhatIsAnnounced) {
    const TemporaryFolder folder;
    const auto ascii = [&](std::string_view radii_text, std::string_view count) {
        return folder.write(
            "a.vtp", vtk("PolyData", "", "format=\"ascii\"", radii_text, "1 2 3 4 5 6", {}, count));
    };
    expect_refused(ascii("1  ", "2"), "array 'radius' has 1 of 2 numbers");
    expect_refused(ascii("1 x", "2"), "no number in place 2");
    expect_refused(ascii("1 1", "999999999"), "fewer numbers than it announces");
    expect_refused(ascii("1 1", "-3"), "a piece has '-3' points");
    expect_refused(ascii("1 1", "0"), "holds no particles");
    expect_refused(
        folder.write("b.vtp", vtk("PolyData", "", "format=\"appended\" offset=\"99\"", "", "")),
        "begins after the end of the data");
    expect_refused(folder.write("c.vtp", "<VTKFile type=\"PolyData\"><PolyData>"),
                   "was it written");
    expect_refused(folder.write("d.vtp", vtk("ImageData", "", "format=\"ascii\"", "1 1", "")),
                   "holds 'ImageData'");
    expect_refused(folder.write("e.vtp", vtk("PolyData", "compressor=\"vtkLZ4DataCompressor\"",
                                             "format=\"binary\"", "", "")),
                   "compressed by 'vtkLZ4DataCompressor'");
}

TEST(VtkReader, SetsNoMemoryAsideForBlocksThatLie) {
    const TemporaryFolder folder;
    const std::string lie =
        base64(number(1) + number(0xF0000000U) + number(0) + number(8)) + base64("12345678");
    const auto file = folder.write("a.vtp", vtk("PolyData", "compressor=\"vtkZLibDataCompressor\"",
                                                "format=\"binary\"", lie, lie, {}, "300000000"));
    expect_refused(file, "block of no sense");
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

// ---- Glyphs ----

const Glyphs& glyphs(const FileContents& contents) {
    return std::get<Glyphs>(contents.objects.at(0).shape);
}

FileContents read_glyphs(const std::filesystem::path& file, Glyph glyph, std::string field = {}) {
    return read_file(file, {.data = {.glyph = glyph, .glyph_field = std::move(field)}});
}

/// Half axes of particle `i`: x, y, z of each.
std::vector<float> axes(const FileContents& contents, std::size_t i = 0) {
    const Placement& p = glyphs(contents).placements.at(i);
    return {p.x_axis.x, p.x_axis.y, p.x_axis.z, p.y_axis.x, p.y_axis.y,
            p.y_axis.z, p.z_axis.x, p.z_axis.y, p.z_axis.z};
}

void expect_near(const std::vector<float>& a, const std::vector<float>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-6) << k;
}

TEST(ParticleGlyphs, HaveTheColumnsOfTheDeformationGradientAsAxes) {
    const TemporaryFolder folder;
    const auto file = folder.write(
        "a.csv", "x,y,z,r,F11,F12,F13,F21,F22,F23,F31,F32,F33\n5,6,7,2,1,2,3,4,5,6,7,8,10\n");
    const FileContents contents = read_glyphs(file, Glyph::box);
    EXPECT_EQ(glyphs(contents).shape.kind, GlyphKind::box);
    EXPECT_EQ(axes(contents), (std::vector<float>{2, 8, 14, 4, 10, 16, 6, 12, 20}));
    EXPECT_EQ(contents.objects[0].frame.to_world(glyphs(contents).placements[0].origin),
              (Vec3d{5, 6, 7}));
    EXPECT_EQ(glyphs(read_glyphs(file, Glyph::ellipsoid)).shape.kind, GlyphKind::ellipsoid);
}

TEST(ParticleGlyphs, KnowTensorsByTheirColumnsInAnyOrderAndSpelling) {
    const TemporaryFolder folder;
    const std::vector<float> stretched{2, 0, 0, 0, 3, 0, 0, 0, 4};
    const auto expect = [&](std::string_view name, std::string_view text) {
        SCOPED_TRACE(text);
        expect_near(axes(read_glyphs(folder.write(name, text), Glyph::box)), stretched);
    };
    expect("a.csv", "x,y,z,r,f33,f22,f11,f12,f13,f21,f23,f31,f32\n0,0,0,1,4,3,2,0,0,0,0,0,0\n");
    expect("b.csv", "x,y,z,r,F_xx,F_yy,F_zz,F_xy,F_yz,F_xz\n0,0,0,1,2,3,4,0,0,0\n");
    expect("c.csv", "x,y,z,r,F:0,F:1,F:2,F:3,F:4,F:5,F:6,F:7,F:8\n0,0,0,1,2,0,0,0,3,0,0,0,4\n");
    expect("d.ply",
           "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
           "property float z\nproperty float radius\nproperty float Fxx\nproperty float Fyy\n"
           "property float Fzz\nproperty float Fxy\nproperty float Fyz\nproperty float Fxz\n"
           "end_header\n0 0 0 1 2 3 4 0 0 0\n");
}

TEST(ParticleGlyphs, InThePlaneKeepTheirThickness) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.csv", "x,y,z,r,F11,F12,F21,F22\n0,0,0,2,1,2,3,4\n");
    EXPECT_EQ(axes(read_glyphs(file, Glyph::box)), (std::vector<float>{2, 6, 0, 4, 8, 0, 0, 0, 2}));
}

TEST(ParticleGlyphs, AreTurnedByQuaternionsAndHaveTheDiametersOfLammps) {
    const TemporaryFolder folder;
    // A quarter turn about z: x goes to y, y to -x. The quaternion need not be of unit length.
    const auto file = folder.write(
        "a.dump",
        "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n0 1\n0 1\n0 1\n"
        "ITEM: ATOMS id x y z quatw quati quatj quatk shapex shapey shapez\n"
        "1 0 0 0 2 0 0 2 2 4 6\n");
    const FileContents contents = read_glyphs(file, Glyph::ellipsoid);
    expect_near(axes(contents), {0, 1, 0, -2, 0, 0, 0, 0, 3});
    EXPECT_TRUE(contents.warnings.empty());
}

TEST(ParticleGlyphs, TakeTheFieldThatIsNamed) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.csv",
                                   "x,y,z,r,s1,c_a[1],c_a[2],c_a[3],c_a[4],c_a[5],c_a[6]\n"
                                   "0,0,0,1,7,2,3,4,0,0,0\n");
    expect_near(axes(read_glyphs(file, Glyph::box, "c_a")), {2, 0, 0, 0, 3, 0, 0, 0, 4});
    const auto named = [](const char* field) {
        return ReadOptions{.data = {.glyph = Glyph::box, .glyph_field = field}};
    };
    expect_refused(file, "has 1 components", named("s1"));
    expect_refused(file, "there is no field 'F'", named("F"));
}

TEST(ParticleGlyphs, OfVtkAreArraysOfNineComponents) {
    const TemporaryFolder folder;
    const auto file =
        folder.write("a.vtp",
                     R"(<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="1"><Points>
<DataArray type="Float32" NumberOfComponents="3" format="ascii">1 2 3</DataArray></Points><PointData>
<DataArray type="Float32" Name="F" NumberOfComponents="9" format="ascii">1 2 3 4 5 6 7 8 10</DataArray>
<DataArray type="Float32" Name="Orientation" NumberOfComponents="4" format="ascii">0 0 1 1</DataArray>
</PointData></Piece></PolyData></VTKFile>)");
    const auto read = [&](std::string field) {
        return axes(read_file(
            file, {.data = {.radius = "1", .glyph = Glyph::box, .glyph_field = std::move(field)}}));
    };
    EXPECT_EQ(read("F"), (std::vector<float>{1, 4, 7, 2, 5, 8, 3, 6, 10}));
    expect_near(read("Orientation"), {0, 1, 0, -1, 0, 0, 0, 0, 1});
}

TEST(ParticleGlyphs, WithoutVolumeAreLeftOut) {
    const TemporaryFolder folder;
    const std::string names = "x,y,z,r,Fxx,Fyy,Fzz,Fxy,Fyz,Fxz\n";
    const auto file = folder.write("a.csv", names +
                                                "0,0,0,1,1,1,1,0,0,0\n1,0,0,1,1,1,0,0,0,0\n"
                                                "2,0,0,1,nan,1,1,0,0,0\n3,0,0,1,1e30,1,1,0,0,0\n");
    const FileContents contents = read_glyphs(file, Glyph::ellipsoid);
    EXPECT_EQ(glyphs(contents).placements.size(), 1U);
    ASSERT_EQ(contents.warnings.size(), 1U);
    EXPECT_NE(contents.warnings[0].find("3 of 4 particles"), std::string::npos);
    expect_refused(folder.write("b.csv", names + "0,0,0,1,0,0,0,0,0,0\n"),
                   "no particle has a finite place and a positive",
                   {.data = {.glyph = Glyph::box}});
}

TEST(ParticleGlyphs, WithoutATensorAreAllAlikeAndSaySo) {
    const TemporaryFolder folder;
    const FileContents contents =
        read_glyphs(folder.write("a.csv", "x,y,z,r\n0,0,0,2\n"), Glyph::box);
    EXPECT_EQ(axes(contents), (std::vector<float>{2, 0, 0, 0, 2, 0, 0, 0, 2}));
    ASSERT_EQ(contents.warnings.size(), 1U);
    EXPECT_NE(contents.warnings[0].find("all glyphs are alike"), std::string::npos);
}

}  // namespace
}  // namespace ink
