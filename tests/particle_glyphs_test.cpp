#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "io/reader.h"
#include "read_contents.h"
#include "scene/particles.h"
#include "test_files.h"

namespace ink {
namespace {

using test::expect_refused;
using test::TemporaryFolder;

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
                                                "2,0,0,1,nan,1,1,0,0,0\n3,0,0,1,1e30,1,1,0,0,0\n"
                                                "4,0,0,1,1,1,1e-8,0,0,0\n");
    const FileContents contents = read_glyphs(file, Glyph::ellipsoid);
    EXPECT_EQ(glyphs(contents).placements.size(), 1U);
    ASSERT_EQ(contents.warnings.size(), 1U);
    EXPECT_NE(contents.warnings[0].find("4 of 5 particles"), std::string::npos);
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
