#include "scene/mesh.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <utility>

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
    smooth_normals(mesh, 35.f);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& [a, b, c] = mesh.triangles[i];
        const Vec3f flat = normalize(
            cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]));
        for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(corner_normal(mesh, i, k), flat);
    }
}

TEST(SmoothNormals, OfASpherePointAwayFromItsCentre) {
    Mesh mesh = sphere(4);
    smooth_normals(mesh, 35.f);
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
    smooth_normals(mesh, 35.f);
    smooth_normals(tiny, 35.f);
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
        smooth_normals(mesh, 35.f);
        EXPECT_LT(angle_between(corner_normal(mesh, 0, 0), {0, 0, 1}), 1e-3) << sides;
    }
}

TEST(SmoothNormals, TakeLinearTimeAboutOneVertex) {
    Mesh mesh = cone(300'000);
    const auto start = std::chrono::steady_clock::now();
    smooth_normals(mesh, 35.f);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    EXPECT_LT(taken.count(), 10.0);  // all pairs would take minutes
}

TEST(SmoothNormals, AreUnitVectorsForATriangleWithoutArea) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    mesh.triangles = {{0, 1, 2}};
    smooth_normals(mesh, 35.f);
    EXPECT_NEAR(length(corner_normal(mesh, 0, 0)), 1.f, 1e-6f);
}

}  // namespace
}  // namespace ink
