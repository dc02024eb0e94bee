#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "io/reader.h"
#include "mesh_texts.h"
#include "test_files.h"

namespace ink::test {
namespace {

// ---- the same cube in every format -------------------------------------------------------------

constexpr std::array<std::array<float, 3>, 8> kCorners{
    {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}}};
constexpr std::array<std::array<int, 3>, 12> kTriangles{{{0, 2, 1},
                                                         {0, 3, 2},
                                                         {4, 5, 6},
                                                         {4, 6, 7},
                                                         {0, 1, 5},
                                                         {0, 5, 4},
                                                         {1, 2, 6},
                                                         {1, 6, 5},
                                                         {2, 3, 7},
                                                         {2, 7, 6},
                                                         {3, 0, 4},
                                                         {3, 4, 7}}};

std::string place(int corner) {
    const auto& [x, y, z] = kCorners[static_cast<std::size_t>(corner)];
    return std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
}

std::string cube_obj() {
    std::string text;
    for (int i = 0; i < 8; ++i) text += "v " + place(i);
    for (const auto& [a, b, c] : kTriangles) {
        text += "f " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " +
                std::to_string(c + 1) + "\n";
    }
    return text;
}

std::string ply_header(std::string_view format) {
    return "ply\nformat " + std::string(format) +
           " 1.0\ncomment a cube\nelement vertex 8\nproperty float x\nproperty float y\n"
           "property float z\nelement face 12\nproperty list uchar int vertex_indices\n"
           "end_header\n";
}

std::string cube_ascii_ply() {
    std::string text = ply_header("ascii");
    for (int i = 0; i < 8; ++i) text += place(i);
    for (const auto& [a, b, c] : kTriangles) {
        text += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
    }
    return text;
}

template <class T>
void put(std::string& bytes, T value, std::endian order = std::endian::little) {
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (order != std::endian::native) std::ranges::reverse(raw);
    bytes.append(raw.data(), raw.size());
}

std::string cube_binary_ply(std::endian order) {
    std::string bytes =
        ply_header(order == std::endian::little ? "binary_little_endian" : "binary_big_endian");
    for (const auto& corner : kCorners) {
        for (const float x : corner) put(bytes, x, order);
    }
    for (const auto& triangle : kTriangles) {
        put(bytes, std::uint8_t{3}, order);
        for (const int vertex : triangle) put(bytes, vertex, order);
    }
    return bytes;
}

std::string cube_ascii_stl() {
    std::string text = "solid cube\n";
    for (const auto& triangle : kTriangles) {
        text += " facet normal 0 0 0\n  outer loop\n";
        for (const int vertex : triangle) text += "   vertex " + place(vertex);
        text += "  endloop\n endfacet\n";
    }
    return text + "endsolid cube\n";
}

std::string cube_binary_stl(std::string_view comment = "") {
    std::string bytes(comment);
    bytes.resize(80);
    put(bytes, std::uint32_t{12});
    for (const auto& triangle : kTriangles) {
        for (int i = 0; i < 3; ++i) put(bytes, 0.f);
        for (const int vertex : triangle) {
            for (const float x : kCorners[static_cast<std::size_t>(vertex)]) put(bytes, x);
        }
        put(bytes, std::uint16_t{0});
    }
    return bytes;
}

struct CubeFile {
    std::string name, content, format;
};

std::vector<CubeFile> cube_files() {
    return {{"cube.obj", cube_obj(), "OBJ"},
            {"cube.ply", cube_ascii_ply(), "ASCII PLY"},
            {"cube.PLY", cube_binary_ply(std::endian::little), "binary PLY"},
            {"cube.ply", cube_binary_ply(std::endian::big), "binary PLY"},
            {"cube.stl", cube_ascii_stl(), "ASCII STL"},
            {"cube.stl", cube_binary_stl(), "binary STL"},
            {"cube.stl", cube_binary_stl("solid cube"), "binary STL"}};
}

TEST(MeshReaders, GiveTheSameCubeFromEveryFormat) {
    const FileContents expected = read_text_as("cube.obj", cube_obj());
    ASSERT_EQ(mesh_of(expected).vertices.size(), 8u);
    ASSERT_EQ(mesh_of(expected).triangles.size(), 12u);
    for (const CubeFile& file : cube_files()) {
        const FileContents contents = read_text_as(file.name, file.content);
        EXPECT_EQ(contents.format, file.format);
        EXPECT_EQ(contents.objects.at(0).name, "cube");
        EXPECT_EQ(contents.objects.at(0).frame.origin, expected.objects[0].frame.origin);
        EXPECT_EQ(mesh_of(contents).vertices, mesh_of(expected).vertices) << file.format;
        EXPECT_EQ(mesh_of(contents).triangles, mesh_of(expected).triangles) << file.format;
        EXPECT_EQ(mesh_of(contents).corner_normals, mesh_of(expected).corner_normals);
        EXPECT_TRUE(mesh_of(contents).faces.empty());
        EXPECT_TRUE(contents.warnings.empty());
    }
}

TEST(MeshReaders, RefuseOrReadEveryBeginningOfAFile) {
    for (const CubeFile& file : cube_files()) {
        for (std::size_t size = 1; size < file.content.size(); size += 13) {
            try {
                const FileContents contents = read_text_as(file.name, file.content.substr(0, size));
                EXPECT_FALSE(mesh_of(contents).triangles.empty());
            } catch (const InputError& error) {
                EXPECT_NE(std::string(error.what()).find(file.name), std::string::npos);
            }
        }
    }
}

TEST(MeshReaders, SurviveADamagedByteAnywhere) {
    for (const CubeFile& file : cube_files()) {
        for (std::size_t at = 0; at < file.content.size(); at += 11) {
            std::string damaged = file.content;
            damaged[at] = static_cast<char>(damaged[at] ^ (at % 2 == 0 ? 0x81 : 0x13));
            try {
                read_text_as(file.name, damaged);
            } catch (const InputError&) {
            }
        }
    }
}

TEST(MeshReaders, ReadCompressedFiles) {
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path() / "cube.stl.gz";
    const std::string bytes = cube_binary_stl();
    const gzFile out = gzopen(path.c_str(), "wb");
    gzwrite(out, bytes.data(), static_cast<unsigned>(bytes.size()));
    gzclose(out);
    const FileContents contents = read_file(path);
    EXPECT_EQ(contents.objects.at(0).name, "cube");
    EXPECT_EQ(mesh_of(contents).triangles.size(), 12u);
}

TEST(MeshReaders, CountWhatIsLeftAfterWelding) {
    const FileContents contents = read_text_as("cube.stl", cube_binary_stl());
    ASSERT_EQ(contents.counts.size(), 2u);
    EXPECT_EQ(contents.counts[0], (std::pair<std::string, std::uint64_t>("vertices", 8)));
    EXPECT_EQ(contents.counts[1], (std::pair<std::string, std::uint64_t>("triangles", 12)));
}

// ---- PLY ---------------------------------------------------------------------------------------

std::string replaced(std::string text, std::string_view from, std::string_view to) {
    text.replace(text.find(from), from.size(), to);
    return text;
}

TEST(PlyReader, KeepsDoublesFarFromTheOrigin) {
    const FileContents contents =
        read_text_as("a.ply",
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\n"
                     "property double y\nproperty double z\nelement face 1\n"
                     "property list uchar int vertex_index\nend_header\n"
                     "1e9 0 0\n1000000000.001 0 0\n1e9 0.001 0\n3 0 1 2\n");
    EXPECT_NEAR(mesh_of(contents).vertices[1].x, 0.001, 2e-7);
}

TEST(PlyReader, ReadsColoursNormalsAndSkipsTheRest) {
    const FileContents contents = read_text_as(
        "a.ply",
        "ply\r\nformat ascii 1.0\r\nelement camera 1\r\nproperty list uchar float view\r\n"
        "element vertex 3\r\nproperty uchar red\r\nproperty uchar green\r\nproperty uchar blue\r\n"
        "property float x\r\nproperty float y\r\nproperty float z\r\nproperty float quality\r\n"
        "property float nx\r\nproperty float ny\r\nproperty float nz\r\nelement face 1\r\n"
        "property uchar flags\r\nproperty list uchar int vertex_indices\r\nend_header\r\n"
        "2 7 8\r\n1 2 3 0 0 0 0.5 0 1 0\r\n4 5 6 1 0 0 0.5 0 1 0\r\n7 8 9 0 1 0 0.5 0 1 0\r\n"
        "9 3 0 1 2\r\n");
    EXPECT_EQ(mesh_of(contents).colors, (std::vector<Rgb8>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
    EXPECT_EQ(unpack_normal(mesh_of(contents).corner_normals[0][2]), (Vec3f{0, 1, 0}));
}

TEST(MeshReaders, TakeAColourThatIsAskedFor) {
    const TemporaryFolder folder;
    const auto file =
        folder.write("a.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n");
    EXPECT_EQ(mesh_of(read_file(file)).colors.size(), 3U);
    EXPECT_EQ(mesh_of(read_file(file, {.data = {.color_by = "chain"}})).colors.size(), 3U);
    EXPECT_TRUE(read_file(file, {.data = {.color_by = "chain"}}).warnings.empty());
    const FileContents typo = read_file(file, {.data = {.color_by = "steelbleu"}});
    ASSERT_EQ(typo.warnings.size(), 1U);
    EXPECT_TRUE(typo.warnings[0].starts_with("'steelbleu' is no colour")) << typo.warnings[0];
    for (const auto& [word, color] :
         {std::pair{"#0a141e", Rgb8{10, 20, 30}}, {"none", Material().color}}) {
        const FileContents contents = read_file(file, {.data = {.color_by = word}});
        EXPECT_TRUE(mesh_of(contents).colors.empty());
        EXPECT_EQ(contents.objects[0].material.color, color);
    }
}

TEST(PlyReader, NamesThePlaceAndTheRemedy) {
    const auto error = [](std::string_view from, std::string_view to) {
        return error_of("a.ply", replaced(cube_ascii_ply(), from, to));
    };
    EXPECT_EQ(error("float x", "quad x"),
              "a.ply:5: unknown property type 'quad'; expected one of char, uchar, short, ushort, "
              "int, uint, float, double");
    EXPECT_EQ(error("float x", "float w"),
              "a.ply: the vertices have no property 'x'; export the model with x, y and z");
    EXPECT_EQ(error("end_header\n", ""),
              "a.ply:10: unknown header line '0.000000'; expected element, property or end_header");
    EXPECT_EQ(error("element face", "element vertex"),
              "a.ply:8: element 'vertex' is there twice; keep one");
    EXPECT_EQ(error("vertex 8", "vertex 4000000000"),
              "a.ply: the header promises 4000000000 of 'vertex', more than fit in the " +
                  std::to_string(cube_ascii_ply().size() - ply_header("ascii").size()) +
                  " bytes after it; was the file written to the end?");
    EXPECT_EQ(error("3 3 4 7", "3 3 4 8"),
              "a.ply:30: face 11 uses vertex 8, but they go from 0 to 7; the file is damaged: "
              "export it again");
    EXPECT_EQ(error("3 3 4 7", "3 3 -4 7").substr(0, 33), "a.ply:30: face 11 uses vertex -4,");
    EXPECT_EQ(error("3 3 4 7", "3 3 4").substr(0, 61),
              "a.ply:31: the data end or are unreadable in face 12 of 12; wa");
    EXPECT_EQ(error("2.000000 0.000000 0", "2.000000 nan 0").substr(0, 40),
              "a.ply:12: vertex 1 lies at (2, nan, 0), ");
    EXPECT_EQ(error_of("a.ply", "\x89PNG\n"),
              "a.ply: is not a PLY file (its first line is not 'ply'); check the file's name");
    EXPECT_EQ(error_of("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"),
              "a.ply: the header has no 'end_header'; was it written to the end?");
}

// ---- STL ---------------------------------------------------------------------------------------

TEST(StlReader, RefusesACountThatTheFileDoesNotHold) {
    EXPECT_EQ(error_of("a.stl", cube_binary_stl().substr(0, 300)),
              "a.stl: the header promises 12 triangles, the file holds 4; was it written to the "
              "end?");
}

TEST(StlReader, NamesTheLineAndTheRemedy) {
    const auto error = [](std::string_view from, std::string_view to) {
        return error_of("a.stl", replaced(cube_ascii_stl(), from, to));
    };
    EXPECT_EQ(error("vertex 2.0", "vertex a.0"),
              "a.stl:5: vertex with 'a.000000' for a coordinate; expected three numbers");
    EXPECT_EQ(error("vertex 2.000000", "vertex 1e20"),
              "a.stl:5: vertex with a coordinate that is not finite or beyond 1e15; correct it");
    EXPECT_EQ(error("endfacet", ""), "a.stl:15: facet with 6 vertices; expected three");
    EXPECT_EQ(error("endfacet", "endface"),
              "a.stl:8: unknown word 'endface'; expected facet, vertex or endsolid");
    EXPECT_EQ(error_of("a.stl", cube_ascii_stl().substr(0, 120)),
              "a.stl:6: the file ends in a facet; was it written to the end?");
    EXPECT_EQ(error_of("a.stl", "solid\n"), "a.stl: holds no faces; export the model again");
}

TEST(StlReader, WarnsOfAMissingEnd) {
    const FileContents contents =
        read_text_as("a.stl", replaced(cube_ascii_stl(), "endsolid cube\n", ""));
    EXPECT_EQ(contents.warnings.size(), 1u);
}

TEST(StlReader, RefusesUnusablePlaces) {
    std::string bytes = cube_binary_stl();
    const float infinite = std::numeric_limits<float>::infinity();
    std::memcpy(bytes.data() + 84 + 50 + 12, &infinite, sizeof infinite);
    EXPECT_EQ(error_of("a.stl", bytes),
              "a.stl: a corner of triangle 2 lies at (inf, 0, 0), not a usable place; export the "
              "model again");
}

TEST(StlReader, MakesAPartOfEachSolid) {
    const std::string two = cube_ascii_stl() + replaced(cube_ascii_stl(), "cube", "box");
    const FileContents contents = read_text_as("a.stl", two);
    EXPECT_EQ(contents.objects[0].part_names, (std::vector<std::string>{"cube", "box"}));
}

TEST(StlReader, WarnsOfCoordinatesTooCoarseForTheShape) {
    std::string bytes(80, '\0');
    put(bytes, std::uint32_t{1});
    for (const float x : {0.f, 0.f, 0.f, 1e6f, 0.f, 0.f, 1e6f + 1.f, 0.f, 0.f, 1e6f, 1.f, 0.f}) {
        put(bytes, x);
    }
    put(bytes, std::uint16_t{0});
    const FileContents contents = read_text_as("a.stl", bytes);
    ASSERT_EQ(contents.warnings.size(), 1u);
    EXPECT_NE(contents.warnings[0].find("far from the origin"), std::string::npos);
}

// ---- real files --------------------------------------------------------------------------------

#define REQUIRE_DATA(folder) \
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << (folder) << " is not there"

TEST(RealMeshes, HaveTheirKnownTopologyInEveryFormat) {
    const auto folder = data_file("meshes");
    REQUIRE_DATA(folder);
    struct Known {
        std::string_view name;
        std::size_t vertices, triangles;
    };
    for (const Known& known :
         {Known{"fandisk.obj", 2877, 5750}, Known{"fandisk_ascii.ply", 2877, 5750},
          Known{"fandisk.stl", 2877, 5750}, Known{"spot.obj", 2930, 5856},
          Known{"spot_quads.obj", 2930, 5856}, Known{"teapot.obj", 3241, 6320},
          Known{"unit_cube.stl", 8, 12}, Known{"featuretype.stl", 1722, 3476},
          Known{"plate_holes.stl", 618, 1252}, Known{"busted.stl", 1941, 3878},
          Known{"stanford-bunny.ply", 34834, 69451}, Known{"armadillo.ply", 43243, 86482},
          Known{"cycloidal.ply", 21384, 43368}}) {
        const FileContents contents = read_file(folder / known.name);
        EXPECT_EQ(mesh_of(contents).vertices.size(), known.vertices) << known.name;
        EXPECT_EQ(mesh_of(contents).triangles.size(), known.triangles) << known.name;
        EXPECT_EQ(mesh_of(contents).corner_normals.size(), known.triangles) << known.name;
    }
}

TEST(RealMeshes, QuadsAreFaces) {
    const auto folder = data_file("meshes");
    REQUIRE_DATA(folder);
    const FileContents contents = read_file(folder / "spot_quads.obj");
    const auto& faces = mesh_of(contents).faces;
    EXPECT_EQ(std::set(faces.begin(), faces.end()).size(), 2928u);
}

TEST(RealMeshes, ARingWithACutIsTriangulatedWithinItsOutline) {
    const auto folder = data_file("meshes");
    REQUIRE_DATA(folder);
    const FileContents contents = read_file(folder / "concave_polygon.obj");
    // Outline and hole are regular enough: radii 0.7425 and 0.6875, 32 corners each.
    const double share = 16.0 * std::sin(std::acos(-1.0) / 16.0);
    const double expected = share * (0.7425 * 0.7425 - 0.6875 * 0.6875);
    EXPECT_NEAR(area(mesh_of(contents)), expected, expected * 0.02);
}

TEST(RealMeshes, DamagedFilesAreRefusedByNameOrRead) {
    const auto folder = data_file("meshes/broken");
    REQUIRE_DATA(folder);
    const std::set<std::string> valid{"all_degenerate.obj",   "spot_far_from_origin.obj",
                                      "spot_tiny_scale.obj",  "stl_header_says_solid.stl",
                                      "nonmanifold_edge.obj", "fandisk_fin_dup_flipped.obj",
                                      "fandisk_zero_area.obj"};
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        const std::string extension = entry.path().extension().string();
        if (extension != ".obj" && extension != ".ply" && extension != ".stl") continue;
        std::string problem;
        try {
            read_file(entry.path());
        } catch (const InputError& error) {
            problem = error.what();
        }
        EXPECT_EQ(problem.empty(), valid.contains(name)) << name << ": " << problem;
        if (problem.empty()) continue;
        EXPECT_NE(problem.find(name), std::string::npos) << problem;
        EXPECT_NE(problem.find_first_of(";?"), std::string::npos) << "no remedy: " << problem;
    }
}

}  // namespace
}  // namespace ink::test
