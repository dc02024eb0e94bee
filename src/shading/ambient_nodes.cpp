#include "shading/ambient_nodes.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace ink {

namespace {

/// Nodes along the side of a sphere's grid, which is an octahedron unfolded to a square.
constexpr int ball_side(std::size_t grid) { return grid == 0 ? 8 : 12 << grid; }
/// Nodes that a sphere needs which the picture shows with this radius. What is kept at them varies
/// slowly over the sphere, so they may be the farther apart the larger it is: on spheres of 8
/// pixels 2.4, of 100 pixels 7.
float ball_nodes(float radius_px) { return 3.4F * std::sqrt(radius_px); }

/// Along the sides of a triangle.
constexpr int triangle_side(std::size_t grid) { return 1 << grid; }
constexpr float kTriangleSpacing = 6.0F;  ///< pixels between nodes, at most
/// Smaller triangles have nodes at their corners alone, which they share.
constexpr float kSmallTriangle = 14.0F;

/// The first grid, from one on, of at least so many nodes.
template <class Side>
std::size_t grid_for(float nodes, std::size_t first, std::size_t grids, const Side& side) {
    std::size_t grid = first;
    while (grid + 1 < grids && static_cast<float>(side(grid)) < nodes) ++grid;
    return grid;
}

/// A unit vector to a point of [-1, 1]^2: the octahedral map, as in scene/mesh.h.
Vec2f unfold(Vec3f n) {
    const float scale = 1.0F / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
    const Vec2f p{n.x * scale, n.y * scale};
    if (n.z >= 0.0F) return p;
    return {std::copysign(1.0F - std::abs(p.y), p.x), std::copysign(1.0F - std::abs(p.x), p.y)};
}

Vec3f fold(Vec2f p) {
    const float z = 1.0F - std::abs(p.x) - std::abs(p.y);
    const float under = std::max(-z, 0.0F);
    return normalize(Vec3f{p.x - std::copysign(under, p.x), p.y - std::copysign(under, p.y), z});
}

/// Surroundings of the balls that a thread asked about last: a picture comes back to a ball many
/// times before it is done with it.
struct RecentSurroundings {
    static constexpr std::size_t kEntries = 256;
    struct Entry {
        std::uint64_t bake = 0;
        std::size_t ball = 0;
        Surroundings surroundings;
    };
    std::vector<Entry> entries{kEntries};
};

std::uint64_t next_number() {
    static std::atomic<std::uint64_t> number{0};
    return ++number;
}

}  // namespace

AmbientBake::Impl::Impl(const Scene& all, const Tracer& scene_tracer, int quality,
                        const std::atomic<bool>* cancel)
    : scene(all),
      strings(StickStrings::of(scene)),
      directions(strings ? std::min(6 << quality, 96) : 3 << quality),
      rays(scene_tracer, 16 << quality),
      number(next_number()) {
    std::size_t ball_count = 0;
    std::size_t triangles = 0;
    std::size_t corners = 0;
    bool balls_only = true;
    for (const Object& object : scene.objects()) {
        first_ball.push_back(ball_count);
        first_triangle.push_back(triangles);
        first_vertex.push_back(corners);
        if (const auto* spheres = std::get_if<Spheres>(&object.shape)) {
            ball_count += spheres->count();
        } else {
            balls_only = false;
        }
        if (const auto* mesh = std::get_if<Mesh>(&object.shape)) {
            triangles += mesh->triangles.size();
            corners += mesh->vertices.size();
        }
    }
    if (balls_only) ball_sky.emplace(scene, directions, cancel);
    if (strings) ball_sky.emplace(strings->balls(), directions, cancel);
    balls = LazyTable<BallBake>(ball_count);
    triangle_maps = LazyTable<NodeMaps<2 * kTriangleGrids>>(triangles);
    vertices = std::make_unique<std::atomic<std::uint64_t>[]>(corners);
}

Surroundings& AmbientBake::Impl::surroundings(const Sphere& ball, std::size_t ball_number) const {
    thread_local RecentSurroundings recent;
    auto& entry = recent.entries[ball_number % RecentSurroundings::kEntries];
    if (entry.bake != number || entry.ball != ball_number) {
        ball_sky->survey(ball, entry.surroundings);
        entry.bake = number;
        entry.ball = ball_number;
    }
    return entry.surroundings;
}

AmbientBake::Impl::BallBake& AmbientBake::Impl::bake_of(const Sphere& ball,
                                                        std::size_t ball_number) const {
    return balls.at(ball_number, [&] {
        auto fresh = std::make_unique<BallBake>();
        if (ball_sky) fresh->contacts = BallSky::contacts(ball, surroundings(ball, ball_number));
        return fresh;
    });
}

std::size_t AmbientBake::Impl::ball_grid(float radius_px) {
    return grid_for(ball_nodes(radius_px), kCoarseBallGrid + 1, kBallGrids, ball_side);
}

