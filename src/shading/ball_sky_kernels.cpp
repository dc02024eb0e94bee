#include "shading/ball_sky_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "shading/far_sky_kernels.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shading/ball_sky_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"
#include "base/pack_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::ball_kernels::HWY_NAMESPACE {

using namespace ink::HWY_NAMESPACE;  // the lanes

HWY_INLINE Number sum_of_products(Number ax, Number bx, Number ay, Number by, Number az,
                                  Number bz) {
    return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}

LaneBits find_within(const BallPacket& balls, Vec3f point, float reach) {
    LaneBits found = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto x = hn::Sub(load(balls.x, i), set(point.x));
        const auto y = hn::Sub(load(balls.y, i), set(point.y));
        const auto z = hn::Sub(load(balls.z, i), set(point.z));
        const auto far = hn::Add(load(balls.radius, i), set(reach));
        const auto squared = sum_of_products(x, x, y, y, z, z);
        const auto near =
            hn::And(hn::Lt(squared, hn::Mul(far, far)), hn::Gt(far, hn::Zero(kFloats)));
        found |= bits_of(near) << i;
    }
    return found;
}

/// Near balls that rise above the horizon of a point, as the discs that they are on its sky, with
/// soft edges: the share of a direction's cell that one covers is slope * (along - edge) + 1/2,
/// clamped.
struct Discs {
    std::vector<Lanes<float>> x, y, z;  ///< towards the centre, not of unit length
    std::vector<Lanes<float>> radius;
    std::vector<Lanes<float>> tangent;  ///< length of the tangent; 0 if the point is inside
    std::vector<Lanes<float>> edge, slope;
    std::size_t count = 0;

    std::size_t packets() const { return (count + kLanes - 1) / kLanes; }
    void make_room(std::size_t balls) {
        const std::size_t most = balls / kLanes + 2;
        if (x.size() >= most) return;
        for (auto* field : {&x, &y, &z, &radius, &tangent, &edge, &slope}) field->resize(most);
    }
};

/// Finds those that rise above the plane through a point, close together. What only touches it does
/// not.
HWY_INLINE void rise(const Surroundings& surroundings, Vec3f point, Vec3f n, Discs& discs) {
    discs.make_room(surroundings.near_count);
    const float height = dot(point, n) * (1.0F + 1e-4F);
    float* to_x = discs.x[0].data();
    float* to_y = discs.y[0].data();
    float* to_z = discs.z[0].data();
    float* to_radius = discs.radius[0].data();
    std::size_t count = 0;
    for (std::size_t k = 0; k * kLanes < surroundings.near_count; ++k) {
        const BallPacket& balls = surroundings.near[k];
        for (int i = 0; i < kLanes; i += kStep) {
            const auto x = load(balls.x, i);
            const auto y = load(balls.y, i);
            const auto z = load(balls.z, i);
            const auto size = load(balls.radius, i);
            const auto up = sum_of_products(set(n.x), x, set(n.y), y, set(n.z), z);
            const auto above =
                hn::And(hn::Gt(hn::Add(up, size), set(height)), hn::Gt(size, hn::Zero(kFloats)));
            const LanePacker packer(above);
            const auto put = [&](Number values, float* to) {
                hn::StoreU(packer.pack(kFloats, values), kFloats, to + count);
            };
            put(hn::Sub(x, set(point.x)), to_x);
            put(hn::Sub(y, set(point.y)), to_y);
            put(hn::Sub(z, set(point.z)), to_z);
            put(size, to_radius);
            count += packer.count();
        }
    }
    // Far below any horizon.
    for (std::size_t k = count; k % kLanes != 0; ++k) {
        to_x[k] = to_y[k] = to_z[k] = to_radius[k] = 0.0F;
    }
    discs.count = count;
}

HWY_INLINE void see(float spacing, Discs& discs) {
    for (std::size_t k = 0; k < discs.packets(); ++k) {
        for (int i = 0; i < kLanes; i += kStep) {
            const auto x = load(discs.x[k], i);
            const auto y = load(discs.y[k], i);
            const auto z = load(discs.z[k], i);
            const auto radius = load(discs.radius[k], i);
            const auto squared = sum_of_products(x, x, y, y, z, z);
            const auto beyond = hn::Sub(squared, hn::Mul(radius, radius));
            const auto tangent = hn::Sqrt(hn::Max(beyond, hn::Zero(kFloats)));
            // The mean of the cosine over a spacing about the edge is less than that at the edge.
            const auto edge = hn::Mul(tangent, set(1.0F + spacing * spacing / 24.0F));
            const auto least = hn::Min(radius, hn::Sqrt(squared));
            const auto width = hn::Max(hn::Mul(least, set(spacing)), set(1e-20F));
            store(tangent, discs.tangent[k], i);
            store(edge, discs.edge[k], i);
            store(hn::Div(set(1.0F), width), discs.slope[k], i);
        }
    }
}

