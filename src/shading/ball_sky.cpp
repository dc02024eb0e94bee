#include "shading/ball_sky.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

#include "accel/clusters.h"
#include "shading/ball_sky_kernels.h"

namespace ink {

namespace {

/// Balls whose surface comes nearer than this many radii to that of the ball that asks are near. Of
/// a large ball among small ones, radii of the small ones count: it would have all of them near it.
constexpr float kNear = 1.4F;
/// Those whose surface comes this near touch it or nearly do.
constexpr float kTouch = 0.3F;
constexpr float kNoBall = -kInfinity;

std::size_t packets_for(std::size_t count) { return (count + kLanes - 1) / kLanes; }

void put(Vec3f centre, float radius, int lane, BallPacket& packet) {
    packet.x[lane] = centre.x;
    packet.y[lane] = centre.y;
    packet.z[lane] = centre.z;
    packet.radius[lane] = radius;
}

Sphere ball_at(const BallPacket& packet, int lane) {
    return {{packet.x[lane], packet.y[lane], packet.z[lane]}, packet.radius[lane]};
}

/// A ball about others.
template <class Get>
Sphere enclose(std::size_t count, const Get& get) {
    Bounds3f box;
    for (std::size_t i = 0; i < count; ++i) box.add(get(i).centre, get(i).radius);
    Sphere all{box.centre(), 0.0F};
    for (std::size_t i = 0; i < count; ++i) {
        all.radius = std::max(all.radius, length(get(i).centre - all.centre) + get(i).radius);
    }
    all.radius *= 1.0F + 1e-5F;
    return all;
}

std::vector<Sphere> all_balls(const Scene& scene) {
    std::vector<Sphere> balls;
    for (const Object& object : scene.objects()) {
        const auto* shape = std::get_if<Spheres>(&object.shape);
        if (shape == nullptr) continue;
        for (std::size_t k = 0; k < shape->count(); ++k) balls.push_back(shape->at(k));
    }
    return balls;
}

/// Orders balls so that each sixteen of them lie close together: halves them along the axis on
/// which they reach farthest, again and again.
void gather_neighbours(std::span<Sphere> balls) {
    if (balls.size() <= kLanes) return;
    Bounds3f box;
    for (const Sphere& ball : balls) box.add(ball.centre, 0.0F);
    const Vec3f size = box.upper - box.lower;
    float Vec3f::*widest = size.x >= std::max(size.y, size.z) ? &Vec3f::x
                           : size.y >= size.z                 ? &Vec3f::y
                                                              : &Vec3f::z;
    const std::size_t half = (packets_for(balls.size()) / 2) * kLanes;
    std::ranges::nth_element(balls, balls.begin() + static_cast<std::ptrdiff_t>(half), {},
                             [widest](const Sphere& ball) { return ball.centre.*widest; });
    gather_neighbours(balls.first(half));
    gather_neighbours(balls.subspan(half));
}

}  // namespace

BallSky::BallSky(const Scene& scene, const SkyDirections& directions,
                 const std::atomic<bool>* cancel)
    : directions_(directions), far_(all_balls(scene), directions, cancel) {
    const Clusters clusters(scene);
    std::vector<Sphere> enclosing;
    for (const Cluster& cluster : clusters.clusters) {
        if (cluster.kind != ClusterKind::spheres) continue;
        const SphereLanes& there = clusters.spheres[cluster.packet];
        const SphereLanes lanes =
            cluster.copy == kNoCopy ? there : moved(there, clusters.copies[cluster.copy].motion);
        BallPacket packet{lanes.centre.x, lanes.centre.y, lanes.centre.z, lanes.radius};
        for (int i = cluster.count; i < kLanes; ++i) packet.radius[i] = kNoBall;
        add_packet(packet, cluster.count, enclosing);
    }
    build_levels(std::move(enclosing));
}

BallSky::BallSky(std::vector<Sphere> balls, const SkyDirections& directions,
                 const std::atomic<bool>* cancel)
    : directions_(directions), far_(balls, directions, cancel) {
    gather_neighbours(balls);
    std::vector<Sphere> enclosing;
    for (std::size_t first = 0; first < balls.size(); first += kLanes) {
        BallPacket packet{};
        packet.radius.fill(kNoBall);
        const std::size_t count = std::min<std::size_t>(kLanes, balls.size() - first);
        for (std::size_t i = 0; i < count; ++i) {
            put(balls[first + i].centre, balls[first + i].radius, static_cast<int>(i), packet);
        }
        add_packet(packet, count, enclosing);
    }
    build_levels(std::move(enclosing));
}

void BallSky::add_packet(const BallPacket& packet, std::size_t count,
                         std::vector<Sphere>& enclosing) {
    enclosing.push_back(
        enclose(count, [&](std::size_t i) { return ball_at(packet, static_cast<int>(i)); }));
    balls_.push_back(packet);
}

void BallSky::build_levels(std::vector<Sphere> balls) {
    double sum = 0.0;
    double count = 0.0;
    for (const BallPacket& packet : balls_) {
        for (const float radius : packet.radius) {
            if (radius == kNoBall) continue;
            sum += static_cast<double>(radius);
            count += 1.0;
        }
    }
    if (count > 0.0) usual_radius_ = static_cast<float>(sum / count);
    while (!balls.empty()) {
        std::vector<BallPacket> level(packets_for(balls.size()));
        std::vector<Sphere> above;
        for (std::size_t k = 0; k < level.size(); ++k) {
            const auto own = std::span(balls).subspan(
                k * kLanes, std::min<std::size_t>(kLanes, balls.size() - k * kLanes));
            for (int i = 0; i < kLanes; ++i) {
                const std::size_t n = std::min(static_cast<std::size_t>(i), own.size() - 1);
                const bool used = n == static_cast<std::size_t>(i);
                put(own[n].centre, used ? own[n].radius : kNoBall, i, level[k]);
            }
            above.push_back(enclose(own.size(), [&](std::size_t i) { return own[i]; }));
        }
        levels_.push_back(std::move(level));
        if (levels_.back().size() == 1) break;
        balls = std::move(above);
    }
}

void BallSky::survey(const Sphere& ball, Surroundings& surroundings) const {
    surroundings.near_count = 0;
    gather(ball, levels_.size() - 1, 0, surroundings);
    surroundings.near.resize(std::max(packets_for(surroundings.near_count), std::size_t{1}));
    for (std::size_t k = surroundings.near_count; k % kLanes != 0; ++k) {
        put({}, 0.0F, static_cast<int>(k % kLanes), surroundings.near.back());
    }
    surroundings.windows.resize(directions_.groups.size());
    surroundings.seen = surroundings.clear = surroundings.shut = {};
    surroundings.window_scale = far_.texels / far_.window_stretch(ball.radius);
}

/// Adds balls that come near to one.
void BallSky::gather(const Sphere& ball, std::size_t level, std::size_t packet,
                     Surroundings& surroundings) const {
    const float reach = reach_of(ball);
    for (auto lanes = ball_kernels::within(levels_[level][packet], ball.centre, reach); lanes != 0;
         lanes &= lanes - 1) {
        const std::size_t child =
            packet * kLanes + static_cast<std::size_t>(std::countr_zero(lanes));
        if (level > 0) {
            gather(ball, level - 1, child, surroundings);
            continue;
        }
        const BallPacket& balls = balls_[child];
        auto near = ball_kernels::within(balls, ball.centre, reach);
        for (; near != 0; near &= near - 1) {
            const Sphere other = ball_at(balls, std::countr_zero(near));
            const Vec3f to = other.centre - ball.centre;
            // What lies within the ball, itself included, hides nothing.
            if (length(to) + other.radius <= ball.radius) continue;
            const std::size_t k = surroundings.near_count++;
            if (k / kLanes == surroundings.near.size()) surroundings.near.emplace_back();
            put(to, other.radius, static_cast<int>(k % kLanes), surroundings.near[k / kLanes]);
        }
    }
}

BallPacket BallSky::contacts(const Sphere& ball, const Surroundings& surroundings) {
    std::vector<std::pair<float, std::size_t>> gaps;
    for (std::size_t k = 0; k < surroundings.near_count; ++k) {
        const Sphere other = ball_at(surroundings.near[k / kLanes], static_cast<int>(k % kLanes));
        const float gap = length(other.centre) - other.radius - ball.radius;
        if (gap < kTouch * ball.radius) gaps.emplace_back(gap, k);
    }
    std::ranges::sort(gaps);
    BallPacket found{};
    for (std::size_t i = 0; i < std::min(gaps.size(), std::size_t{kLanes}); ++i) {
        const std::size_t k = gaps[i].second;
        const Sphere other = ball_at(surroundings.near[k / kLanes], static_cast<int>(k % kLanes));
        put(other.centre, other.radius, static_cast<int>(i), found);
    }
    return found;
}

float BallSky::reach_of(const Sphere& ball) const {
    return ball.radius + kNear * std::min(ball.radius, 2.0F * usual_radius_);
}

float BallSky::openness(const Sphere& ball, Surroundings& surroundings, Vec3f point,
                        Vec3f n) const {
    return ball_kernels::openness({directions_, far_, ball, reach_of(ball)}, surroundings, point,
                                  n);
}

float BallSky::contact_openness(const BallPacket& contacts, float radius, Vec3f n) {
    return ball_kernels::contact_openness(contacts, radius, n);
}

void BallSky::contact_openness(const BallPacket& contacts, float radius,
                               const NormalPacket& normals, Lanes<float>& open) {
    ball_kernels::contact_openness(contacts, radius, normals, open);
}

}  // namespace ink