/// Of lanes that see one ball, between nodes.
void AmbientBake::Impl::on_ball(const Sphere& ball, std::size_t ball_number,
                                std::size_t grid_number, std::uint32_t lanes,
                                const NormalPacket& normals, Lanes<float>& open) const {
    const int side = ball_side(grid_number);
    const auto nodes = static_cast<std::size_t>((side + 1) * (side + 1));
    BallBake& bake = bake_of(ball, ball_number);
    const auto grid = bake.maps.grid(grid_number, nodes);
    const auto half = 0.5F * static_cast<float>(side);
    const auto compute = [&](int column, int row) {
        const Vec3f at =
            fold({static_cast<float>(column) / half - 1.0F, static_cast<float>(row) / half - 1.0F});
        if (!ball_sky) return rays.openness(ball.centre + at * ball.radius, at);
        return (at_point(ball, ball_number, at) + kRaise) /
               (BallSky::contact_openness(bake.contacts, ball.radius, at) + kRaise);
    };
    const auto value = [&](int column, int row) {
        return grid.value(static_cast<std::size_t>(row * (side + 1) + column),
                          [&] { return compute(column, row); });
    };
    for_lanes(lanes, [&](int lane) {
        const Vec2f place = unfold({normals.x[lane], normals.y[lane], normals.z[lane]});
        const float x = (place.x + 1.0F) * half;
        const float y = (place.y + 1.0F) * half;
        const int i = std::clamp(static_cast<int>(x), 0, side - 1);
        const int j = std::clamp(static_cast<int>(y), 0, side - 1);
        const float a = x - static_cast<float>(i);
        const float b = y - static_cast<float>(j);
        const float top = value(i, j) + a * (value(i + 1, j) - value(i, j));
        const float bottom = value(i, j + 1) + a * (value(i + 1, j + 1) - value(i, j + 1));
        open[lane] = top + b * (bottom - top);
    });
    if (!ball_sky) return;
    Lanes<float> at_contacts;
    BallSky::contact_openness(bake.contacts, ball.radius, normals, at_contacts);
    for_lanes(lanes, [&](int lane) {
        const float raised = open[lane] * (at_contacts[lane] + kRaise);
        open[lane] = std::clamp(raised - kRaise, 0.0F, 1.0F);
    });
}

float AmbientBake::Impl::on_stick(std::uint32_t object, std::uint32_t primitive, Vec3f point,
                                  Vec3f n) const {
    const std::size_t nearest = strings->nearest(object, primitive, point);
    const Sphere& ball = strings->balls()[nearest];
    return ball_sky->openness(ball, surroundings(ball, nearest), point - ball.centre, n);
}

/// Where many triangles share a vertex and its normal, so do they its openness.
float AmbientBake::Impl::at_vertex(std::uint32_t object, const Mesh& mesh,
                                   const TriangleCorners& corners, std::uint32_t triangle,
                                   std::size_t corner) const {
    const Vec3f n = corners.normals[corner];
    const auto compute = [&] { return rays.openness(corners.points[corner], n); };
    if (!corners.smooth) return compute();
    constexpr float kSteps = 65535.0F;
    std::atomic<std::uint64_t>& kept =
        vertices[first_vertex[object] + mesh.triangles[triangle][corner]];
    const std::uint64_t key = std::uint64_t{pack_normal(n)} << 32U | 1U << 16U;
    std::uint64_t entry = kept.load(std::memory_order_relaxed);
    if ((entry & ~std::uint64_t{0xFFFF}) != key) {
        entry = key | static_cast<std::uint64_t>(compute() * kSteps + 0.5F);
        kept.store(entry, std::memory_order_relaxed);
    }
    return static_cast<float>(entry & 0xFFFFU) * (1.0F / kSteps);
}

float AmbientBake::Impl::on_triangle(const HitPacket& hits, int lane,
                                     const TriangleCorners& corners, float footprint) const {
    const std::uint32_t object = hits.object[lane];
    const std::uint32_t triangle = hits.primitive[lane];
    const float u = hits.u[lane];
    const float v = hits.v[lane];
    const float longest = corners.longest() / footprint;
    const float nodes_needed = longest > kSmallTriangle ? longest / kTriangleSpacing : 1.0F;
    const std::size_t level = grid_for(nodes_needed, 0, kTriangleGrids, triangle_side);
    const int side = triangle_side(level);
    const float pixels = corners.area() / (footprint * footprint);
    // A sliver has more nodes than pixels.
    if (0.5F * static_cast<float>(side * side) > 4.0F + pixels) {
        return rays.openness(corners.point(u, v), corners.normal(u, v));
    }
    if (side == 1) {
        const auto& mesh = std::get<Mesh>(scene.objects()[object].shape);
        const auto at = [&](std::size_t k) {
            return at_vertex(object, mesh, corners, triangle, k);
        };
        return (1.0F - u - v) * at(0) + u * at(1) + v * at(2);
    }
    const auto nodes = static_cast<std::size_t>((side + 1) * (side + 1));
    const auto grid = triangle_maps
                          .at(first_triangle[object] + triangle,
                              [] { return std::make_unique<NodeMaps<2 * kTriangleGrids>>(); })
                          .grid(level + (corners.from_behind ? kTriangleGrids : 0), nodes);
    const auto value = [&](int i, int j) {
        return grid.value(static_cast<std::size_t>(j * (side + 1) + i), [&] {
            const float to_u = static_cast<float>(i) / static_cast<float>(side);
            const float to_v = static_cast<float>(j) / static_cast<float>(side);
            return rays.openness(corners.point(to_u, to_v), corners.normal(to_u, to_v));
        });
    };
    const float x = std::clamp(u, 0.0F, 1.0F) * static_cast<float>(side);
    const float y = std::clamp(v, 0.0F, 1.0F) * static_cast<float>(side);
    const int i = std::min(static_cast<int>(x), side - 1);
    const int j = std::min(static_cast<int>(y), side - 1 - i);
    const float a = x - static_cast<float>(i);
    const float b = y - static_cast<float>(j);
    if (a + b <= 1.0F || i + j + 2 > side) {
        return value(i, j) + a * (value(i + 1, j) - value(i, j)) +
               b * (value(i, j + 1) - value(i, j));
    }
    const float far = value(i + 1, j + 1);
    return far + (1.0F - a) * (value(i, j + 1) - far) + (1.0F - b) * (value(i + 1, j) - far);
}

}  // namespace ink
