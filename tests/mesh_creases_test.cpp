#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <random>
#include <string>
#include <string_view>

#include "known_meshes.h"
#include "scene/mesh.h"
#include "scene/mesh_topology.h"
#include "test_files.h"

namespace ink {
namespace {

using namespace test;

TEST(SmoothNormals, KeepTheSidesOfACubeFlat) {
    Mesh mesh = cube_soup();
    weld(mesh);
    smooth_normals(mesh);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& [a, b, c] = mesh.triangles[i];
        const Vec3f flat = normalize(
            cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]));
        for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(corner_normal(mesh, i, k), flat);
    }
}

TEST(SmoothNormals, OfASpherePointAwayFromItsCentre) {
    Mesh mesh = sphere(4);
    smooth_normals(mesh);
    double worst = 0.0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3f radial = mesh.vertices[mesh.triangles[i][k]];
            worst = std::max(worst, angle_between(corner_normal(mesh, i, k), radial));
        }
    }
    EXPECT_LT(worst, 0.02);  // the triangles themselves lean by up to 0.07
}

TEST(SmoothNormals, DoNotDependOnTheScale) {
    Mesh mesh = sphere(2), tiny = mesh;
    for (Vec3f& vertex : tiny.vertices) vertex = vertex * std::ldexp(1.f, -80);
    smooth_normals(mesh);
    smooth_normals(tiny);
    EXPECT_EQ(mesh.corner_normals, tiny.corner_normals);
}

/// A cone about z: the tip is vertex 0, where all triangles meet.
Mesh cone(std::uint32_t sides) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0.1f}};
    for (std::uint32_t i = 0; i < sides; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / sides;
        mesh.vertices.push_back(to_float({std::cos(angle), std::sin(angle), 0.0}));
        mesh.triangles.push_back({0, i + 1, (i + 1) % sides + 1});
    }
    return mesh;
}

TEST(SmoothNormals, AgreeForFewAndForManyTrianglesAboutAVertex) {
    for (const std::uint32_t sides : {200u, 2000u}) {
        Mesh mesh = cone(sides);
        smooth_normals(mesh);
        EXPECT_LT(angle_between(corner_normal(mesh, 0, 0), {0, 0, 1}), 1e-3) << sides;
    }
}

TEST(SmoothNormals, TakeLinearTimeAboutOneVertex) {
    Mesh mesh = cone(300'000);
    const auto start = std::chrono::steady_clock::now();
    smooth_normals(mesh);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    EXPECT_LT(taken.count(), 10.0);  // all pairs would take minutes
}

TEST(SmoothNormals, AreUnitVectorsForATriangleWithoutArea) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    mesh.triangles = {{0, 1, 2}};
    smooth_normals(mesh);
    EXPECT_NEAR(length(corner_normal(mesh, 0, 0)), 1.f, 1e-6f);
}

/// A sphere with bumps, noise and a few sharp spikes.
Mesh rough_sphere() {
    Mesh mesh = sphere(5);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> noise(0.995f, 1.005f);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const Vec3f n = mesh.vertices[i];
        const float bump = 1.f + 0.2f * std::sin(5.f * n.x) * std::sin(4.f * n.y + n.z);
        mesh.vertices[i] = n * (bump * noise(random) * (i % 500 == 0 ? 1.1f : 1.f));
    }
    return mesh;
}

/// Edges that are no crease and over which a normal at one of the ends jumps.
std::size_t broken_edges(const Mesh& mesh) {
    const MeshTopology topology(mesh);
    std::size_t broken = 0;
    for (Corner edge = 0; edge < 3 * mesh.triangles.size(); ++edge) {
        if (!topology.has_twin(edge) || mesh.is_crease(edge / 3, edge % 3)) continue;
        const Corner twin = topology.twin(edge);
        const auto normal = [&](Corner c) { return mesh.corner_normals[c / 3][c % 3]; };
        broken += normal(edge) != normal(next(twin)) || normal(next(edge)) != normal(twin) ? 1 : 0;
    }
    return broken;
}

TEST(SmoothNormals, AreTheSameOnBothSidesOfEveryEdgeButCreases) {
    for (Mesh mesh : {rough_sphere(), cylinder(24, 10), wedge(20.0, 4), torus(24, 12)}) {
        smooth_normals(mesh);
        EXPECT_EQ(broken_edges(mesh), 0u);
    }
}

