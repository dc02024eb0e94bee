#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <optional>
#include <variant>
#include <vector>

#include "shading/ambient.h"
#include "shading/ball_sky.h"
#include "shading/node_map.h"
#include "shading/ray_sky.h"
#include "shading/secondary_rays.h"
#include "shading/sky_directions.h"
#include "shading/stick_strings.h"

namespace ink {

namespace {

/// Nodes along the side of a sphere's grid, which is an octahedron unfolded to a square.
constexpr std::size_t kBallGrids = 4;
constexpr int ball_side(std::size_t grid) { return 24 << grid; }
/// Below this radius on the picture there are fewer pixels than nodes, and each is computed.
constexpr float kLeastBallGrid = 12.0F;
/// Nodes that a sphere needs which the picture shows with this radius. What is kept at them varies
/// slowly over the sphere, so they may be the farther apart the larger it is: on spheres of 8
/// pixels 2.4, of 100 pixels 7.
float ball_nodes(float radius_px) { return 3.4F * std::sqrt(radius_px); }

/// Along the sides of a triangle.
constexpr std::size_t kTriangleGrids = 8;
constexpr int triangle_side(std::size_t grid) { return 1 << grid; }
constexpr float kTriangleSpacing = 6.0F;  ///< pixels between nodes, at most
/// Smaller triangles have nodes at their corners alone, which they share.
constexpr float kSmallTriangle = 14.0F;

/// The first grid of at least so many nodes.
template <class Side>
std::size_t grid_for(float nodes, std::size_t grids, const Side& side) {
    std::size_t grid = 0;
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

template <class Body>
void for_lanes(std::uint32_t lanes, const Body& body) {
    for (; lanes != 0; lanes &= lanes - 1) body(std::countr_zero(lanes));
}

/// A triangle's corners and the normals there, which face the side that is seen.
struct Corners {
    std::array<Vec3f, 3> points, normals;
    bool from_behind;
    bool smooth;

    Vec3f point(float u, float v) const {
        return points[0] * (1.0F - u - v) + points[1] * u + points[2] * v;
    }
    Vec3f normal(float u, float v) const {
        return normalize(normals[0] * (1.0F - u - v) + normals[1] * u + normals[2] * v);
    }
    float longest() const {
        return std::max({length(points[1] - points[0]), length(points[2] - points[1]),
                         length(points[0] - points[2])});
    }
    float area() const {
        return 0.5F * length(cross(points[1] - points[0], points[2] - points[0]));
    }
};

Corners corners_of(const Mesh& mesh, std::uint32_t triangle, Vec3f seen_normal) {
    Corners corners{};
    for (std::size_t k = 0; k < 3; ++k) {
        corners.points[k] = mesh.vertices[mesh.triangles[triangle][k]];
    }
    const Vec3f across =
        cross(corners.points[1] - corners.points[0], corners.points[2] - corners.points[0]);
    corners.from_behind = dot(across, seen_normal) < 0.0F;
    const Vec3f facet = corners.from_behind ? -across : across;
    const float size = length(facet);
    corners.normals.fill(size > 0.0F ? facet * (1.0F / size) : seen_normal);
    corners.smooth = !mesh.corner_normals.empty();
    for (std::size_t k = 0; corners.smooth && k < 3; ++k) {
        const Vec3f n = unpack_normal(mesh.corner_normals[triangle][k]);
        corners.normals[k] = dot(n, facet) < 0.0F ? -n : n;
    }
    // Opposite normals cancel somewhere between them.
    const auto& n = corners.normals;
    const bool opposed = std::min({dot(n[0], n[1]), dot(n[1], n[2]), dot(n[2], n[0])}) < -0.5F;
    if (opposed && size > 0.0F) corners.normals.fill(facet * (1.0F / size));
    return corners;
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

struct AmbientBake::Impl {
    Impl(const Scene& all, const Tracer& scene_tracer, int quality, const std::atomic<bool>* cancel)
        : scene(all),
          strings(StickStrings::of(scene)),
          directions(strings ? std::min(6 << quality, 96) : 3 << quality),
          rays(scene_tracer, 16 << quality) {
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
    void on_ball(const Sphere& ball, std::size_t ball_number, float radius_px, std::uint32_t lanes,
                 const NormalPacket& normals, Lanes<float>& open) const;
    float on_stick(std::uint32_t object, std::uint32_t primitive, Vec3f point, Vec3f n) const;
    float on_triangle(const HitPacket& hits, int lane, const Corners& corners,
                      float footprint) const;
    float at_vertex(std::uint32_t object, const Mesh& mesh, const Corners& corners,
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
    std::uint64_t number = next_number();
};

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

/// Of lanes that see one large ball, between nodes.
void AmbientBake::Impl::on_ball(const Sphere& ball, std::size_t ball_number, float radius_px,
                                std::uint32_t lanes, const NormalPacket& normals,
                                Lanes<float>& open) const {
    const std::size_t level = grid_for(ball_nodes(radius_px), kBallGrids, ball_side);
    const int side = ball_side(level);
    const auto nodes = static_cast<std::size_t>((side + 1) * (side + 1));
    BallBake& bake = bake_of(ball, ball_number);
    const auto grid = bake.maps.grid(level, nodes);
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
float AmbientBake::Impl::at_vertex(std::uint32_t object, const Mesh& mesh, const Corners& corners,
                                   std::uint32_t triangle, std::size_t corner) const {
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

float AmbientBake::Impl::on_triangle(const HitPacket& hits, int lane, const Corners& corners,
                                     float footprint) const {
    const std::uint32_t object = hits.object[lane];
    const std::uint32_t triangle = hits.primitive[lane];
    const float u = hits.u[lane];
    const float v = hits.v[lane];
    const float longest = corners.longest() / footprint;
    const float nodes_needed = longest > kSmallTriangle ? longest / kTriangleSpacing : 1.0F;
    const std::size_t level = grid_for(nodes_needed, kTriangleGrids, triangle_side);
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

namespace {

/// What pixels of a picture cover of a scene.
class Footprints {
  public:
    explicit Footprints(const Camera& camera)
        : eye_(camera.eye()), back_(camera.back()), parallel_(camera.orthographic()) {
        const Camera::RayField& field = camera.ray_field();
        pixel_ = length(parallel_ ? field.origin_dx : field.dir_dx);
    }
    /// Distance between rays of neighbouring pixels at a point, scene units.
    float at(Vec3f p) const {
        if (parallel_) return pixel_;
        return pixel_ * std::max(dot(eye_ - p, back_), 1e-6F);
    }

  private:
    Vec3f eye_, back_;
    bool parallel_;
    float pixel_;
};

/// Lanes that see the same primitive as one.
std::uint32_t same_surface(const HitPacket& hits, int lane) {
    std::uint32_t same = 0;
    for (int i = 0; i < kLanes; ++i) {
        const bool is_same =
            hits.object[i] == hits.object[lane] && hits.primitive[i] == hits.primitive[lane];
        same |= std::uint32_t{is_same} << static_cast<unsigned>(i);
    }
    return same;
}

bool has(std::uint32_t lanes, int lane) { return (lanes >> static_cast<unsigned>(lane) & 1U) != 0; }

/// Of a block of 4 x 4 pixels every other one, but for corners: those which lie between two that
/// any tile with the pixel has, also one that ends with the first row or column of the block.
constexpr std::uint32_t kBetween = 0b0100'1010'0101'0010;

/// Of a row or column of sixteen along the edge of such blocks, the same.
constexpr std::uint32_t kBetweenInStrip = 0b0010'0010'0010'0010;

/// What lies between two pixels is computed where their openness differs by more. Adds 0.0004 to
/// the error on a ribosome, and saves an eighth of the pixels.
constexpr float kAgree = 0.035F;

/// Openness of a point of a ball about half way between two others, by theirs. That of a sky that
/// is the same for both would be linear in the normal: the mean of the two belongs to the mean of
/// their normals, which is shorter. None where they differ, or where it lies elsewhere, as in a
/// curved mirror.
std::optional<float> between_two(const NormalPacket& normals, const Lanes<float>& open, int a,
                                 int middle, int b) {
    constexpr float kHalfWay = 0.999F;  // cosine of an angle
    if (std::abs(open[a] - open[b]) > kAgree) return {};
    const Vec3f sum{normals.x[a] + normals.x[b], normals.y[a] + normals.y[b],
                    normals.z[a] + normals.z[b]};
    const float size = length(sum);
    const Vec3f n{normals.x[middle], normals.y[middle], normals.z[middle]};
    if (dot(n, sum) < kHalfWay * size) return {};
    return (open[a] + open[b]) / size;
}

class SeenBake final : public AmbientOcclusion {
  public:
    SeenBake(const AmbientBake::Impl& bake, const Camera& camera)
        : bake_(bake), footprints_(camera) {}

    void openness(const SurfacePacket& surface, Lanes<float>& open) const override {
        const HitPacket& hits = surface.hits;
        // Primitive by primitive: what there is about a ball stays in the nearest cache.
        std::uint32_t rest = (1U << kLanes) - 1U;
        while (rest != 0) {
            const int first = std::countr_zero(rest);
            const std::uint32_t own = same_surface(hits, first) & rest;
            rest &= ~own;
            if (hits.object[first] == kNoObject) {
                for_lanes(own, [&](int i) { open[i] = 1.0F; });
            } else if (std::holds_alternative<Spheres>(shape_of(hits, first))) {
                find_on_ball(surface, own, open);
            } else {
                for_lanes(own, [&](int i) { open[i] = at(surface, i); });
            }
        }
    }

  private:
    /// Of lanes that see one ball. Where every point is computed, on small balls, what lies between
    /// two pixels that nearly agree is not.
    void find_on_ball(const SurfacePacket& surface, std::uint32_t own, Lanes<float>& open) const {
        const HitPacket& hits = surface.hits;
        const int any = std::countr_zero(own);
        const std::uint32_t primitive = hits.primitive[any];
        const Sphere ball = std::get<Spheres>(shape_of(hits, any)).at(primitive);
        const std::size_t ball_number = bake_.first_ball[hits.object[any]] + primitive;
        const float radius_px = ball.radius / footprints_.at(ball.centre);
        const NormalPacket& normals = surface.normals;
        if (!bake_.each_point(radius_px)) {
            bake_.on_ball(ball, ball_number, radius_px, own, normals, open);
            return;
        }
        const auto at_point = [&](int i) {
            return bake_.at_point(ball, ball_number, {normals.x[i], normals.y[i], normals.z[i]});
        };
        const PointPacket& at_screen = surface.points;
        const bool is_block =
            at_screen.x[kBlockSide] == at_screen.x[0] && at_screen.y[1] == at_screen.y[0];
        const std::uint32_t spared = is_block ? kBetween : kBetweenInStrip;
        const std::uint32_t between = bake_.strings ? 0U : own & spared;
        for_lanes(own & ~between, [&](int i) { open[i] = at_point(i); });
        for_lanes(between, [&](int i) {
            float sum = 0.0F;
            float pairs = 0.0F;
            const auto add = [&](int a, int b) {
                if (!has(own, a) || !has(own, b)) return;
                const auto found = between_two(normals, open, a, i, b);
                if (!found) return;
                sum += *found;
                pairs += 1.0F;
            };
            const bool inside = i % kBlockSide != 0 && i % kBlockSide != kBlockSide - 1;
            if (!is_block || inside) add(i - 1, i + 1);
            if (is_block && i / kBlockSide != 0 && i / kBlockSide != kBlockSide - 1) {
                add(i - kBlockSide, i + kBlockSide);
            }
            open[i] = pairs > 0.0F ? std::min(sum / pairs, 1.0F) : at_point(i);
        });
    }

    const Shape& shape_of(const HitPacket& hits, int i) const {
        return bake_.scene.objects()[hits.object[i]].shape;
    }

    /// Of anything but balls.
    float at(const SurfacePacket& surface, int i) const {
        const HitPacket& hits = surface.hits;
        const Shape& shape = shape_of(hits, i);
        const Vec3f normal{surface.normals.x[i], surface.normals.y[i], surface.normals.z[i]};
        if (const auto* mesh = std::get_if<Mesh>(&shape)) {
            const Corners corners = corners_of(*mesh, hits.primitive[i], normal);
            return bake_.on_triangle(hits, i, corners,
                                     footprints_.at(corners.point(0.3333F, 0.3333F)));
        }
        const Vec3f p{surface.rays.origin_x[i] + hits.t[i] * surface.rays.dir_x[i],
                      surface.rays.origin_y[i] + hits.t[i] * surface.rays.dir_y[i],
                      surface.rays.origin_z[i] + hits.t[i] * surface.rays.dir_z[i]};
        if (bake_.strings) return bake_.on_stick(hits.object[i], hits.primitive[i], p, normal);
        return bake_.rays.openness(p, normal,
                                   screen_noise(surface.points.x[i], surface.points.y[i]));
    }

    const AmbientBake::Impl& bake_;
    Footprints footprints_;
};

}  // namespace

AmbientBake::AmbientBake(const Scene& scene, const Tracer& tracer, int quality,
                         const std::atomic<bool>* cancel)
    : impl_(std::make_unique<Impl>(scene, tracer, quality, cancel)) {}
AmbientBake::~AmbientBake() = default;

std::unique_ptr<AmbientOcclusion> AmbientBake::seen_by(const Camera& camera) const {
    return std::make_unique<SeenBake>(*impl_, camera);
}

std::shared_ptr<const AmbientBake> AmbientCache::get(const Scene& scene, const Tracer& tracer,
                                                     int quality, const std::atomic<bool>* cancel) {
    const std::scoped_lock lock(mutex_);
    if (!bake_ || quality_ != quality) {
        bake_ = std::make_shared<AmbientBake>(scene, tracer, quality, cancel);
        quality_ = quality;
    }
    return bake_;
}

}  // namespace ink
