#include "shading/ball_sky_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shading/ball_sky_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ink::ball_kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kLanes>;
constexpr Floats kFloats;
constexpr int kStep = static_cast<int>(hn::MaxLanes(Floats()));
constexpr LaneBits kAll = (1U << kLanes) - 1U;

HWY_INLINE auto load(const Lanes<float>& lanes, int first) {
    return hn::Load(kFloats, lanes.data() + first);
}
template <class Vector>
HWY_INLINE void store(Vector value, Lanes<float>& lanes, int first) {
    hn::Store(value, kFloats, lanes.data() + first);
}
HWY_INLINE auto set(float value) { return hn::Set(kFloats, value); }

template <class Mask>
HWY_INLINE LaneBits bits(Mask mask, int first) {
    alignas(8) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kFloats, mask, bytes);
    return (bytes[0] | static_cast<LaneBits>(bytes[1]) << 8U) << static_cast<unsigned>(first);
}

template <class Vector>
HWY_INLINE Vector sum_of_products(Vector ax, Vector bx, Vector ay, Vector by, Vector az,
                                  Vector bz) {
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
        found |= bits(near, i);
    }
    return found;
}

/// Balls as seen from a point: the discs that they are on the sky.
struct Discs {
    Lanes<float> x, y, z;  ///< towards the centre, not of unit length
    Lanes<float> radius;
    Lanes<float> tangent;   ///< length of the tangent; 0 if the point is inside
    Lanes<float> distance;  ///< of the centre
    LaneBits around = 0;    ///< balls that hold the point
};

HWY_INLINE void see(const BallPacket& balls, Vec3f point, Discs& discs) {
    discs.around = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto x = hn::Sub(load(balls.x, i), set(point.x));
        const auto y = hn::Sub(load(balls.y, i), set(point.y));
        const auto z = hn::Sub(load(balls.z, i), set(point.z));
        const auto radius = load(balls.radius, i);
        const auto squared = sum_of_products(x, x, y, y, z, z);
        const auto beyond = hn::Sub(squared, hn::Mul(radius, radius));
        store(x, discs.x, i);
        store(y, discs.y, i);
        store(z, discs.z, i);
        store(radius, discs.radius, i);
        store(hn::Sqrt(hn::Max(beyond, hn::Zero(kFloats))), discs.tangent, i);
        store(hn::Sqrt(squared), discs.distance, i);
        discs.around |= bits(hn::Le(beyond, hn::Zero(kFloats)), i);
    }
}

/// Which discs reach into the cone about `axis`: the angle between a disc's middle and the axis is
/// below the sum of half its size and of the cone's.
HWY_INLINE LaneBits reach_into(const Discs& discs, Vec3f axis, float cos, float sin) {
    LaneBits found = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto along = sum_of_products(set(axis.x), load(discs.x, i), set(axis.y),
                                           load(discs.y, i), set(axis.z), load(discs.z, i));
        const auto least = hn::Sub(hn::Mul(load(discs.tangent, i), set(cos)),
                                   hn::Mul(load(discs.radius, i), set(sin)));
        found |= bits(hn::Gt(along, least), i);
    }
    return found;
}

/// The balls that rise above the horizon, close together.
HWY_INLINE std::size_t rise(const Surroundings& surroundings, float radius, Vec3f n,
                            std::vector<BallPacket>& risen) {
    std::size_t count = 0;
    for (std::size_t k = 0; k * kLanes < surroundings.near_count; ++k) {
        const BallPacket& balls = surroundings.near[k];
        LaneBits above = 0;
        for (int i = 0; i < kLanes; i += kStep) {
            const auto up = sum_of_products(set(n.x), load(balls.x, i), set(n.y), load(balls.y, i),
                                            set(n.z), load(balls.z, i));
            const auto top = hn::Add(up, load(balls.radius, i));
            const auto used = hn::Gt(load(balls.radius, i), hn::Zero(kFloats));
            above |= bits(hn::And(hn::Gt(top, set(radius)), used), i);
        }
        for (; above != 0; above &= above - 1) {
            const int from = std::countr_zero(above);
            const auto to = static_cast<int>(count % kLanes);
            if (count / kLanes == risen.size()) risen.emplace_back();
            BallPacket& packet = risen[count / kLanes];
            packet.x[to] = balls.x[from];
            packet.y[to] = balls.y[from];
            packet.z[to] = balls.z[from];
            packet.radius[to] = balls.radius[from];
            ++count;
        }
    }
    // Far below any horizon.
    for (std::size_t k = count; k % kLanes != 0; ++k) {
        BallPacket& packet = risen[k / kLanes];
        const auto lane = static_cast<int>(k % kLanes);
        packet.x[lane] = packet.y[lane] = packet.z[lane] = packet.radius[lane] = 0.0F;
    }
    return count;
}