TEST(SmoothNormals, JumpAcrossACrease) {
    Mesh mesh = wedge(20.0, 4);
    smooth_normals(mesh);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const double side = mesh.vertices[mesh.triangles[i][0]].x +
                            mesh.vertices[mesh.triangles[i][1]].x +
                            mesh.vertices[mesh.triangles[i][2]].x;
        const double lean = std::copysign(10.0, side) * std::numbers::pi / 180.0;
        const Vec3f flat = to_float({std::sin(lean), 0.0, std::cos(lean)});
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_LT(angle_between(corner_normal(mesh, i, k), flat), 2e-4);
        }
    }
}

TEST(SmoothNormals, LieOnTheSameLineWhicheverWayTrianglesAreWound) {
    Mesh mesh = sphere(4), mixed = mesh;
    std::mt19937 random(4);
    std::vector<bool> turned;
    for (Mesh::Triangle& triangle : mixed.triangles) {
        turned.push_back(random() % 3 == 0);
        if (turned.back()) std::swap(triangle[1], triangle[2]);
    }
    smooth_normals(mesh);
    smooth_normals(mixed);
    EXPECT_EQ(count_flags(mixed, Mesh::kCreaseEdge), 0u);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const Vec3f normal = corner_normal(mixed, i, 0);
        EXPECT_LT(angle_between(corner_normal(mesh, i, 0), turned[i] ? -normal : normal), 2e-4);
    }
}

TEST(SmoothNormals, LeaveTheNormalsOfAFileForShading) {
    Mesh mesh = cube_soup();
    weld(mesh);
    const std::uint32_t up = pack_normal({0, 0, 1});
    mesh.corner_normals.assign(mesh.triangles.size(), {up, up, up});
    const auto own = mesh.corner_normals;
    smooth_normals(mesh);
    EXPECT_EQ(mesh.corner_normals, own);
    ASSERT_EQ(mesh.line_normals.size(), mesh.triangles.size());
    EXPECT_EQ(unpack_normal(mesh.line_normals[0][0]), (Vec3f{1, 0, 0}));
}

/// A ridge that ends in the middle of a sheet.
Mesh ending_ridge() {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0.45F}, {1, 1, 0}, {-1, 0, 0}, {1, -1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
    return mesh;
}

TEST(SmoothNormals, OfAMeshWithItsOwnKeepACreaseSharpUpToItsEnd) {
    CreaseSettings sharp_only;
    sharp_only.min_deg = sharp_only.sharp_deg;
    Mesh shaded = ending_ridge();
    smooth_normals(shaded, sharp_only);
    ASSERT_TRUE(shaded.is_crease(0, 0));
    ASSERT_EQ(count_flags(shaded, Mesh::kCreaseEdge), 2U);  // one edge, in two triangles
    for (std::size_t i = 1; i < 4; ++i) {
        EXPECT_EQ(shaded.corner_normals[i][0], shaded.corner_normals[0][0]);
    }

    Mesh mesh = ending_ridge();
    mesh.corner_normals = shaded.corner_normals;
    smooth_normals(mesh, sharp_only);
    const auto normal = [&](std::size_t triangle) {
        return unpack_normal(mesh.line_normals[triangle][0]);
    };
    EXPECT_GT(angle_between(normal(0), normal(3)), 40.0 * std::numbers::pi / 180.0);
    EXPECT_EQ(normal(1), normal(2));
    EXPECT_EQ(mesh.line_normals[1][0], shaded.corner_normals[1][0]);
}

TEST(SmoothNormals, OfAMeshWithoutItsOwnServeLinesToo) {
    Mesh mesh = sphere(1);
    smooth_normals(mesh);
    EXPECT_TRUE(mesh.line_normals.empty());
}

TEST(SmoothNormals, SurviveTrianglesThatUseAVertexTwice) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 1}, {0, 0, 0}, {0, 1, 0}, {0, 1, 2}, {2, 1, 0}, {0, 1, 2}};
    smooth_normals(mesh);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(length(corner_normal(mesh, i, k)), 1.f, 1e-6f);
        }
    }
}

TEST(Creases, OfABoxAreItsTwelveEdges) {
    Mesh mesh = cube_soup();
    weld(mesh);
    EXPECT_EQ(creases(mesh), 12u);
}

TEST(Creases, AreNotOnRoundShapes) {
    for (const int levels : {2, 3, 4, 6}) EXPECT_EQ(creases(sphere(levels)), 0u) << levels;
    for (const std::uint32_t n : {10u, 12u, 24u, 100u}) EXPECT_EQ(creases(uv_sphere(2 * n, n)), 0u);
    for (const std::uint32_t n : {12u, 24u, 100u}) EXPECT_EQ(creases(torus(2 * n, n)), 0u) << n;
}

