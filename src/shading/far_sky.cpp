#include "shading/far_sky.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "shading/far_sky_kernels.h"

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

/// Directions in which all balls are drawn, to find those that can be seen from outside. What eight
/// miss of a ribosome hides less than the directions in between do.
constexpr std::size_t kScouts = 8;

/// The size of a texel, of the radius of most balls, and how many there may be along a side. Maps
/// of small scenes cost next to nothing and may be finer.
struct Fineness {
    float texel, most;
};
constexpr std::array<Fineness, 3> kFineness{{{0.8F, 252.0F}, {0.5F, 160.0F}, {0.25F, 32.0F}}};
/// Rows below a map that kernels may read.
constexpr std::size_t kSpare = 5;

/// Sixteen a packet; the last is filled up with balls of no radius. Neighbours in the scene are
/// apart in the packets: what was just written to texels is not to be read at once.
std::vector<BallPacket> pack(std::span<const Sphere> balls, std::span<const std::uint8_t> chosen) {
    constexpr std::size_t kStride = 1009;
    std::vector<BallPacket> packets;
    std::size_t count = 0;
    for (std::size_t first = 0; first < std::min(kStride, balls.size()); ++first) {
        for (std::size_t k = first; k < balls.size(); k += kStride) {
            if (!chosen.empty() && chosen[k] == 0) continue;
            const auto lane = static_cast<int>(count++ % kLanes);
            if (lane == 0) packets.push_back({});
            BallPacket& packet = packets.back();
            packet.x[lane] = balls[k].centre.x;
            packet.y[lane] = balls[k].centre.y;
            packet.z[lane] = balls[k].centre.z;
            packet.radius[lane] = balls[k].radius;
        }
    }
    return packets;
}

/// Marks the balls of which something is seen from a direction or from behind: at the middle or at
/// one of four points about it.
void mark_seen(const FarSky& sky, std::span<const Sphere> balls, Vec3f towards,
               std::span<const std::uint32_t> map, std::span<std::uint8_t> seen) {
    constexpr std::array<Vec2f, 5> kPoints{
        {{0, 0}, {0.6F, 0.5F}, {-0.5F, 0.6F}, {-0.6F, -0.5F}, {0.5F, -0.6F}}};
    Vec3f right;
    Vec3f up;
    make_basis(towards, right, up);
    const float middle = 0.5F * static_cast<float>(sky.side());
    for (std::size_t k = 0; k < balls.size(); ++k) {
        std::atomic_ref<std::uint8_t> mark(seen[k]);
        if (mark.load(std::memory_order_relaxed) != 0) continue;
        const Sphere& ball = balls[k];
        const float x = dot(ball.centre, right) * sky.texels + middle;
        const float y = dot(ball.centre, up) * sky.texels + middle;
        const float radius = ball.radius * sky.texels;
        const float height = dot(ball.centre, towards);
        // The front of a ball that is not covered is what was drawn, a little farther back.
        const float front = sky.step_of(height - 0.5F * ball.radius);
        const float back = sky.step_of(-height - 0.5F * ball.radius);
        for (const Vec2f p : kPoints) {
            const int column = std::clamp(static_cast<int>(x + p.x * radius), 0, sky.side() - 1);
            const int row = std::clamp(static_cast<int>(y + p.y * radius), 0, sky.side() - 1);
            const std::uint32_t at = map[static_cast<std::size_t>(row * sky.side() + column)];
            if (static_cast<float>(at & 0xFFFFU) <= front ||
                static_cast<float>(at >> 16U) <= back) {
                mark.store(1, std::memory_order_relaxed);
                break;
            }
        }
    }
}

/// A map as the tiles of the two directions that see it.
void cut(const FarSky& sky, std::span<const std::uint32_t> map, FarSky::Tile* front,
         FarSky::Tile* back) {
    constexpr std::size_t kSide = FarSky::kTileSide;
    for (std::size_t row = 0; row < sky.side_tiles * kSide; ++row) {
        const std::uint32_t* from = map.data() + row * sky.side_tiles * kSide;
        const std::size_t first = row / kSide * (sky.side_tiles + 1);
        for (std::size_t tile = 0; tile < sky.side_tiles; ++tile) {
            std::uint8_t* to_front = front[first + tile].heights.data() + row % kSide * kSide;
            std::uint8_t* to_back = back[first + tile].heights.data() + row % kSide * kSide;
            for (std::size_t k = 0; k < kSide; ++k) {
                to_front[k] = static_cast<std::uint8_t>(from[tile * kSide + k]);
                to_back[k] = static_cast<std::uint8_t>(from[tile * kSide + k] >> 16U);
            }
        }
    }
}

float mean_radius(std::span<const Sphere> balls) {
    double sum = 0.0;
    for (const Sphere& ball : balls) sum += static_cast<double>(ball.radius);
    return static_cast<float>(sum / static_cast<double>(std::max(balls.size(), std::size_t{1})));
}

/// The radius of a ball about the origin that holds all the others.
float reach_of(std::span<const Sphere> balls) {
    float reach = 0.0F;
    for (const Sphere& ball : balls) reach = std::max(reach, length(ball.centre) + ball.radius);
    return reach;
}

}  // namespace

FarSky::FarSky(std::span<const Sphere> balls, const SkyDirections& directions,
               const std::atomic<bool>* cancel)
    : frames(directions.groups.size()) {
    const float radius = reach_of(balls);
    lowest = -radius;
    steps = 253.0F / (2.0F * radius);
    const float balls_across = 2.0F * radius / std::max(mean_radius(balls), 1e-6F * radius);
    float needed = 0.0F;
    for (const Fineness& fine : kFineness) {
        needed = std::max(needed, std::min(balls_across / fine.texel, fine.most));
    }
    side_tiles = static_cast<std::size_t>(std::ceil((needed + 4.0F) / kTileSide));
    texels = 0.5F * static_cast<float>(side() - 4) / radius;
    tiles = std::make_unique_for_overwrite<Tile[]>(directions.groups.size() * kLanes * map_tiles());
    const std::vector<Pair> pairs = pair_up(directions);
    for (std::size_t g = 0; g < frames.size(); ++g) {
        frames[g].x = directions.groups[g].x;
        frames[g].y = directions.groups[g].y;
        frames[g].z = directions.groups[g].z;
    }
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
    const auto texel_count = static_cast<std::size_t>(side()) * static_cast<std::size_t>(side());
    const auto make_maps = [&](std::span<const BallPacket> some, std::size_t n, bool scout) {
        const Pair& pair = pairs[n];
        thread_local std::vector<std::uint32_t> map;
        map.assign(texel_count + kSpare * static_cast<std::size_t>(side()), 0);
        far_kernels::raise(*this, some, pair.towards, map);
        if (scout) mark_seen(*this, balls, pair.towards, map, seen);
        cut(*this, map, tiles.get() + pair.front * map_tiles(),
            tiles.get() + pair.back * map_tiles());
    };
    const auto for_pairs = [&](bool scouts, const auto& body) {
        parallel_ranges(pairs.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t n = begin; n < end; ++n) {
                if (cancel != nullptr && cancel->load(std::memory_order_relaxed)) throw Cancelled();
                if ((n % step == 0) == scouts) body(n);
            }
        });
    };
    const std::vector<BallPacket> all = pack(balls, {});
    for_pairs(true, [&](std::size_t n) { make_maps(all, n, true); });
    const std::vector<BallPacket> outer = pack(balls, seen);
    for_pairs(false, [&](std::size_t n) { make_maps(outer, n, false); });
}

}  // namespace ink