/// Discs with soft edges: the share of a direction's cell that one covers is
/// slope * (along - edge) + 1/2, clamped.
struct SoftDiscs : Discs {
    Lanes<float> edge, slope;
    LaneBits used = 0;
};

HWY_INLINE void soften(float spacing, SoftDiscs& discs) {
    for (int i = 0; i < kLanes; i += kStep) {
        // The mean of the cosine over a spacing about the edge is less than that at the edge.
        const auto edge = hn::Mul(load(discs.tangent, i), set(1.0F + spacing * spacing / 24.0F));
        const auto least = hn::Min(load(discs.radius, i), load(discs.distance, i));
        const auto width = hn::Max(hn::Mul(least, set(spacing)), set(1e-20F));
        store(edge, discs.edge, i);
        store(hn::Div(set(1.0F), width), discs.slope, i);
    }
}

/// What near balls leave open above a point of a ball.
class NearSky {
  public:
    NearSky(const SkyDirections& directions, const Surroundings& surroundings, float radius,
            Vec3f n)
        : n_(n) {
        thread_local std::vector<BallPacket> risen;
        thread_local std::vector<SoftDiscs> discs;
        const std::size_t count = rise(surroundings, radius, n, risen);
        packets_ = (count + kLanes - 1) / kLanes;
        if (discs.size() < packets_) discs.resize(packets_);
        discs_ = discs.data();
        for (std::size_t k = 0; k < packets_; ++k) {
            SoftDiscs& seen = discs[k];
            see(risen[k], n * radius, seen);
            soften(directions.spacing, seen);
            const std::size_t used = std::min<std::size_t>(count - k * kLanes, kLanes);
            seen.used = (1U << static_cast<unsigned>(used)) - 1U;
        }
    }

    static bool above(const SkyDirections::Group& group, Vec3f n) {
        return dot(group.axis, n) > -group.sin;
    }

    /// Cosines to the normal, and their parts that are open; false if none is.
    bool look(const SkyDirections::Group& group, Lanes<float>& weight, Lanes<float>& open) const {
        thread_local std::vector<LaneBits> reaching;
        if (reaching.size() < packets_) reaching.resize(packets_);
        for (std::size_t k = 0; k < packets_; ++k) {
            const SoftDiscs& seen = discs_[k];
            reaching[k] =
                (reach_into(seen, group.axis, group.wide_cos, group.wide_sin) | seen.around) &
                seen.used;
        }
        bool any = false;
        for (int i = 0; i < kLanes; i += kStep) {
            const auto x = load(group.x, i);
            const auto y = load(group.y, i);
            const auto z = load(group.z, i);
            const auto up = sum_of_products(x, set(n_.x), y, set(n_.y), z, set(n_.z));
            auto left = hn::Max(up, hn::Zero(kFloats));
            store(left, weight, i);
            for (std::size_t k = 0; k < packets_; ++k) {
                const SoftDiscs& seen = discs_[k];
                for (LaneBits balls = reaching[k]; balls != 0; balls &= balls - 1) {
                    const int ball = std::countr_zero(balls);
                    const auto along = sum_of_products(x, set(seen.x[ball]), y, set(seen.y[ball]),
                                                       z, set(seen.z[ball]));
                    const auto past = hn::Sub(along, set(seen.edge[ball]));
                    const auto bare = hn::Sub(set(0.5F), hn::Mul(past, set(seen.slope[ball])));
                    left = hn::Mul(left, hn::Min(hn::Max(bare, hn::Zero(kFloats)), set(1.0F)));
                }
            }
            store(left, open, i);
            any |= !hn::AllFalse(kFloats, hn::Gt(left, hn::Zero(kFloats)));
        }
        return any;
    }