/// What is left of a point's sky: the groups that reach above the horizon, and the cosines of their
/// directions, as far as they are open.
struct SkyLeft {
    GroupBits above;
    std::vector<Lanes<float>> left;
};

template <class Body>
HWY_INLINE void for_groups(std::uint64_t groups, std::size_t word, const Body& body) {
    for (; groups != 0; groups &= groups - 1) {
        body(word * kGroupsAWord + static_cast<std::size_t>(std::countr_zero(groups)));
    }
}

/// Sixteen groups of a word each, by a test of their axes.
template <class Test>
HWY_INLINE std::uint64_t find_groups(const SkyDirections& directions, std::size_t word,
                                     const Test& test) {
    constexpr std::size_t kPackets = kGroupsAWord / kLanes;
    const std::size_t first = word * kPackets;
    const std::size_t count = std::min(kPackets, directions.axes.size() - first);
    std::uint64_t found = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const SkyDirections::Axes& axes = directions.axes[first + k];
        for (int i = 0; i < kLanes; i += kStep) {
            found |= std::uint64_t{bits_of(test(axes, i)) << i} << (k * kLanes);
        }
    }
    return found;
}

/// The whole sky above the horizon. `all` is the sum of its cosines, in lanes.
HWY_INLINE void open_all(const SkyDirections& directions, Vec3f n, SkyLeft& sky,
                         Lanes<float>& all) {
    if (sky.left.size() < directions.groups.size()) sky.left.resize(directions.groups.size());
    for (std::size_t word = 0; word < directions.words(); ++word) {
        const auto above = find_groups(directions, word, [&](const auto& axes, int i) {
            const auto up = sum_of_products(load(axes.x, i), set(n.x), load(axes.y, i), set(n.y),
                                            load(axes.z, i), set(n.z));
            return hn::Gt(up, hn::Mul(load(axes.sin, i), set(-0.5F)));
        });
        sky.above[word] = above & directions.used(word);
    }
    const SkyDirections::Group* groups = directions.groups.data();
    Lanes<float>* left = sky.left.data();
    for (int i = 0; i < kLanes; i += kStep) {
        auto sum = hn::Zero(kFloats);
        for (std::size_t word = 0; word < directions.words(); ++word) {
            for_groups(sky.above[word], word, [&](std::size_t g) {
                const SkyDirections::Group& group = groups[g];
                const auto up = sum_of_products(load(group.x, i), set(n.x), load(group.y, i),
                                                set(n.y), load(group.z, i), set(n.z));
                const auto cosine = hn::Max(up, hn::Zero(kFloats));
                store(cosine, left[g], i);
                sum = hn::Add(sum, cosine);
            });
        }
        store(sum, all, i);
    }
}

/// Groups that a disc reaches into: the angle between its middle and the axis is below the sum of
/// half its size and of the cone's. A ball that holds the point reaches everywhere.
HWY_INLINE std::uint64_t reached(const SkyDirections& directions, std::size_t word, Vec3f to,
                                 float tangent, float radius) {
    if (tangent <= 0.0F) return ~std::uint64_t{0};
    return find_groups(directions, word, [&](const auto& axes, int i) {
        const auto along = sum_of_products(load(axes.x, i), set(to.x), load(axes.y, i), set(to.y),
                                           load(axes.z, i), set(to.z));
        const auto least = hn::Sub(hn::Mul(load(axes.wide_cos, i), set(tangent)),
                                   hn::Mul(load(axes.wide_sin, i), set(radius)));
        return hn::Gt(along, least);
    });
}

