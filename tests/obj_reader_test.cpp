#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "io/reader.h"
#include "mesh_texts.h"
#include "test_files.h"

namespace ink::test {
namespace {

constexpr std::string_view kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

std::string square_with(std::string_view rest) { return std::string(kSquare) + std::string(rest); }

TEST(ObjReader, TakesNegativeIndicesAsCountedFromTheEnd) {
    const FileContents contents = read_text_as("a.obj", square_with("f -4 -3 -2\n"));
    EXPECT_EQ(mesh_of(contents).vertices, (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}));
}

TEST(ObjReader, KeepsThePolygonThatATriangleWasCutFrom) {
    const FileContents contents = read_text_as("a.obj", square_with("f 1 2 3 4\nf 1 2 3\n"));
    EXPECT_EQ(mesh_of(contents).faces, (std::vector<std::uint32_t>{0, 0, 1}));
    EXPECT_DOUBLE_EQ(area(mesh_of(contents)), 1.5);
}

TEST(ObjReader, CutsConcavePolygonsWithinTheirOutline) {
    // An L of area 3.
    const FileContents contents = read_text_as(
        "l.obj", "v 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nf 1 2 3 4 5 6\n");
    EXPECT_EQ(mesh_of(contents).triangles.size(), 4u);
    EXPECT_DOUBLE_EQ(area(mesh_of(contents)), 3.0);
}

TEST(ObjReader, MakesAPartOfEachGroup) {
    const FileContents contents =
        read_text_as("a.obj", square_with("g left\nf 1 2 3\ng right\nf 1 3 4\nf 1 2 4\n"));
    EXPECT_EQ(contents.objects[0].part_names, (std::vector<std::string>{"left", "right"}));
    EXPECT_EQ(mesh_of(contents).parts, (std::vector<std::uint32_t>{0, 1, 1}));
}

TEST(ObjReader, UsesTheNormalsOfTheFile) {
    const FileContents contents =
        read_text_as("a.obj", square_with("vn 1 0 0\nvn 0 2 0\nf 1//1 2//2 3//1\n"));
    EXPECT_EQ(unpack_normal(mesh_of(contents).corner_normals[0][0]), (Vec3f{1, 0, 0}));
    EXPECT_EQ(unpack_normal(mesh_of(contents).corner_normals[0][1]), (Vec3f{0, 1, 0}));
}

TEST(ObjReader, ComputesNormalsWhereTheFileHasZeros) {
    const FileContents contents =
        read_text_as("a.obj", square_with("vn 0 0 0\nf 1//1 2//1 3//1\n"));
    EXPECT_EQ(unpack_normal(mesh_of(contents).corner_normals[0][0]), (Vec3f{0, 0, 1}));
    EXPECT_EQ(contents.warnings.size(), 1u);
}

TEST(ObjReader, ReadsVertexColours) {
    const FileContents contents =
        read_text_as("a.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 0.5 0\nv 0 1 0 0 0 1\nf 1 2 3\n");
    EXPECT_EQ(mesh_of(contents).colors, (std::vector<Rgb8>{{255, 0, 0}, {0, 128, 0}, {0, 0, 255}}));
}

TEST(ObjReader, TakesTheColourOfAMaterialLibraryBesideTheFile) {
    const TemporaryFolder folder;
    folder.write("paint.mtl", "newmtl red\nKd 1 0 0.2\n");
    const auto file = folder.write("a.obj", square_with("mtllib paint.mtl\nusemtl red\nf 1 2 3\n"));
    EXPECT_EQ(read_file(file).objects[0].material.color, (Rgb8{255, 0, 51}));
}

TEST(ObjReader, WarnsOfAMissingMaterialLibraryAndKeepsTheDefaultColour) {
    const FileContents contents =
        read_text_as("a.obj", square_with("mtllib paint.mtl\nusemtl red\nf 1 2 3\n"));
    EXPECT_EQ(contents.objects[0].material.color, Material{}.color);
    ASSERT_EQ(contents.warnings.size(), 1u);
    EXPECT_NE(contents.warnings[0].find("paint.mtl"), std::string::npos);
}

TEST(ObjReader, GivesTheFacesOfEachMaterialItsColour) {
    const TemporaryFolder folder;
    folder.write("paint.mtl", "newmtl red\nKd 1 0 0\nnewmtl odd\nNs 10\nnewmtl blue\nKd 0 0 1\n");
    const FileContents contents = read_file(
        folder.write("a.obj",
                     "mtllib paint.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\n"
                     "g all\nusemtl red\nf 1 2 3\nusemtl blue\nf 4 5 6\n"));
    EXPECT_EQ(contents.objects[0].part_names, (std::vector<std::string>{"all", "blue"}));
    const Mesh& mesh = mesh_of(contents);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(mesh.colors[mesh.triangles[0][k]], (Rgb8{255, 0, 0}));
        EXPECT_EQ(mesh.colors[mesh.triangles[1][k]], (Rgb8{0, 0, 255}));
    }
}

TEST(ObjReader, TakesAGroupThatIsResumedForOne) {
    const FileContents contents =
        read_text_as("a.obj", square_with("g left\nf 1 2 3\ng right\nf 1 3 4\ng left\nf 1 2 4\n"));
    EXPECT_EQ(contents.objects[0].part_names, (std::vector<std::string>{"left", "right"}));
    EXPECT_EQ(mesh_of(contents).parts, (std::vector<std::uint32_t>{0, 1, 0}));
}

