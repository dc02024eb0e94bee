#include "shading/far_sky_kernels.h"

#include <algorithm>
#include <cmath>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shading/far_sky_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::far_kernels::HWY_NAMESPACE {

using namespace ink::HWY_NAMESPACE;  // the lanes

/// A ball on a map, in texels, and the steps of height at which it begins on the way to the map's
/// two sides.
struct Spot {
    float x, y, radius;
    int left, right, top, bottom;
    std::uint32_t begins;
};

/// Raises texels from column i on, as many as the tag has lanes, in rows from the first on; those
/// outside the ball stay as they are.
template <class Tag>
HWY_INLINE void raise_rows(Tag tag, const Spot& spot, int i, int rows, std::size_t stride,
                           std::uint32_t* map) {
    constexpr hn::Rebind<std::uint32_t, Tag> kBits;
    constexpr hn::Repartition<std::uint16_t, Tag> kHeights;
    const auto begins = hn::Set(kBits, spot.begins);
    const auto dx = hn::Add(hn::Iota(tag, 0), hn::Set(tag, static_cast<float>(i) + 0.5F - spot.x));
    const auto across = hn::Mul(dx, dx);
    float dy = static_cast<float>(spot.top) + 0.5F - spot.y;
    std::uint32_t* at = map + static_cast<std::size_t>(spot.top) * stride + i;
    for (int row = 0; row < rows; ++row, dy += 1.0F, at += stride) {
        const auto most = hn::Set(tag, spot.radius * spot.radius - dy * dy);
        const auto covered = hn::RebindMask(kBits, hn::Lt(across, most));
        const auto raised = hn::Max(hn::BitCast(kHeights, hn::LoadU(kBits, at)),
                                    hn::BitCast(kHeights, hn::IfThenElseZero(covered, begins)));
        hn::StoreU(hn::BitCast(kBits, raised), kBits, at);
    }
}

HWY_INLINE void raise_spot(const Spot& spot, std::size_t stride, std::uint32_t* map) {
    constexpr int kSmall = 4;
    constexpr int kWide = 8;
    if (std::max(spot.right - spot.left, spot.bottom - spot.top) < kSmall) {
        // Always as many rows: a number that varies costs more than those in vain.
        return raise_rows(hn::CappedTag<float, kSmall>(), spot, spot.left, kSmall, stride, map);
    }
    for (int i = spot.left; i <= spot.right;
         i += static_cast<int>(hn::Lanes(hn::CappedTag<float, kWide>()))) {
        raise_rows(hn::CappedTag<float, kWide>(), spot, i, spot.bottom - spot.top + 1, stride, map);
    }
}

/// Sixteen balls on a map.
struct SpotLanes {
    Lanes<float> x, y, radius;
    Lanes<std::int32_t> left, right, top, bottom, front, back;
};

HWY_INLINE void place(const FarSky& sky, const BallPacket& balls, Vec3f towards, SpotLanes& spots) {
    Vec3f right;
    Vec3f up;
    make_basis(towards, right, up);
    const float middle = 0.5F * static_cast<float>(sky.side());
    const auto most = hn::Set(kIntegers, sky.side() - 1);
    for (int i = 0; i < kLanes; i += kStep) {
        const Vectors ball{load(balls.x, i), load(balls.y, i), load(balls.z, i)};
        const auto size = load(balls.radius, i);
        const auto along = [&](Vec3f d) { return dot(ball, set(d)); };
        const auto x = hn::Add(hn::Mul(along(right), set(sky.texels)), set(middle));
        const auto y = hn::Add(hn::Mul(along(up), set(sky.texels)), set(middle));
        const auto radius = hn::Mul(size, set(sky.texels));
        store(x, spots.x, i);
        store(y, spots.y, i);
        store(radius, spots.radius, i);
        const auto reach = hn::Sub(radius, set(0.5F));
        const auto keep = [&](auto at, Lanes<std::int32_t>& lanes) {
            const auto texel = hn::ConvertTo(kIntegers, at);
            store(hn::Min(hn::Max(texel, hn::Zero(kIntegers)), most), lanes, i);
        };
        keep(hn::Sub(x, reach), spots.left);
        keep(hn::Add(x, reach), spots.right);
        keep(hn::Sub(y, reach), spots.top);
        keep(hn::Add(y, reach), spots.bottom);
        // A ball begins, in the mean over its disc, this much nearer than its centre.
        const auto begin = hn::Sub(hn::Mul(size, set(-2.0F / 3.0F)), set(sky.lowest));
        const auto height = along(towards);
        const auto step = [&](auto h, Lanes<std::int32_t>& lanes) {
            const auto number = hn::Add(hn::Mul(h, set(sky.steps)), set(1.0F));
            const auto kept = hn::Min(hn::Max(number, set(1.0F)), set(255.0F));
            store(hn::ConvertTo(kIntegers, kept), lanes, i);
        };
        step(hn::Add(begin, height), spots.front);
        step(hn::Sub(begin, height), spots.back);
    }
}

