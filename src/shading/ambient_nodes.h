#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "shading/ambient.h"
#include "shading/ball_sky.h"
#include "shading/node_map.h"
#include "shading/ray_sky.h"
#include "shading/sky_directions.h"
#include "shading/stick_strings.h"
#include "shading/triangle_corners.h"

namespace ink {

template <class Body>
void for_lanes(std::uint32_t lanes, const Body& body) {
    for (; lanes != 0; lanes &= lanes - 1) body(std::countr_zero(lanes));
}

/// What a bake keeps at the nodes of grids over balls and triangles, and what it computes between
/// them.
struct AmbientBake::Impl {
    Impl(const Scene& all, const Tracer& scene_tracer, int quality,
         const std::atomic<bool>* cancel);

    static constexpr std::size_t kBallGrids = 5;
    static constexpr std::size_t kCoarseBallGrid = 0;  ///< for SmallBalls::by_nodes
    static constexpr std::size_t kTriangleGrids = 8;
    /// Below this radius on the picture there are fewer pixels than nodes, and each is computed.
    static constexpr float kLeastBallGrid = 12.0F;

    /// Of a ball: openness over that of its contacts alone, both raised by kRaise.
    struct BallBake {
        NodeMaps<kBallGrids> maps;
        BallPacket contacts{};
    };
    static constexpr float kRaise = 0.1F;  ///< keeps quotients small where both are
    Surroundings& surroundings(const Sphere& ball, std::size_t ball_number) const;
    BallBake& bake_of(const Sphere& ball, std::size_t ball_number) const;
    /// Whether every point is computed of balls of this size.
    bool each_point(float radius_px) const {
        // Towards strings, which have many balls that touch, quotients do not vary slowly.
        return ball_sky && (strings || radius_px < kLeastBallGrid);
    }
    float at_point(const Sphere& ball, std::size_t ball_number, Vec3f n) const {
        return ball_sky->openness(ball, surroundings(ball, ball_number), n * ball.radius, n);
    }
    /// Of a ball that has nodes in any picture, by its radius there.
    static std::size_t ball_grid(float radius_px);
    void on_ball(const Sphere& ball, std::size_t ball_number, std::size_t grid_number,
                 std::uint32_t lanes, const NormalPacket& normals, Lanes<float>& open) const;
    float on_stick(std::uint32_t object, std::uint32_t primitive, Vec3f point, Vec3f n) const;
    float on_triangle(const HitPacket& hits, int lane, const TriangleCorners& corners,
                      float footprint) const;
    float at_vertex(std::uint32_t object, const Mesh& mesh, const TriangleCorners& corners,
                    std::uint32_t triangle, std::size_t corner) const;

    const Scene& scene;
    std::optional<StickStrings> strings;
    SkyDirections directions;  ///< thin things take more
    RaySky rays;
    std::optional<BallSky> ball_sky;  ///< unless there is anything but balls and sticks
    std::vector<std::size_t> first_ball, first_triangle, first_vertex;  ///< of each object
    LazyTable<BallBake> balls;
    LazyTable<NodeMaps<2 * kTriangleGrids>> triangle_maps;  ///< of either side
    /// Of vertices with smooth normals: the packed normal and the openness that goes with it.
    std::unique_ptr<std::atomic<std::uint64_t>[]> vertices;
    std::uint64_t number;  ///< unlike that of any other bake
};

}  // namespace ink
