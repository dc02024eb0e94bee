#include "scene/mesh.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "base/bounds.h"
#include "scene/mesh_topology.h"
#include "test_files.h"

namespace ink {
namespace {

double angle_between(Vec3f a, Vec3f b) {
    const Vec3d u = to_double(a), v = to_double(b);
    return std::atan2(length(cross(u, v)), dot(u, v));
}

Vec3f corner_normal(const Mesh& mesh, std::size_t triangle, std::size_t corner) {
    return unpack_normal(mesh.corner_normals[triangle][corner]);
}

/// The cube [-1, 1]^3, each triangle with corners of its own.
Mesh cube_soup() {
    Mesh mesh;
    const auto add = [&](Vec3f a, Vec3f b, Vec3f c) {
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
        mesh.triangles.push_back({first, first + 1, first + 2});
    };
    const auto add_side = [&](Vec3f n, Vec3f u, Vec3f v) {
        add(n - u - v, n + u - v, n + u + v);
        add(n - u - v, n + u + v, n - u + v);
    };
    for (const float s : {1.f, -1.f}) {
        add_side({s, 0, 0}, {0, s, 0}, {0, 0, 1});
        add_side({0, s, 0}, {0, 0, s}, {1, 0, 0});
        add_side({0, 0, s}, {s, 0, 0}, {0, 1, 0});
    }
    return mesh;
}

/// An octahedron whose triangles are cut in four `levels` times, pushed out to the unit sphere.
Mesh sphere(int levels) {
    Mesh mesh;
    mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                      {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto fresh = static_cast<std::uint32_t>(mesh.vertices.size());
            const auto [at, added] = middles.try_emplace(std::minmax(a, b), fresh);
            if (added) mesh.vertices.push_back(normalize(mesh.vertices[a] + mesh.vertices[b]));
            return at->second;
        };
        std::vector<Mesh::Triangle> finer;
        for (const auto& [a, b, c] : mesh.triangles) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        mesh.triangles = finer;
    }
    return mesh;
}

TEST(PackedNormal, KeepsEveryDirectionWithinItsBound) {
    std::mt19937 random(1);
    std::normal_distribution<float> gauss;
    double worst = 0.0;
    for (int i = 0; i < 1'000'000; ++i) {
        const Vec3f n = normalize(Vec3f{gauss(random), gauss(random), gauss(random)});
        worst = std::max(worst, angle_between(n, unpack_normal(pack_normal(n))));
    }
    EXPECT_LT(worst, 7e-5);
}

TEST(PackedNormal, IsExactAlongTheAxes) {
    for (const Vec3f axis : {Vec3f{1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{0, 0, 1}}) {
        EXPECT_EQ(unpack_normal(pack_normal(axis)), axis);
        EXPECT_EQ(unpack_normal(pack_normal(-axis)), -axis);
    }
}

TEST(PackedNormal, OfAnyBitsIsAUnitVector) {
    std::mt19937 random(2);
    for (int i = 0; i < 100'000; ++i) {
        EXPECT_NEAR(length(unpack_normal(static_cast<std::uint32_t>(random()))), 1.f, 1e-6f);
    }
    EXPECT_NEAR(length(unpack_normal(0xffffffffu)), 1.f, 1e-6f);
}

TEST(Weld, MergesTheSoupOfACubeIntoItsEightCorners) {
    Mesh mesh = cube_soup();
    EXPECT_EQ(weld(mesh), 0u);
    EXPECT_EQ(mesh.vertices.size(), 8u);
    EXPECT_EQ(mesh.triangles.size(), 12u);
}

TEST(Weld, MovesNoCorner) {
    const Mesh soup = cube_soup();
    Mesh mesh = soup;
    weld(mesh);
    for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_EQ(mesh.vertices[mesh.triangles[i][k]], soup.vertices[soup.triangles[i][k]]);
        }
    }
}

TEST(Weld, TakesMinusZeroForZero) {
    Mesh mesh;
    mesh.vertices = {{0.f, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.f, -0.f, 0}, {1, 0, -0.f}, {0, -1, 0}};
    mesh.triangles = {{0, 1, 2}, {3, 5, 4}};
    weld(mesh);
    EXPECT_EQ(mesh.vertices.size(), 4u);
}

TEST(Weld, DropsTrianglesWithoutAreaAndWhatOnlyTheyUse) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {9, 9, 9}};
    mesh.triangles = {{0, 1, 3}, {0, 1, 2}, {1, 1, 2}};
    mesh.faces = {7, 8, 9};
    mesh.parts = {0, 1, 2};
    mesh.colors = {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {5, 0, 0}};
    EXPECT_EQ(weld(mesh), 2u);
    EXPECT_EQ(mesh.triangles, (std::vector<Mesh::Triangle>{{0, 1, 2}}));
    EXPECT_EQ(mesh.vertices.size(), 3u);
    EXPECT_EQ(mesh.faces, std::vector<std::uint32_t>{8});
    EXPECT_EQ(mesh.parts, std::vector<std::uint32_t>{1});
    EXPECT_EQ(mesh.colors, (std::vector<Rgb8>{{1, 0, 0}, {2, 0, 0}, {3, 0, 0}}));
}

