#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "io/reader.h"
#include "read_contents.h"
#include "test_files.h"

namespace ink::test {
namespace {

std::string ints(std::string_view name, std::string_view values) {
    return "<DataArray type=\"Int64\" Name=\"" + std::string(name) + "\">" + std::string(values) +
           "</DataArray>";
}

/// Five points: the corners of a square and one above it, with a field of their numbers.
std::string with_points(std::string_view type, std::string_view counts, std::string_view cells) {
    return "<VTKFile type=\"" + std::string(type) + "\"><" + std::string(type) +
           "><Piece NumberOfPoints=\"5\" " + std::string(counts) +
           "><PointData><DataArray type=\"Float32\" Name=\"pressure\">0 1 2 3 4</DataArray>"
           "</PointData><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">"
           "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1</DataArray></Points>" +
           std::string(cells) + "</Piece></" + std::string(type) + "></VTKFile>";
}

std::string polygons(std::string_view points, std::string_view ends) {
    return with_points(
        "PolyData", "NumberOfPolys=\"2\"",
        "<Polys>" + ints("connectivity", points) + ints("offsets", ends) + "</Polys>");
}

std::string grid(std::string_view points, std::string_view ends, std::string_view types) {
    return with_points("UnstructuredGrid", "NumberOfCells=\"2\"",
                       "<Cells>" + ints("connectivity", points) + ints("offsets", ends) +
                           ints("types", types) + "</Cells>");
}

const Mesh& mesh(const FileContents& contents) {
    return std::get<Mesh>(contents.objects.at(0).shape);
}

TEST(VtkSurfaces, KeepTheirPolygonsAsFaces) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.vtp", polygons("0 1 2 3 0 1 4", "4 7"));
    const FileContents contents = read_file(file);
    EXPECT_EQ(contents.format, "VTP");
    EXPECT_EQ(mesh(contents).triangles.size(), 3U);
    EXPECT_EQ(mesh(contents).faces, (std::vector<std::uint32_t>{0, 0, 1}));
    EXPECT_TRUE(contents.warnings.empty());
}

TEST(VtkSurfaces, OfStripsAreWoundAlike) {
    const TemporaryFolder folder;
    const auto file =
        folder.write("a.vtp", with_points("PolyData", "NumberOfStrips=\"1\"",
                                          "<Strips>" + ints("connectivity", "0 1 3 2") +
                                              ints("offsets", "4") + "</Strips>"));
    const FileContents contents = read_file(file);
    const Mesh& square = mesh(contents);
    ASSERT_EQ(square.triangles.size(), 2U);
    for (const auto& [a, b, c] : square.triangles) {
        EXPECT_GT(
            cross(square.vertices[b] - square.vertices[a], square.vertices[c] - square.vertices[a])
                .z,
            0.0F);
    }
}

TEST(VtkSurfaces, AreThePlaneCellsOfGrids) {
    const TemporaryFolder folder;
    // A pixel counts its points row by row.
    const auto file = folder.write("a.vtu", grid("0 1 3 2 0 1 4", "4 7", "8 5"));
    const FileContents contents = read_file(file);
    EXPECT_EQ(mesh(contents).triangles.size(), 3U);
    EXPECT_EQ(contents.objects[0].world_bounds().extent().z, 1.0);
    const Mesh& shape = mesh(contents);
    double area = 0.0;
    for (const auto& [a, b, c] : shape.triangles) {
        area += 0.5 * static_cast<double>(length(cross(shape.vertices[b] - shape.vertices[a],
                                                       shape.vertices[c] - shape.vertices[a])));
    }
    EXPECT_NEAR(area, 1.5, 1e-6) << "a square without crossing itself, and half a square";
}

TEST(VtkSurfaces, HaveTheColoursOfAFieldOfTheirPoints) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.vtp", polygons("0 1 2 3 0 1 4", "4 7"));
    const FileContents contents = read_file(file, {.data = {.color_by = "pressure"}});
    EXPECT_EQ(mesh(contents).colors.size(), 5U);
    ASSERT_TRUE(contents.objects[0].color_scale);
    EXPECT_EQ(contents.objects[0].color_scale->title, "pressure");
    EXPECT_EQ(contents.objects[0].color_scale->most, 4.0);
    EXPECT_THROW(read_file(file, {.data = {.color_by = "velocity"}}), Error);
}

TEST(VtkSurfaces, OfSolidCellsLeaveThePointsToDraw) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.vtu", grid("0 1 2 4 0 1 3 4", "4 8", "10 10"));
    const FileContents contents = read_file(file);
    EXPECT_EQ(spheres(contents).spheres.size(), 5U);
    ASSERT_FALSE(contents.warnings.empty());
    EXPECT_NE(contents.warnings[0].find("2 cells"), std::string::npos);
}

TEST(VtkSurfaces, AreRefusedWhereCellsMakeNoSense) {
    const TemporaryFolder folder;
    const auto refused = [&](const std::string& text) {
        return refusal(folder.write("a.vtp", text));
    };
    EXPECT_NE(refused(polygons("0 1 2 3 0 1 5", "4 7")).find("uses point 5"), std::string::npos);
    EXPECT_NE(refused(polygons("0 1 2 3 0 1 -1", "4 7")).find("uses point -1"), std::string::npos);
    EXPECT_NE(refused(polygons("0 1 2 3 0 1 4", "4 3")).find("before it begins"),
              std::string::npos);
    EXPECT_NE(refused(polygons("0 1 2 3", "4 7")).find("fewer numbers"), std::string::npos);
    EXPECT_NE(refused(polygons("0 1 2", "3 99999999999")).find("fewer numbers"), std::string::npos);
    EXPECT_NE(refused(with_points("PolyData", "NumberOfPolys=\"1\"", "")).find("no array"),
              std::string::npos);
}

TEST(VtkPoints, OfDoublePrecisionKeepTheirPlaceFarFromTheOrigin) {
    const TemporaryFolder folder;
    const auto file = folder.write(
        "a.vtp",
        "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"2\"><Points><DataArray "
        "type=\"Float64\" NumberOfComponents=\"3\">1000000000 0 0 1000000001 0 0</DataArray>"
        "</Points></Piece></PolyData></VTKFile>");
    const auto p = positions(read_file(file, {.data = {.radius = "0.25"}}));
    ASSERT_EQ(p.size(), 2U);
    EXPECT_EQ(p[0].x, 1e9);
    EXPECT_EQ(p[1].x, 1e9 + 1.0);
}

}  // namespace
}  // namespace ink::test