void raise_map(const FarSky& sky, std::span<const BallPacket> balls, Vec3f towards,
               std::uint32_t* map) {
    SpotLanes spots;
    const auto stride = static_cast<std::size_t>(sky.side());
    for (const BallPacket& packet : balls) {
        place(sky, packet, towards, spots);
        for (int i = 0; i < kLanes; ++i) {
            const Spot spot{
                spots.x[i],      spots.y[i],
                spots.radius[i], spots.left[i],
                spots.right[i],  spots.top[i],
                spots.bottom[i], static_cast<std::uint32_t>(spots.front[i] | spots.back[i] << 16)};
            raise_spot(spot, stride, map);
        }
    }
}

/// Bit k is set for texel k of a tile where nothing begins above a step.
HWY_INLINE std::uint64_t free_texels(const FarSky::Tile& tile, std::uint8_t most) {
    constexpr hn::CappedTag<std::uint8_t, 64> kBytes;
    constexpr std::size_t kBytesAtOnce = hn::MaxLanes(hn::CappedTag<std::uint8_t, 64>());
    std::uint64_t free = 0;
    for (std::size_t i = 0; i < 64; i += kBytesAtOnce) {
        alignas(8) std::uint8_t bits[8] = {};
        const auto heights = hn::Load(kBytes, tile.heights.data() + i);
        const auto below = hn::Eq(hn::Min(heights, hn::Set(kBytes, most)), heights);
        hn::StoreMaskBits(kBytes, below, bits);
        std::uint64_t word;
        hwy::CopyBytes<8>(bits, &word);
        free |= word << i;
    }
    return free;
}

/// Eight by eight texels of a map, from any one on, which `tile` holds.
HWY_INLINE std::uint64_t free_window(const FarSky& sky, const FarSky::Tile* tile, int column,
                                     int row, std::uint8_t most) {
    const auto right = static_cast<unsigned>(column % 8);
    const auto down = static_cast<unsigned>(row % 8);
    const std::uint64_t own = (0xFFU >> right) * 0x0101010101010101U;
    const auto row_of = [&](const FarSky::Tile* first) {
        return (free_texels(first[0], most) >> right & own) |
               (free_texels(first[1], most) << (8U - right) & ~own);
    };
    const std::uint64_t top = row_of(tile) >> 8U * down;
    return down == 0 ? top : top | row_of(tile + sky.side_tiles + 1) << (64U - 8U * down);
}

