#include "shading/far_sky.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "base/parallel.h"
#include "shading/ball_sky_kernels.h"

namespace ink {

namespace {

/// A direction and the one opposite to it see the same map, from its two sides.
struct Pair {
    Vec3f towards;
    std::size_t front, back;  ///< numbers of the directions
};

std::vector<Pair> pair_up(const SkyDirections& directions) {
    std::vector<Vec3f> all;
    for (const SkyDirections::Group& group : directions.groups) {
        for (int i = 0; i < kLanes; ++i) all.push_back({group.x[i], group.y[i], group.z[i]});
    }
    std::vector<Pair> pairs;
    for (std::size_t k = 0; k < all.size(); ++k) {
        const auto other = std::ranges::find(all, -all[k]);
        const auto n = static_cast<std::size_t>(other - all.begin());
        if (n > k) pairs.push_back({all[k], k, n});
    }
    return pairs;
}

/// Directions in which all balls are drawn, to find those that can be seen from outside.
constexpr std::size_t kScouts = 16;

/// Marks the balls of which something is seen from a direction or from behind: at the middle or at
/// one of four points about it.
void mark_seen(const FarSky& sky, std::span<const Sphere> balls, Vec3f towards,
               std::span<const float> front, std::span<const float> back,
               std::span<std::uint8_t> seen) {
    constexpr int kSide = FarSky::kSide;
    constexpr std::array<Vec2f, 5> kPoints{
        {{0, 0}, {0.6F, 0.5F}, {-0.5F, 0.6F}, {-0.6F, -0.5F}, {0.5F, -0.6F}}};
    Vec3f right;
    Vec3f up;
    make_basis(towards, right, up);
    for (std::size_t k = 0; k < balls.size(); ++k) {
        std::atomic_ref<std::uint8_t> mark(seen[k]);
        if (mark.load(std::memory_order_relaxed) != 0) continue;
        const Sphere& ball = balls[k];
        const float x = dot(ball.centre, right) * sky.texels + 0.5F * kSide;
        const float y = dot(ball.centre, up) * sky.texels + 0.5F * kSide;
        const float radius = ball.radius * sky.texels;
        const float height = dot(ball.centre, towards);
        const float least = (-ball.radius - sky.lowest) * sky.heights;
        for (const Vec2f p : kPoints) {
            const int column = std::clamp(static_cast<int>(x + p.x * radius), 0, kSide - 1);
            const int row = std::clamp(static_cast<int>(y + p.y * radius), 0, kSide - 1);
            const auto at = static_cast<std::size_t>(row * kSide + column);
            // The front of a ball that is not covered is what was drawn, a little farther back.
            if (front[at] <= least + (height + ball.radius * 0.5F) * sky.heights ||
                back[at] <= least + (ball.radius * 0.5F - height) * sky.heights) {
                mark.store(1, std::memory_order_relaxed);
                break;
            }
        }
    }
}

}  // namespace

FarSky::FarSky(std::span<const Sphere> balls, float radius, const SkyDirections& directions)
    : texels(0.5F * (kSide - 4) / radius),
      heights(65534.0F / (2.0F * radius)),
      lowest(-radius),
      frames(directions.groups.size()) {
    constexpr std::size_t kTexels = std::size_t{kSide} * kSide;
    maps.resize(directions.groups.size() * kLanes * kTexels + 2);
    const std::vector<Pair> pairs = pair_up(directions);
    for (const Pair& pair : pairs) {
        Vec3f right;
        Vec3f up;
        make_basis(pair.towards, right, up);
        for (const std::size_t k : {pair.front, pair.back}) {
            Frame& frame = frames[k / kLanes];
            const auto lane = static_cast<int>(k % kLanes);
            frame.right_x[lane] = right.x;
            frame.right_y[lane] = right.y;
            frame.right_z[lane] = right.z;
            frame.up_x[lane] = up.x;
            frame.up_y[lane] = up.y;
            frame.up_z[lane] = up.z;
        }
    }
    // What is seen from none of the first directions lies deep inside and is left out of the
    // others.
    const std::size_t step = std::max(pairs.size() / kScouts, std::size_t{1});
    std::vector<std::uint8_t> seen(balls.size());
    const auto make_maps = [&](std::span<const Sphere> some, std::size_t n, bool scout) {
        const Pair& pair = pairs[n];
        std::vector<float> front(kTexels + kLanes);
        std::vector<float> back(kTexels + kLanes);
        ball_kernels::raise(*this, some, pair.towards, front, back);
        if (scout) mark_seen(*this, some, pair.towards, front, back, seen);
        for (std::size_t k = 0; k < kTexels; ++k) {
            maps[pair.front * kTexels + k] = static_cast<std::uint16_t>(front[k]);
            maps[pair.back * kTexels + k] = static_cast<std::uint16_t>(back[k]);
        }
    };
    const auto for_pairs = [&](bool scouts, const auto& body) {
        parallel_ranges(pairs.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t n = begin; n < end; ++n) {
                if ((n % step == 0) == scouts) body(n);
            }
        });
    };
    for_pairs(true, [&](std::size_t n) { make_maps(balls, n, true); });
    std::vector<Sphere> outer;
    for (std::size_t k = 0; k < balls.size(); ++k) {
        if (seen[k] != 0) outer.push_back(balls[k]);
    }
    for_pairs(false, [&](std::size_t n) { make_maps(outer, n, false); });
}

}  // namespace ink