  private:
    Vec3f n_;
    const SoftDiscs* discs_;
    std::size_t packets_ = 0;
};

/// How much of each direction is free of what begins farther away than `reach`, blended between
/// the texels about the way of the ray.
HWY_INLINE void look_far(const FarSky& far, const SkyDirections::Group& group, std::size_t number,
                         const Sphere& ball, float reach, Vec3f n, Lanes<float>& open) {
    constexpr int kSide = FarSky::kSide;
    constexpr hn::Rebind<std::int32_t, Floats> kInts;
    constexpr hn::Rebind<std::uint32_t, Floats> kIndices;
    const FarSky::Frame& frame = far.frames[number];
    const Vec3f p = ball.centre + n * ball.radius;
    const auto* maps = reinterpret_cast<const std::uint32_t*>(
        far.maps.data() + number * kLanes * std::size_t{kSide} * kSide);
    for (int i = 0; i < kLanes; i += kStep) {
        const auto place = [&](const auto& x, const auto& y, const auto& z) {
            const auto along =
                sum_of_products(load(x, i), set(p.x), load(y, i), set(p.y), load(z, i), set(p.z));
            const auto at = hn::Add(hn::Mul(along, set(far.texels)), set(0.5F * (kSide - 1)));
            return hn::Min(hn::Max(at, hn::Zero(kFloats)), set(kSide - 1.001F));
        };
        const auto x = place(frame.right_x, frame.right_y, frame.right_z);
        const auto y = place(frame.up_x, frame.up_y, frame.up_z);
        const auto column = hn::ConvertTo(kInts, x);
        const auto row = hn::ConvertTo(kInts, y);
        const auto a = hn::Sub(x, hn::ConvertTo(kFloats, column));
        const auto b = hn::Sub(y, hn::ConvertTo(kFloats, row));
        const auto up = sum_of_products(load(group.x, i), set(ball.centre.x), load(group.y, i),
                                        set(ball.centre.y), load(group.z, i), set(ball.centre.z));
        const auto most = hn::Mul(hn::Add(up, set(reach - far.lowest)), set(far.heights));
        // Two texels of 16 bits at once.
        const auto map = hn::Mul(hn::Add(hn::Iota(kInts, 0), hn::Set(kInts, i)),
                                 hn::Set(kInts, kSide * kSide * 2));
        const auto offset =
            hn::Add(map, hn::ShiftLeft<1>(hn::Add(hn::Mul(row, hn::Set(kInts, kSide)), column)));
        const auto free = [&](auto steps) {
            const auto height = hn::ConvertTo(kFloats, hn::BitCast(kInts, steps));
            return hn::IfThenElseZero(hn::Le(height, most), set(1.0F));
        };
        const auto row_free = [&](auto offsets) {
            const auto pair = hn::GatherOffset(kIndices, maps, offsets);
            const auto first = free(hn::And(pair, hn::Set(kIndices, 0xFFFFU)));
            const auto second = free(hn::ShiftRight<16>(pair));
            return hn::Add(first, hn::Mul(a, hn::Sub(second, first)));
        };
        const auto top = row_free(offset);
        const auto bottom = row_free(hn::Add(offset, hn::Set(kInts, kSide * 2)));
        const auto both = hn::Add(top, hn::Mul(b, hn::Sub(bottom, top)));
        store(hn::Mul(load(open, i), both), open, i);
    }
}