TEST(Weld, KeepsTheFirstColourAtASeam) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, -1, 0}, {1, 0, 0}};
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    mesh.colors = {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}, {5, 5, 5}, {6, 6, 6}};
    weld(mesh);
    EXPECT_EQ(mesh.colors, (std::vector<Rgb8>{{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {5, 5, 5}}));
}

TEST(Weld, SeesAreaWhereTheSquareOfAFloatIsZero) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1e-30f, 0, 0}, {0, 1e-30f, 0}};
    mesh.triangles = {{0, 1, 2}};
    EXPECT_EQ(weld(mesh), 0u);
}

TEST(Weld, NumbersVerticesByFirstUseHoweverManyThreadsLookForThem) {
    constexpr std::uint32_t kSide = 150;
    std::mt19937 random(7);
    Mesh soup;
    for (std::uint32_t i = 0; i < 20'000; ++i) {
        const auto corner = [&](std::uint32_t dx, std::uint32_t dy) {
            const auto at = static_cast<std::uint32_t>(random() % (kSide * kSide));
            soup.vertices.push_back({static_cast<float>(at % kSide + kSide * dx),
                                     static_cast<float>(at / kSide + kSide * dy), 0.0F});
        };
        corner(0, 0);
        corner(1, 0);
        corner(0, 1);
        soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    Mesh welded = soup;
    EXPECT_EQ(weld(welded), 0U);

    std::map<std::pair<float, float>, std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3f p = soup.vertices[soup.triangles[i][k]];
            const auto next = static_cast<std::uint32_t>(numbers.size());
            const std::uint32_t number = numbers.try_emplace({p.x, p.y}, next).first->second;
            ASSERT_EQ(welded.triangles[i][k], number);
            ASSERT_EQ(welded.vertices[number], p);
        }
    }
    EXPECT_EQ(welded.vertices.size(), numbers.size());
}

TEST(Weld, OfAWeldedMeshChangesNothing) {
    Mesh mesh = cube_soup();
    weld(mesh);
    const Mesh once = mesh;
    weld(mesh);
    EXPECT_EQ(mesh.vertices, once.vertices);
    EXPECT_EQ(mesh.triangles, once.triangles);
}

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

// ---- creases -----------------------------------------------------------------------------------

constexpr double kFullTurn = 2.0 * std::numbers::pi;

/// A grid of columns x rows cells; `place` gives the vertex at (i, j). Closed if it wraps around.
struct Grid {
    std::uint32_t columns, rows;
    bool wraps_columns = false, wraps_rows = false;
};

Mesh grid_mesh(const Grid& grid, const auto& place) {
    Mesh mesh;
    for (std::uint32_t j = 0; j <= grid.rows; ++j) {
        for (std::uint32_t i = 0; i <= grid.columns; ++i) {
            mesh.vertices.push_back(to_float(place(grid.wraps_columns ? i % grid.columns : i,
                                                   grid.wraps_rows ? j % grid.rows : j)));
        }
    }
    const std::uint32_t stride = grid.columns + 1;
    for (std::uint32_t j = 0; j < grid.rows; ++j) {
        for (std::uint32_t i = 0; i < grid.columns; ++i) {
            const std::uint32_t a = j * stride + i;
            mesh.triangles.push_back({a, a + 1, a + stride + 1});
            mesh.triangles.push_back({a, a + stride + 1, a + stride});
        }
    }
    weld(mesh);
    return mesh;
}

Mesh torus(std::uint32_t around, std::uint32_t about_tube) {
    return grid_mesh({around, about_tube, true, true}, [&](std::uint32_t i, std::uint32_t j) {
        const double a = kFullTurn * i / around, b = kFullTurn * j / about_tube;
        const double r = 1.0 + 0.4 * std::cos(b);
        return Vec3d{r * std::cos(a), r * std::sin(a), 0.4 * std::sin(b)};
    });
}

Mesh uv_sphere(std::uint32_t meridians, std::uint32_t parallels) {
    return grid_mesh({meridians, parallels, true}, [&](std::uint32_t i, std::uint32_t j) {
        const double a = kFullTurn * i / meridians;
        // The poles exactly, so that the triangles without area there go.
        const bool pole = j == 0 || j == parallels;
        const double b = std::numbers::pi * j / parallels;
        const double r = pole ? 0.0 : std::sin(b);
        return Vec3d{r * std::cos(a), r * std::sin(a), -std::cos(b)};
    });
}

/// About z, from z = 0 to 1, with flat caps.
Mesh cylinder(std::uint32_t sides, std::uint32_t rings) {
    // Rows 0 and rings + 2 are the centres of the caps.
    return grid_mesh({sides, rings + 2, true}, [&](std::uint32_t i, std::uint32_t j) {
        const double a = kFullTurn * i / sides;
        const double r = j == 0 || j == rings + 2 ? 0.0 : 1.0;
        const double z = std::clamp((static_cast<double>(j) - 1.0) / rings, 0.0, 1.0);
        return Vec3d{r * std::cos(a), r * std::sin(a), z};
    });
}