/// Takes the discs out of it.
HWY_INLINE void hide(const SkyDirections& directions, const Discs& discs, SkyLeft& sky) {
    const SkyDirections::Group* all = directions.groups.data();
    Lanes<float>* left = sky.left.data();
    for (std::size_t k = 0; k < discs.count; ++k) {
        const std::size_t packet = k / kLanes;
        const auto lane = static_cast<int>(k % kLanes);
        const Vec3f to{discs.x[packet][lane], discs.y[packet][lane], discs.z[packet][lane]};
        const float tangent = discs.tangent[packet][lane];
        const float radius = discs.radius[packet][lane];
        const float slope = discs.slope[packet][lane];
        const auto x = set(to.x * slope);
        const auto y = set(to.y * slope);
        const auto z = set(to.z * slope);
        const auto edge = set(discs.edge[packet][lane] * slope + 0.5F);
        for (std::size_t word = 0; word < directions.words(); ++word) {
            const std::uint64_t groups =
                sky.above[word] & reached(directions, word, to, tangent, radius);
            for_groups(groups, word, [&](std::size_t g) {
                const SkyDirections::Group& group = all[g];
                for (int i = 0; i < kLanes; i += kStep) {
                    const auto along = sum_of_products(load(group.x, i), x, load(group.y, i), y,
                                                       load(group.z, i), z);
                    const auto bare = hn::Max(hn::Sub(edge, along), hn::Zero(kFloats));
                    store(hn::Mul(load(left[g], i), hn::Min(bare, set(1.0F))), left[g], i);
                }
            });
        }
    }
}

/// How much of directions i and the following of a group is free of what begins far away, blended
/// between the texels about the way of the ray; `offset` is the point's from the ball's centre, in
/// texels of the windows.
HWY_INLINE auto look_far(const FarSky::Frame& frame, const FarWindow& window, int i, Vec3f offset) {
    constexpr hn::Rebind<std::uint32_t, Floats> kBits;
    constexpr hn::Repartition<std::uint64_t, Floats> kMaps;
    // Added, it leaves the whole part of a small number, rounded down, in the last bits.
    constexpr float kWhole = 12582912.0F;
    const auto place = [&](const auto& middle, const auto& x, const auto& y, const auto& z) {
        const auto along = sum_of_products(load(x, i), set(offset.x), load(y, i), set(offset.y),
                                           load(z, i), set(offset.z));
        return hn::Add(along, load(middle, i));
    };
    const auto x = place(window.x, frame.right_x, frame.right_y, frame.right_z);
    const auto y = place(window.y, frame.up_x, frame.up_y, frame.up_z);
    const auto column = hn::Add(hn::Sub(x, set(0.5F)), set(kWhole));
    const auto row = hn::Add(hn::Sub(y, set(0.5F)), set(kWhole));
    const auto a = hn::Sub(x, hn::Sub(column, set(kWhole)));
    const auto b = hn::Sub(y, hn::Sub(row, set(kWhole)));
    const auto number =
        hn::And(hn::Add(hn::ShiftLeft<3>(hn::BitCast(kBits, row)), hn::BitCast(kBits, column)),
                hn::Set(kBits, kWindowSide * kWindowSide - 1));
    const std::uint64_t* maps = window.free.data() + i;
    const auto low = hn::Shr(hn::Load(kMaps, maps), hn::PromoteTo(kMaps, hn::LowerHalf(number)));
    const auto high =
        hn::Shr(hn::Load(kMaps, maps + hn::Lanes(kMaps)),
                hn::PromoteTo(kMaps, hn::UpperHalf(hn::Half<decltype(kBits)>(), number)));
    const auto found = hn::ConcatEven(kBits, hn::BitCast(kBits, high), hn::BitCast(kBits, low));
    const auto ab = hn::Mul(a, b);
    const auto share = [&](std::uint32_t bit, auto weight) {
        const auto is_free = hn::TestBit(found, hn::Set(kBits, bit));
        return hn::IfThenElseZero(hn::RebindMask(kFloats, is_free), weight);
    };
    const auto right = hn::Sub(a, ab);
    const auto below = hn::Sub(b, ab);
    const auto left = hn::Sub(hn::Sub(set(1.0F), a), below);
    const auto top = hn::Add(share(1U, left), share(2U, right));
    const auto bottom = hn::Add(share(1U << 8U, below), share(1U << 9U, ab));
    return hn::Add(top, bottom);
}

struct Scratch {
    Discs discs;
    SkyLeft sky;
};

/// Out of line: the address of what is a thread's own would be asked for in every loop.
HWY_NOINLINE Scratch& own_scratch() {
    thread_local Scratch scratch;
    return scratch;
}