/// The same of a part of the map that is larger, `stretch` texels apart.
std::uint64_t stretched_window(const FarSky& sky, const FarSky::Tile* map, float x, float y,
                               float stretch, std::uint8_t most) {
    std::uint64_t free = 0;
    const auto texel = [&](float middle, int k) {
        const float at = middle + (static_cast<float>(k) - 3.5F) * stretch + 0.5F;
        return static_cast<std::size_t>(std::clamp(static_cast<int>(at), 0, sky.side() - 1));
    };
    for (int row = 0; row < 8; ++row) {
        for (int column = 0; column < 8; ++column) {
            const std::size_t i = texel(x, column);
            const std::size_t j = texel(y, row);
            const FarSky::Tile& tile = map[j / 8 * (sky.side_tiles + 1) + i / 8];
            const bool is_free = tile.heights[j % 8 * 8 + i % 8] <= most;
            free |= std::uint64_t{is_free} << static_cast<unsigned>(8 * row + column);
        }
    }
    return free;
}

void look_through(const FarSky& sky, std::size_t group, const Sphere& ball, float reach,
                  FarWindow& window) {
    // Points that look through it may lie a little outside of the ball.
    const float radius = 1.1F * ball.radius * sky.texels;
    const float stretch = sky.window_stretch(ball.radius);
    const Vec3f c = ball.centre;
    const FarSky::Frame& frame = sky.frames[group];
    const float middle = 0.5F * static_cast<float>(sky.side()) - 0.5F;
    Lanes<float> x;
    Lanes<float> y;
    Lanes<float> most;
    Lanes<std::int32_t> columns;
    Lanes<std::int32_t> rows;
    const int last = sky.side() - kWindowSide;
    for (int i = 0; i < kLanes; ++i) {
        x[i] = middle + sky.texels * (c.x * frame.right_x[i] + c.y * frame.right_y[i] +
                                      c.z * frame.right_z[i]);
        y[i] =
            middle + sky.texels * (c.x * frame.up_x[i] + c.y * frame.up_y[i] + c.z * frame.up_z[i]);
        const float height = c.x * frame.x[i] + c.y * frame.y[i] + c.z * frame.z[i] + reach;
        most[i] = std::clamp(sky.step_of(height) - 0.5F, 0.0F, 255.0F);
        columns[i] = std::clamp(static_cast<int>(x[i] - radius), 0, last);
        rows[i] = std::clamp(static_cast<int>(y[i] - radius), 0, last);
    }
    // Maps are mostly far away in memory: all are asked for before the first is read.
    for (int i = 0; i < kLanes && stretch == 1.0F; ++i) {
        const FarSky::Tile* tile =
            sky.tile(group * kLanes + static_cast<std::size_t>(i), columns[i], rows[i]);
        for (const FarSky::Tile* each : {tile, tile + sky.side_tiles + 1}) {
            __builtin_prefetch(each);
            __builtin_prefetch(each + 1);
        }
    }
    for (int i = 0; i < kLanes; ++i) {
        const std::size_t direction = group * kLanes + static_cast<std::size_t>(i);
        const auto step = static_cast<std::uint8_t>(most[i]);
        if (stretch == 1.0F) {
            window.free[i] = free_window(sky, sky.tile(direction, columns[i], rows[i]), columns[i],
                                         rows[i], step);
            window.x[i] = x[i] - static_cast<float>(columns[i]);
            window.y[i] = y[i] - static_cast<float>(rows[i]);
        } else {
            window.free[i] =
                stretched_window(sky, sky.tile(direction, 0, 0), x[i], y[i], stretch, step);
            window.x[i] = window.y[i] = 3.5F;
        }
    }
}

}  // namespace ink::far_kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink::far_kernels {

HWY_EXPORT(raise_map);
HWY_EXPORT(look_through);

void raise(const FarSky& sky, std::span<const BallPacket> balls, Vec3f towards,
           std::span<std::uint32_t> map) {
    HWY_DYNAMIC_DISPATCH(raise_map)(sky, balls, towards, map.data());
}

void look_out(const FarSky& sky, std::size_t group, const Sphere& ball, float reach,
              FarWindow& window) {
    HWY_DYNAMIC_DISPATCH(look_through)(sky, group, ball, reach, window);
}

}  // namespace ink::far_kernels

#endif