TEST(Creases, OfACylinderAreTheRimsOfItsCaps) {
    for (const std::uint32_t sides : {12u, 24u, 64u, 1000u}) {
        for (const std::uint32_t rings : {1u, 2u, 10u}) {
            EXPECT_EQ(creases(cylinder(sides, rings)), 2 * sides) << sides << ", " << rings;
        }
    }
}

TEST(Creases, OfAConeAreTheRimOfItsBase) {
    for (const std::uint32_t sides : {24u, 300u}) {
        Mesh mesh = cylinder(sides, 10);
        for (Vec3f& vertex : mesh.vertices) {
            vertex.x *= 1.f - 0.99f * vertex.z;
            vertex.y *= 1.f - 0.99f * vertex.z;
        }
        EXPECT_EQ(creases(mesh), 2 * sides) << sides;
    }
}

TEST(Creases, AreFoldsAmidFlatSidesHoweverFinelyCut) {
    for (const std::uint32_t cuts : {1u, 4u, 50u}) {
        for (const double fold : {20.0, 60.0, 170.0}) {
            EXPECT_EQ(creases(wedge(fold, cuts)), cuts) << fold;
        }
        EXPECT_EQ(creases(wedge(5.0, cuts)), 0u);
    }
}

TEST(Creases, DoNotDependOnTheScale) {
    for (const int exponent : {-60, 40}) {
        Mesh mesh = cylinder(24, 10);
        for (Vec3f& vertex : mesh.vertices) vertex = vertex * std::ldexp(1.f, exponent);
        EXPECT_EQ(creases(mesh), 48u) << exponent;
    }
}

TEST(Creases, AreNotInsideAPolygon) {
    Mesh mesh = wedge(60.0, 1);
    mesh.faces = {0, 0, 0, 0};
    EXPECT_EQ(creases(mesh), 0u);
}

/// A sheet with a ridge of 45 degrees in the middle that runs out after `reach` on both sides.
Mesh ridge(double reach) {
    return grid_mesh({40, 40}, [&](std::uint32_t i, std::uint32_t j) {
        const double x = i / 20.0 - 1.0, y = j / 20.0 - 1.0;
        const double steepness = std::abs(x) < reach ? 0.41 : 0.0;
        return Vec3d{x, y, -steepness * std::min(std::abs(y), 0.05)};
    });
}

TEST(Creases, WithLooseEndsMustBeLong) {
    EXPECT_EQ(creases(ridge(0.08)), 0u);
    EXPECT_GT(creases(ridge(0.5)), 15u);
}

TEST(Creases, MayBeASingleLongEdge) {
    // A fold of four triangles above a finely cut sheet.
    Mesh mesh = wedge(0.0, 20);
    Mesh fold = wedge(60.0, 1);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3f& vertex : fold.vertices) mesh.vertices.push_back(vertex + Vec3f{0, 0, 1});
    for (const auto& [a, b, c] : fold.triangles) {
        mesh.triangles.push_back({a + first, b + first, c + first});
    }
    EXPECT_EQ(creases(mesh), 1u);
}

TEST(Creases, ThatCloseUpMayBeSmall) {
    // A small block on a large plate.
    const Mesh mesh = grid_mesh({100, 100}, [&](std::uint32_t i, std::uint32_t j) {
        const bool on_block = (i == 50 || i == 51) && (j == 50 || j == 51);
        return Vec3d{0.01 * i, 0.01 * j, on_block ? 0.02 : 0.0};
    });
    EXPECT_GT(creases(mesh), 6u);
}

TEST(Creases, AreSeenAcrossNeedles) {
    Mesh mesh;
    // The edge of two sides has a third vertex, a little off the line.
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5f, 1e-8f, 1e-8f}, {0.5f, 1, 0}, {0.5f, 0, -1}};
    mesh.triangles = {{0, 1, 3}, {1, 0, 2}, {2, 0, 4}, {1, 2, 4}};
    smooth_normals(mesh);
    EXPECT_FALSE(mesh.is_crease(0, 0));
    EXPECT_TRUE(mesh.is_crease(1, 1));
    EXPECT_TRUE(mesh.is_crease(1, 2));
    EXPECT_LT(angle_between(corner_normal(mesh, 1, 2), {0, 0, 1}), 1e-4);
}

TEST(EdgeFlags, TellBoundariesFromInnerEdges) {
    Mesh mesh = wedge(0.0, 3);
    smooth_normals(mesh);
    EXPECT_EQ(count_flags(mesh, Mesh::kBoundaryEdge), 18u);
    EXPECT_EQ(count_flags(mesh, Mesh::kCreaseEdge), 0u);
    Mesh closed = torus(24, 12);
    smooth_normals(closed);
    EXPECT_EQ(count_flags(closed, Mesh::kBoundaryEdge), 0u);
}