/// Finds what is far in a group.
void look_out(const SkyView& view, std::size_t g, Surroundings& surroundings) {
    FarWindow& window = surroundings.windows[g];
    far_kernels::look_out(view.far, g, view.ball, view.reach, window);
    const auto all = [&](std::uint64_t value) {
        return std::ranges::all_of(window.free, [&](std::uint64_t free) { return free == value; });
    };
    const std::uint64_t bit = std::uint64_t{1} << (g % kGroupsAWord);
    surroundings.seen[g / kGroupsAWord] |= bit;
    if (all(~std::uint64_t{0})) surroundings.clear[g / kGroupsAWord] |= bit;
    if (all(0)) surroundings.shut[g / kGroupsAWord] |= bit;
}

/// Groups of a word of which something is left.
HWY_INLINE std::uint64_t find_left(const SkyLeft& sky, std::size_t word) {
    std::uint64_t found = 0;
    for_groups(sky.above[word], word, [&](std::size_t g) {
        auto most = hn::Zero(kFloats);
        for (int i = 0; i < kLanes; i += kStep) most = hn::Max(most, load(sky.left[g], i));
        const bool any = !hn::AllFalse(kFloats, hn::Gt(most, hn::Zero(kFloats)));
        found |= std::uint64_t{any} << (g % kGroupsAWord);
    });
    return found;
}

float find_openness(const SkyView& view, Surroundings& surroundings, Vec3f point, Vec3f n) {
    const SkyDirections& directions = view.directions;
    Scratch& scratch = own_scratch();
    SkyLeft& sky = scratch.sky;
    rise(surroundings, point, n, scratch.discs);
    see(directions.spacing, scratch.discs);
    Lanes<float> sum;
    open_all(directions, n, sky, sum);
    for (std::size_t word = 0; word < directions.words(); ++word) {
        sky.above[word] &= ~surroundings.shut[word];
    }
    hide(directions, scratch.discs, sky);
    // First which groups matter, then what is far in them: loops without branches that none can
    // guess.
    for (std::size_t word = 0; word < directions.words(); ++word) {
        sky.above[word] = find_left(sky, word);
        for_groups(sky.above[word] & ~surroundings.seen[word], word,
                   [&](std::size_t g) { look_out(view, g, surroundings); });
    }
    const Vec3f offset = point * surroundings.window_scale;
    Lanes<float> open_sum;
    for (int i = 0; i < kLanes; i += kStep) {
        auto open = hn::Zero(kFloats);
        for (std::size_t word = 0; word < directions.words(); ++word) {
            for_groups(sky.above[word] & surroundings.clear[word], word,
                       [&](std::size_t g) { open = hn::Add(open, load(sky.left[g], i)); });
            for_groups(sky.above[word] & ~surroundings.clear[word], word, [&](std::size_t g) {
                const auto free = look_far(view.far.frames[g], surroundings.windows[g], i, offset);
                open = hn::Add(open, hn::Mul(load(sky.left[g], i), free));
            });
        }
        store(open, open_sum, i);
    }
    // In one order on every machine.
    float open = 0.0F;
    float all = 0.0F;
    for (int i = 0; i < kLanes; ++i) {
        open += open_sum[i];
        all += sum[i];
    }
    return std::min(open / all, 1.0F);
}

/// Within 7e-5: Abramowitz and Stegun 4.4.45.
HWY_INLINE Number arc_cosine(Number x) {
    const auto positive = hn::Abs(x);
    auto sum = hn::Add(set(0.0742610F), hn::Mul(positive, set(-0.0187293F)));
    sum = hn::Add(set(-0.2121144F), hn::Mul(positive, sum));
    sum = hn::Add(set(1.5707288F), hn::Mul(positive, sum));
    const auto root = hn::Sqrt(hn::Max(hn::Sub(set(1.0F), positive), hn::Zero(kFloats)));
    const auto angle = hn::Mul(root, sum);
    return hn::IfThenElse(hn::Lt(x, hn::Zero(kFloats)), hn::Sub(set(3.14159265F), angle), angle);
}

