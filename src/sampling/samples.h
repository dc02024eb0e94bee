#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "base/vec.h"
#include "scene/ids.h"

namespace ink {

/// The sphere that a hit lies on, where it does: its outline and its seams with others can then be
/// computed instead of searched.
struct Ball {
    Vec3f centre;         ///< scene frame
    float radius = 0.0F;  ///< 0: not a sphere

    explicit operator bool() const { return radius > 0.0F; }
    friend constexpr bool operator==(const Ball& a, const Ball& b) = default;
};

inline constexpr std::uint32_t kNoTriangle = 0xFFFFFFFFU;

/// What one ray saw, as far as lines depend on it.
struct Sample {
    GeometryId id = kBackground;
    Vec3f position;  ///< scene frame; unset on a miss
    Vec3f normal;    ///< shading normal, unit, faces the viewer; unset on a miss
    float t = 0.0F;  ///< distance along the ray from the plane on which all rays start, scene units
    Vec3f facet{};   ///< geometric normal, unit, faces the viewer; zero where it is not known
    Ball ball{};
    /// Distance to the nearest open edge of the triangle that was hit, scene units; infinite where
    /// it has none.
    float rim = std::numeric_limits<float>::infinity();
    /// The triangle that was hit; kNoTriangle elsewhere.
    std::uint32_t object = kNoTriangle, triangle = kNoTriangle;
    /// Direction of the ray where it is not the viewer's: behind a mirror or glass. Else zero.
    Vec3f ray{};
};

/// From where rays come.
struct Viewpoint {
    Vec3f eye;  ///< perspective: where all rays meet, scene frame
    Vec3f dir;  ///< orthographic: direction of all rays, unit
    bool parallel = false;
    /// The ray through screen point p (pixels) starts at origin(p) and runs along direction(p), not
    /// of unit length; both are affine in p.
    struct Affine {
        Vec3d at_zero, dx, dy;
        Vec3d operator()(Vec2f p) const {
            return at_zero + dx * static_cast<double>(p.x) + dy * static_cast<double>(p.y);
        }
    };
    Affine origin, direction;

    Vec3f ray_direction(Vec3f at) const { return parallel ? dir : normalize(at - eye); }
    /// Of the ray that made a sample.
    Vec3f ray_direction(const Sample& sample) const {
        return sample.ray == Vec3f{} ? ray_direction(sample.position) : sample.ray;
    }
};

/// Asks for samples at points of the screen (pixels): as many out as in.
using SampleFunction = std::function<void(std::span<const Vec2f> points, std::span<Sample> out)>;

/// Adds to a sample of a grid, by its index, what the grid does not keep: facet, ball and rim, and
/// perhaps position and normal.
using SurfaceFunction = std::function<void(std::size_t point, Sample& sample)>;

/// Where the way from one point of the screen, the sample's own, to another leaves the triangle
/// that the sample lies on, in [0, 1]; 1 if it does not, or there is no triangle.
using WayOutFunction = std::function<double(const Sample& sample, Vec2f from, Vec2f to)>;

/// Samples at the points of a regular lattice of q x q a pixel, plane by plane. Point (i, j) of the
/// grid is lattice point (x0 + i, y0 + j), at ((x0 + i + 1/2) / q, (y0 + j + 1/2) / q) on screen.
struct SampleGrid {
    int x0 = 0, y0 = 0;
    int width = 0, height = 0;  ///< points
    float spacing = 1.0F;       ///< 1 / q, pixels

    std::vector<GeometryId> id;
    std::vector<float> px, py, pz;  ///< position
    std::vector<float> nx, ny, nz;  ///< normal
    std::vector<float> t;
    /// Empty, or which surface was hit: between two points with the same number runs no line, if it
    /// is less than kUnknownSurface. Unset on a miss.
    std::vector<std::uint32_t> surface;
    static constexpr std::uint32_t kUnknownSurface = 1U << 31U;

    void resize(int new_width, int new_height) {
        width = new_width;
        height = new_height;
        // Loops over a row may read a vector beyond its end.
        const auto size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) + 16;
        id.resize(size);
        for (auto* plane : {&px, &py, &pz, &nx, &ny, &nz, &t}) plane->resize(size);
    }
    std::size_t index(int i, int j) const {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(i);
    }
    Vec2f point(int i, int j) const {
        return {(static_cast<float>(x0 + i) + 0.5F) * spacing,
                (static_cast<float>(y0 + j) + 0.5F) * spacing};
    }
    /// Without facet, ball and rim, which the grid does not keep.
    Sample sample(std::size_t k) const {
        return {id[k], {px[k], py[k], pz[k]}, {nx[k], ny[k], nz[k]}, t[k]};
    }
};

}  // namespace ink