/// Two flat sheets that meet along y at a turn of `degrees`, each cut into `cuts` x `cuts`.
Mesh wedge(double degrees, std::uint32_t cuts) {
    const double half = degrees / 360.0 * std::numbers::pi;
    return grid_mesh({2 * cuts, cuts}, [&](std::uint32_t i, std::uint32_t j) {
        const double s = static_cast<double>(i) / cuts - 1.0;
        return Vec3d{s * std::cos(half), static_cast<double>(j) / cuts,
                     -std::abs(s) * std::sin(half)};
    });
}

std::size_t count_flags(const Mesh& mesh, unsigned flag) {
    std::size_t count = 0;
    for (const std::uint8_t flags : mesh.edge_flags) {
        for (unsigned k = 0; k < 3; ++k) count += (flags & flag << k) != 0 ? 1 : 0;
    }
    return count;
}

/// Creases with two triangles, which both know of them.
std::size_t creases(Mesh mesh) {
    smooth_normals(mesh);
    return count_flags(mesh, Mesh::kCreaseEdge) / 2;
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

// ---- seams -------------------------------------------------------------------------------------

/// A cylinder whose side and caps have rims of their own, the corners of which are off by up to
/// `error`: so CAD programs write bodies.
Mesh unsewn_cylinder(std::uint32_t sides, double error, bool in_parts = false) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> off(-0.5 * error, 0.5 * error);
    Mesh mesh;
    const auto corner = [&](std::uint32_t i, double z) {
        const double a = kFullTurn * (i % sides) / sides;
        mesh.vertices.push_back(
            to_float(Vec3d{std::cos(a) + off(random), std::sin(a) + off(random), z + off(random)}));
    };
    for (const double z : {0.0, 1.0, 0.0, 1.0}) {
        for (std::uint32_t i = 0; i < sides; ++i) corner(i, z);
    }
    const std::uint32_t cap = 2 * sides;
    for (std::uint32_t i = 0; i < sides; ++i) {
        const std::uint32_t j = (i + 1) % sides;
        mesh.triangles.push_back({i, j, sides + j});
        mesh.triangles.push_back({i, sides + j, sides + i});
    }
    for (std::uint32_t i = 1; i + 1 < sides; ++i) {
        mesh.triangles.push_back({cap, cap + i + 1, cap + i});
        mesh.triangles.push_back({cap + sides, cap + sides + i, cap + sides + i + 1});
    }
    if (in_parts) {
        mesh.parts.assign(mesh.triangles.size(), 1);
        std::fill_n(mesh.parts.begin(), 2 * sides, 0U);
    }
    weld(mesh);
    return mesh;
}

std::size_t open_edges(Mesh mesh) {
    smooth_normals(mesh);
    return count_flags(mesh, Mesh::kBoundaryEdge);
}

TEST(Stitch, ClosesABodyWhoseFacesHaveRoundedCorners) {
    constexpr std::uint32_t kSides = 24;
    for (const double error : {1e-6, 1e-5, 1e-4}) {
        Mesh mesh = unsewn_cylinder(kSides, error);
        EXPECT_EQ(open_edges(mesh), 4 * kSides) << error;
        EXPECT_EQ(stitch(mesh), 2 * kSides) << error;
        EXPECT_EQ(mesh.vertices.size(), 2 * kSides) << error;
        EXPECT_EQ(open_edges(mesh), 0U) << error;
        EXPECT_EQ(creases(mesh), 2 * kSides) << error;
    }
}

TEST(Stitch, LeavesAGapThatIsOfTheShape) {
    // Once wider than 1e-4 of the size, once than a tenth of the edges.
    Mesh wide = unsewn_cylinder(24, 2e-3);
    EXPECT_EQ(stitch(wide), 0U);
    Mesh fine = unsewn_cylinder(200'000, 2e-5);
    EXPECT_LT(stitch(fine), 4'000U);
}

TEST(Stitch, KeepsPartsApart) {
    Mesh mesh = unsewn_cylinder(24, 1e-5, true);
    EXPECT_EQ(stitch(mesh), 0U);
}

TEST(Stitch, ChangesNothingWhereNoSeamIs) {
    for (const Mesh& mesh : {torus(24, 12), wedge(30.0, 8), sphere(3)}) {
        Mesh after = mesh;
        EXPECT_EQ(stitch(after), 0U);
        EXPECT_EQ(after.vertices, mesh.vertices);
        EXPECT_EQ(after.triangles, mesh.triangles);
    }
}

TEST(Stitch, TakesNoLongWhereAllCornersAreOpen) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> at(0.0F, 1.0F), off(0.0F, 1e-3F);
    Mesh soup;
    for (std::uint32_t i = 0; i < 200'000; ++i) {
        const Vec3f p{at(random), at(random), at(random)};
        soup.vertices.insert(soup.vertices.end(), {p, p + Vec3f{off(random), off(random), 0},
                                                   p + Vec3f{0, off(random), off(random)}});
        soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const auto start = std::chrono::steady_clock::now();
    stitch(soup);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
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

// ---- real meshes -------------------------------------------------------------------------------

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