float find_openness(const SkyDirections& directions, const FarSky& far,
                    const Surroundings& surroundings, const Sphere& ball, float reach, Vec3f n) {
    const NearSky sky(directions, surroundings, ball.radius, n);
    Lanes<float> open_sum{};
    Lanes<float> sum{};
    for (std::size_t g = 0; g < directions.groups.size(); ++g) {
        const SkyDirections::Group& group = directions.groups[g];
        if (!NearSky::above(group, n)) continue;
        Lanes<float> weight;
        Lanes<float> open;
        const bool any = sky.look(group, weight, open);
        for (int i = 0; i < kLanes; i += kStep) {
            store(hn::Add(load(sum, i), load(weight, i)), sum, i);
        }
        if (!any) continue;
        look_far(far, group, g, ball, reach, n, open);
        for (int i = 0; i < kLanes; i += kStep) {
            store(hn::Add(load(open_sum, i), load(open, i)), open_sum, i);
        }
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

/// A ball on a map, in texels, and the heights at which it begins as seen from the map's two sides.
struct Spot {
    float x, y, radius;
    int left, right, top, bottom;
    float front, back;
};

template <class Tag>
HWY_INLINE void raise_spot(Tag tag, const Spot& spot, float* front, float* back) {
    const auto lanes = hn::Iota(tag, 0);
    const auto in_front = hn::Set(tag, spot.front);
    const auto behind = hn::Set(tag, spot.back);
    for (int row = spot.top; row <= spot.bottom; ++row) {
        const float dy = static_cast<float>(row) + 0.5F - spot.y;
        const auto most = hn::Set(tag, spot.radius * spot.radius - dy * dy);
        for (int i = spot.left; i <= spot.right; i += static_cast<int>(hn::Lanes(tag))) {
            const auto dx = hn::Add(lanes, hn::Set(tag, static_cast<float>(i) + 0.5F - spot.x));
            const auto covered = hn::Lt(hn::Mul(dx, dx), most);
            float* a = front + row * FarSky::kSide + i;
            float* b = back + row * FarSky::kSide + i;
            const auto before_a = hn::LoadU(tag, a);
            const auto before_b = hn::LoadU(tag, b);
            hn::StoreU(hn::Max(before_a, hn::IfThenElseZero(covered, in_front)), tag, a);
            hn::StoreU(hn::Max(before_b, hn::IfThenElseZero(covered, behind)), tag, b);
        }
    }
}

void raise_maps(const FarSky& sky, std::span<const Sphere> balls, Vec3f towards, float* front,
                float* back) {
    constexpr int kSide = FarSky::kSide;
    Vec3f right;
    Vec3f up;
    make_basis(towards, right, up);
    const auto texel = [](float v) { return std::clamp(static_cast<int>(v), 0, kSide - 1); };
    // Balls that follow each other mostly lie side by side, and what was just written to texels is
    // not to be read at once: so they come in another order.
    constexpr std::size_t kStride = 1009;
    for (std::size_t first = 0; first < std::min(kStride, balls.size()); ++first) {
        for (std::size_t k = first; k < balls.size(); k += kStride) {
            const Sphere& ball = balls[k];
            const float x = dot(ball.centre, right) * sky.texels + 0.5F * kSide;
            const float y = dot(ball.centre, up) * sky.texels + 0.5F * kSide;
            const float radius = ball.radius * sky.texels;
            // A ball begins, in the mean over its disc, this much nearer than its centre.
            const float begin = -ball.radius * (2.0F / 3.0F);
            const float height = dot(ball.centre, towards);
            const Spot spot{x,
                            y,
                            radius,
                            texel(x - radius + 0.5F),
                            texel(x + radius - 0.5F),
                            texel(y - radius + 0.5F),
                            texel(y + radius - 0.5F),
                            (begin + height - sky.lowest) * sky.heights,
                            (begin - height - sky.lowest) * sky.heights};
            const int width = spot.right - spot.left + 1;
            if (width <= 4) {
                raise_spot(hn::CappedTag<float, 4>(), spot, front, back);
            } else if (width <= 8) {
                raise_spot(hn::CappedTag<float, 8>(), spot, front, back);
            } else {
                raise_spot(kFloats, spot, front, back);
            }
        }
    }
}

/// Within 7e-5: Abramowitz and Stegun 4.4.45.
template <class Vector>
HWY_INLINE Vector arc_cosine(Vector x) {
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
float find_contact_openness(const BallPacket& contacts, float radius, Vec3f n) {
    Lanes<float> open;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto x = hn::Sub(load(contacts.x, i), set(n.x * radius));
        const auto y = hn::Sub(load(contacts.y, i), set(n.y * radius));
        const auto z = hn::Sub(load(contacts.z, i), set(n.z * radius));
        const auto size = load(contacts.radius, i);
        const auto squared = hn::Max(sum_of_products(x, x, y, y, z, z), set(1e-20F));
        const auto up = sum_of_products(x, set(n.x), y, set(n.y), z, set(n.z));
        const auto limit = set(0.99999F);
        const auto cosine = hn::Max(hn::Min(hn::Div(up, hn::Sqrt(squared)), limit), hn::Neg(limit));
        const auto cosine2 = hn::Mul(cosine, cosine);
        const auto share =  // (radius / distance)^2
            hn::Min(hn::Div(hn::Mul(size, size), squared), set(1.0F));
        const auto whole = hn::Mul(hn::Max(cosine, hn::Zero(kFloats)), share);
        // h = distance / radius; q^2 = (h^2 - 1) / (1 - cosine^2)
        const auto inverse = hn::Div(set(1.0F), hn::Max(share, set(1e-12F)));
        const auto beyond = hn::Sub(inverse, set(1.0F));
        const auto q = hn::Sqrt(hn::Div(beyond, hn::Sub(set(1.0F), cosine2)));
        const auto k2 = hn::Sub(set(1.0F), hn::Mul(inverse, cosine2));
        const auto cut = hn::Gt(k2, hn::Zero(kFloats));
        const auto one = set(1.0F);
        const auto first =
            arc_cosine(hn::Max(hn::Min(hn::Neg(hn::Mul(cosine, q)), one), hn::Neg(one)));
        const auto second = arc_cosine(hn::Min(hn::Mul(q, hn::Sqrt(share)), one));
        const auto root = hn::Sqrt(hn::Mul(hn::Max(k2, hn::Zero(kFloats)), beyond));
        const auto lens = hn::Mul(hn::Sub(hn::Mul(cosine, first), root), share);
        const auto part = hn::Mul(hn::Add(lens, second), set(0.318309886F));
        const auto hidden = hn::IfThenElse(cut, part, whole);
        const auto used = hn::Gt(size, hn::Zero(kFloats));
        const auto left = hn::Max(hn::Sub(one, hidden), hn::Zero(kFloats));
        store(hn::IfThenElse(used, left, one), open, i);
    }
    float product = 1.0F;
    for (int i = 0; i < kLanes; ++i) product *= open[i];
    return product;
}

}  // namespace ink::ball_kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink::ball_kernels {

HWY_EXPORT(find_within);
HWY_EXPORT(find_openness);
HWY_EXPORT(raise_maps);
HWY_EXPORT(find_contact_openness);

LaneBits within(const BallPacket& balls, Vec3f point, float reach) {
    return HWY_DYNAMIC_DISPATCH(find_within)(balls, point, reach);
}

void raise(const FarSky& sky, std::span<const Sphere> balls, Vec3f towards, std::span<float> front,
           std::span<float> back) {
    HWY_DYNAMIC_DISPATCH(raise_maps)(sky, balls, towards, front.data(), back.data());
}

float openness(const SkyDirections& directions, const FarSky& far, const Surroundings& surroundings,
               const Sphere& ball, float reach, Vec3f n) {
    return HWY_DYNAMIC_DISPATCH(find_openness)(directions, far, surroundings, ball, reach, n);
}

float contact_openness(const BallPacket& contacts, float radius, Vec3f n) {
    return HWY_DYNAMIC_DISPATCH(find_contact_openness)(contacts, radius, n);
}

}  // namespace ink::ball_kernels

#endif