TEST(ObjReader, LeavesLinesAndPointsOutAndKeepsTheNormalsOfFaces) {
    const FileContents contents =
        read_text_as("a.obj", square_with("vn 1 0 0\nl 1 2 3\np 4\nf 1//1 2//1 3//1\n"));
    EXPECT_EQ(mesh_of(contents).triangles.size(), 1U);
    EXPECT_EQ(contents.warnings,
              (std::vector<std::string>{"2 faces with fewer than 3 corners were left out."}));
    EXPECT_NEAR(unpack_normal(mesh_of(contents).corner_normals[0][0]).x, 1.0F, 1e-4F);
}

TEST(ObjReader, DividesByTheWeightOfAVertex) {
    const FileContents contents = read_text_as("a.obj", "v 0 0 0 1\nv 2 0 0 2\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(contents.objects[0].world_bounds().upper, (Vec3d{1, 1, 0}));
}

TEST(ObjReader, OpensNothingOutsideItsFolder) {
    const TemporaryFolder folder;
    folder.write("outside.mtl", "newmtl red\nKd 1 0 0\n");
    std::filesystem::create_directory(folder.path() / "in");
    const auto file =
        folder.write("in/a.obj", square_with("mtllib ../outside.mtl\nusemtl red\nf 1 2 3\n"));
    EXPECT_EQ(read_file(file).objects[0].material.color, Material{}.color);
}

TEST(ObjReader, KeepsTheShapeOfAModelFarFromTheOrigin) {
    const FileContents contents = read_text_as(
        "a.obj", "v 1e7 0 1e7\nv 10000000.001 0 1e7\nv 1e7 0.001 10000000.002\nf 1 2 3\n");
    const Object& object = contents.objects[0];
    const Vec3d third = object.frame.to_world(mesh_of(contents).vertices[2]);
    EXPECT_NEAR(third.x, 1e7, 1e-8);
    EXPECT_NEAR(third.y, 0.001, 1e-8);
    EXPECT_NEAR(third.z, 10000000.002, 1e-8);
    EXPECT_TRUE(contents.warnings.empty());
}

TEST(ObjReader, NamesTheLineAndTheRemedy) {
    const auto error = [](std::string_view rest) { return error_of("a.obj", square_with(rest)); };
    EXPECT_EQ(error("f 0 1 2\n"),
              "a.obj:5: face with index 0; OBJ counts from 1: export the file again");
    EXPECT_EQ(error("f 1 2 3\nf 1 2 9\n"),
              "a.obj:6: face uses vertex 9, but there are only 4; export the file again");
    EXPECT_EQ(error("f -5 1 2\n"),
              "a.obj:5: face uses vertex -5, but only 4 come before it; export the file again");
    EXPECT_EQ(error("f 1/1 2/1 3/1\n"),
              "a.obj:5: face uses texture coordinate 1, but there are only 0; export the file "
              "again");
    EXPECT_EQ(error("f 1//1 2//1 3//1\n"),
              "a.obj:5: face uses normal 1, but there are only 0; export the file again");
    EXPECT_EQ(error("f a b c\n"),
              "a.obj:5: face with the corner 'a'; expected numbers such as 7, 7/1 or 7/1/3");
    EXPECT_EQ(error("v nan 0 0\nf 1 2 3\n"),
              "a.obj:5: vertex with a coordinate that is not a number ('nan 0 0'); correct it");
    EXPECT_EQ(error("v 0 1e30 0\nf 1 2 3\n"),
              "a.obj:5: vertex with a coordinate beyond 1e15 ('0 1e30 0'); correct it");
    EXPECT_EQ(error("v 0 1e999 0\nf 1 2 3\n"),
              "a.obj:5: vertex with a coordinate beyond 1e15 ('0 1e999 0'); correct it");
    EXPECT_EQ(error("v 0 1\nf 1 2 3\n"),
              "a.obj:5: vertex with 2 numbers; expected x y z, x y z w or x y z r g b");
    EXPECT_EQ(error("f 1 1 1\n"), "a.obj: no face has an area; check the export and its scale");
    EXPECT_EQ(error(""), "a.obj: holds points, no faces; export the surface with its faces");
    EXPECT_EQ(error_of("a.obj", "hello\n"),
              "a.obj: holds no vertices; is it a Wavefront OBJ file?");
}

TEST(ObjReader, DrawsTheEdgesOfFacesWhereNoneHasAnArea) {
    const FileContents contents =
        read_text_as("a.obj", "v 0 0 0\nv 1 0 0\nv 3 0 0\nv 9 9 9\nf 1 2 3\nf 3 2 1\nf 1 1 3\n");
    const auto& wires = std::get<Glyphs>(contents.objects.at(0).shape);
    EXPECT_EQ(wires.placements.size(), 3U);  // each once
    EXPECT_EQ(contents.counts[0].second, 3U);
    EXPECT_EQ(contents.counts[1].second, 3U);
    const Bounds3d box = contents.objects[0].world_bounds();
    EXPECT_NEAR(box.extent().x, 3.0, 1e-6);
    EXPECT_NEAR(box.extent().y, 0.03, 1e-6);
    ASSERT_EQ(contents.warnings.size(), 1U);
    EXPECT_EQ(contents.warnings[0].substr(0, 24), "No face has an area, the");
}

}  // namespace
}  // namespace ink::test
