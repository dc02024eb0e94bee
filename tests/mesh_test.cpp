#include "scene/mesh.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "known_meshes.h"

namespace ink {
namespace {

using namespace test;

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

}  // namespace
}  // namespace ink