/// The form factor of a ball that the horizon may cut, in closed form (Snyder, Area Light Sources
/// for Real-Time Graphics, 1996). Of a ball that holds the point: that of half of the sky.
/// The centre is relative to the point. One lane may be a ball, or a point, as callers like.
HWY_INLINE Number open_of_ball(Number x, Number y, Number z, Number size, Number nx, Number ny,
                               Number nz) {
    const auto one = set(1.0F);
    const auto squared = hn::Max(sum_of_products(x, x, y, y, z, z), set(1e-20F));
    const auto up = sum_of_products(x, nx, y, ny, z, nz);
    const auto limit = set(0.99999F);
    const auto cosine = hn::Max(hn::Min(hn::Div(up, hn::Sqrt(squared)), limit), hn::Neg(limit));
    const auto cosine2 = hn::Mul(cosine, cosine);
    const auto share =  // (radius / distance)^2
        hn::Min(hn::Div(hn::Mul(size, size), squared), one);
    const auto whole = hn::Mul(hn::Max(cosine, hn::Zero(kFloats)), share);
    // h = distance / radius; q^2 = (h^2 - 1) / (1 - cosine^2)
    const auto inverse = hn::Div(one, hn::Max(share, set(1e-12F)));
    const auto beyond = hn::Sub(inverse, one);
    const auto q = hn::Sqrt(hn::Div(beyond, hn::Sub(one, cosine2)));
    const auto k2 = hn::Sub(one, hn::Mul(inverse, cosine2));
    const auto cut = hn::Gt(k2, hn::Zero(kFloats));
    const auto first = arc_cosine(hn::Max(hn::Min(hn::Neg(hn::Mul(cosine, q)), one), hn::Neg(one)));
    const auto second = arc_cosine(hn::Min(hn::Mul(q, hn::Sqrt(share)), one));
    const auto root = hn::Sqrt(hn::Mul(hn::Max(k2, hn::Zero(kFloats)), beyond));
    const auto lens = hn::Mul(hn::Sub(hn::Mul(cosine, first), root), share);
    const auto part = hn::Mul(hn::Add(lens, second), set(0.318309886F));
    const auto hidden = hn::IfThenElse(cut, part, whole);
    return hn::Max(hn::Sub(one, hidden), hn::Zero(kFloats));
}

float find_contact_openness(const BallPacket& contacts, float radius, Vec3f n) {
    Lanes<float> open;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto x = hn::Sub(load(contacts.x, i), set(n.x * radius));
        const auto y = hn::Sub(load(contacts.y, i), set(n.y * radius));
        const auto z = hn::Sub(load(contacts.z, i), set(n.z * radius));
        const auto size = load(contacts.radius, i);
        const auto left = open_of_ball(x, y, z, size, set(n.x), set(n.y), set(n.z));
        const auto used = hn::Gt(size, hn::Zero(kFloats));
        store(hn::IfThenElse(used, left, set(1.0F)), open, i);
    }
    float product = 1.0F;
    for (int i = 0; i < kLanes; ++i) product *= open[i];
    return product;
}

/// The same products in the same order.
void find_contact_openness_at(const BallPacket& contacts, float radius, const NormalPacket& normals,
                              Lanes<float>& open) {
    for (int i = 0; i < kLanes; i += kStep) {
        const auto nx = load(normals.x, i);
        const auto ny = load(normals.y, i);
        const auto nz = load(normals.z, i);
        auto product = set(1.0F);
        for (int k = 0; k < kLanes && contacts.radius[k] > 0.0F; ++k) {
            const auto x = hn::Sub(set(contacts.x[k]), hn::Mul(nx, set(radius)));
            const auto y = hn::Sub(set(contacts.y[k]), hn::Mul(ny, set(radius)));
            const auto z = hn::Sub(set(contacts.z[k]), hn::Mul(nz, set(radius)));
            const auto size = set(contacts.radius[k]);
            product = hn::Mul(product, open_of_ball(x, y, z, size, nx, ny, nz));
        }
        store(product, open, i);
    }
}

}  // namespace ink::ball_kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink::ball_kernels {

HWY_EXPORT(find_within);
HWY_EXPORT(find_openness);
HWY_EXPORT(find_contact_openness);
HWY_EXPORT(find_contact_openness_at);

LaneBits within(const BallPacket& balls, Vec3f point, float reach) {
    return HWY_DYNAMIC_DISPATCH(find_within)(balls, point, reach);
}

float openness(const SkyView& view, Surroundings& surroundings, Vec3f point, Vec3f n) {
    return HWY_DYNAMIC_DISPATCH(find_openness)(view, surroundings, point, n);
}

float contact_openness(const BallPacket& contacts, float radius, Vec3f n) {
    return HWY_DYNAMIC_DISPATCH(find_contact_openness)(contacts, radius, n);
}

void contact_openness(const BallPacket& contacts, float radius, const NormalPacket& normals,
                      Lanes<float>& open) {
    HWY_DYNAMIC_DISPATCH(find_contact_openness_at)(contacts, radius, normals, open);
}

}  // namespace ink::ball_kernels

#endif