TEST(EdgeFlags, CallAnEdgeOfThreeTrianglesACrease) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0.1f}, {0, 0, 1}};
    mesh.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
    smooth_normals(mesh);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_TRUE(mesh.is_crease(i, 0));
        EXPECT_FALSE(mesh.is_boundary(i, 0));
        EXPECT_TRUE(mesh.is_boundary(i, 1));
    }
    EXPECT_EQ(corner_normal(mesh, 0, 0), (Vec3f{0, 0, 1}));
}

/// A strip of paper with a fold that fades out halfway, of 20 triangles.
Mesh folded_strip(float scale, Vec3f at) {
    Mesh mesh;
    constexpr std::uint32_t kSteps = 5;
    for (std::uint32_t j = 0; j <= kSteps; ++j) {
        const float angle =
            std::numbers::pi_v<float> / 2.0f * static_cast<float>(kSteps - j) / kSteps;
        const auto x = static_cast<float>(j);
        for (const Vec3f p :
             {Vec3f{x, -1, 0}, Vec3f{x, 0, 0}, Vec3f{x, std::cos(angle), std::sin(angle)}}) {
            mesh.vertices.push_back(at + p * scale);
        }
        if (j == kSteps) break;
        for (const std::uint32_t k : {3 * j, 3 * j + 1}) {
            mesh.triangles.push_back({k, k + 3, k + 4});
            mesh.triangles.push_back({k, k + 4, k + 1});
        }
    }
    return mesh;
}

TEST(Creases, OfAPartAreThoseOfThePartAloneHoweverLargeTheAssembly) {
    const Mesh part = folded_strip(0.01f, {3, 0, 0});
    const std::size_t alone = creases(part);
    EXPECT_GT(alone, 1u);
    Mesh assembly = sphere(5);
    ASSERT_EQ(creases(assembly), 0u);
    const auto first = static_cast<std::uint32_t>(assembly.vertices.size());
    for (const Vec3f& vertex : part.vertices) assembly.vertices.push_back(vertex);
    for (const Mesh::Triangle& t : part.triangles) {
        assembly.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    EXPECT_EQ(creases(assembly), alone);
}

template <class T>
T read_at(const std::string& bytes, std::size_t offset) {
    T value{};
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

/// Relative to the first vertex, as the reader has it, which makes 1e-17 the same as 0.
Mesh binary_stl(const std::filesystem::path& file) {
    const std::string bytes = test::read_bytes(file);
    const auto origin = read_at<Vec3f>(bytes, 84 + 12);
    Mesh mesh;
    for (std::uint32_t i = 0; i < read_at<std::uint32_t>(bytes, 80); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            mesh.vertices.push_back(read_at<Vec3f>(bytes, 84 + 50 * i + 12 + 12 * k) - origin);
        }
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    weld(mesh);
    return mesh;
}

/// A binary PLY file with positions and triangles only.
Mesh plain_ply(const std::filesystem::path& file, std::size_t vertices, std::size_t triangles) {
    const std::string bytes = test::read_bytes(file);
    std::size_t at = bytes.find("end_header\n") + 11;
    Mesh mesh;
    for (std::size_t i = 0; i < vertices; ++i, at += 12) {
        mesh.vertices.push_back(read_at<Vec3f>(bytes, at));
    }
    for (std::size_t i = 0; i < triangles; ++i, at += 13) {
        mesh.triangles.push_back(read_at<Mesh::Triangle>(bytes, at + 1));
    }
    weld(mesh);
    return mesh;
}

TEST(RealMeshes, OfCadPartsKeepAllTheirCreases) {
    struct Known {
        std::string_view name;
        double creases;  ///< edges that turn by more than 30 degrees
    };
    for (const Known& known : {Known{"fandisk.stl", 480}, Known{"featuretype.stl", 1723},
                               Known{"plate_holes.stl", 416}, Known{"unit_cube.stl", 12}}) {
        const auto file = test::data_file("meshes") / known.name;
        if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
        EXPECT_NEAR(static_cast<double>(creases(binary_stl(file))), known.creases, 5) << known.name;
    }
}

TEST(RealMeshes, OfScansHaveNoCreases) {
    const auto file = test::data_file("meshes/stanford-bunny.ply");
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
    EXPECT_EQ(creases(plain_ply(file, 35947, 69451)), 0u);
}

}  // namespace
}  // namespace ink
