#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "scene/mesh.h"

/// Meshes whose creases and normals are known.
namespace ink::test {

/// The cube [-1, 1]^3, each triangle with corners of its own.
inline Mesh cube_soup() {
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
inline Mesh sphere(int levels) {
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

inline constexpr double kFullTurn = 2.0 * std::numbers::pi;

/// A grid of columns x rows cells; `place` gives the vertex at (i, j). Closed if it wraps around.
struct Grid {
    std::uint32_t columns, rows;
    bool wraps_columns = false, wraps_rows = false;
};

inline Mesh grid_mesh(const Grid& grid, const auto& place) {
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

inline Mesh torus(std::uint32_t around, std::uint32_t about_tube) {
    return grid_mesh({around, about_tube, true, true}, [&](std::uint32_t i, std::uint32_t j) {
        const double a = kFullTurn * i / around, b = kFullTurn * j / about_tube;
        const double r = 1.0 + 0.4 * std::cos(b);
        return Vec3d{r * std::cos(a), r * std::sin(a), 0.4 * std::sin(b)};
    });
}

inline Mesh uv_sphere(std::uint32_t meridians, std::uint32_t parallels) {
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
inline Mesh cylinder(std::uint32_t sides, std::uint32_t rings) {
    // Rows 0 and rings + 2 are the centres of the caps.
    return grid_mesh({sides, rings + 2, true}, [&](std::uint32_t i, std::uint32_t j) {
        const double a = kFullTurn * i / sides;
        const double r = j == 0 || j == rings + 2 ? 0.0 : 1.0;
        const double z = std::clamp((static_cast<double>(j) - 1.0) / rings, 0.0, 1.0);
        return Vec3d{r * std::cos(a), r * std::sin(a), z};
    });
}

/// Two flat sheets that meet along y at a turn of `degrees`, each cut into `cuts` x `cuts`.
inline Mesh wedge(double degrees, std::uint32_t cuts) {
    const double half = degrees / 360.0 * std::numbers::pi;
    return grid_mesh({2 * cuts, cuts}, [&](std::uint32_t i, std::uint32_t j) {
        const double s = static_cast<double>(i) / cuts - 1.0;
        return Vec3d{s * std::cos(half), static_cast<double>(j) / cuts,
                     -std::abs(s) * std::sin(half)};
    });
}

inline std::size_t count_flags(const Mesh& mesh, unsigned flag) {
    std::size_t count = 0;
    for (const std::uint8_t flags : mesh.edge_flags) {
        for (unsigned k = 0; k < 3; ++k) count += (flags & flag << k) != 0 ? 1 : 0;
    }
    return count;
}

/// Creases with two triangles, which both know of them.
inline std::size_t creases(Mesh mesh) {
    smooth_normals(mesh);
    return count_flags(mesh, Mesh::kCreaseEdge) / 2;
}

inline double angle_between(Vec3f a, Vec3f b) {
    const Vec3d u = to_double(a), v = to_double(b);
    return std::atan2(length(cross(u, v)), dot(u, v));
}

inline Vec3f corner_normal(const Mesh& mesh, std::size_t triangle, std::size_t corner) {
    return unpack_normal(mesh.corner_normals[triangle][corner]);
}

}  // namespace ink::test
