#include <array>
#include <bit>
#include <cstddef>

#include "accel/screen_kernels.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/screen_shades.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "accel/screen_lanes-inl.h"
#include "scene/packed_normals-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

/// Of lanes that saw nothing.
alignas(64) constexpr std::array<float, ShadeNumbers::kCount> kNothing = [] {
    std::array<float, ShadeNumbers::kCount> numbers{};
    numbers[ShadeNumbers::kObject] = std::bit_cast<float>(kNoObject);
    numbers[ShadeNumbers::kPrimitive] = std::bit_cast<float>(kNoObject);
    return numbers;
}();

/// Four numbers from the first of a vector's places, then from every fourth one after it.
template <class Tag>
HWY_INLINE hn::Vec<Tag> load_fours(Tag tag, const float* const* from, std::size_t number) {
    if constexpr (hn::MaxLanes(Tag()) <= 4) {
        return hn::LoadU(tag, *from + number);
    } else {
        const hn::Half<Tag> half;
        return hn::Combine(tag, load_fours(half, from + hn::MaxLanes(half), number),
                           load_fours(half, from, number));
    }
}

/// Four numbers that follow each other in each lane's place.
HWY_INLINE TurnedRound<Floats> four_numbers(const float* const* from, std::size_t number) {
    return {kFloats, [&](std::size_t k) HWY_ATTR { return load_fours(kFloats, from + k, number); }};
}

/// What some lanes of a packet saw, in registers as long as winners are added.
struct Seen {
    Vectors normal, facet;
    Word object, primitive;

    HWY_INLINE Seen()
        : normal{hn::Zero(kFloats), hn::Zero(kFloats), hn::Zero(kFloats)},
          facet(normal),
          object(hn::Set(kWords, kNoObject)),
          primitive(object) {}

    HWY_INLINE void add(const float* shade, Number qx, Number qy, Mask lanes) {
        using S = ShadeNumbers;
        const auto dx = hn::Sub(qx, set(shade[S::kU]));
        const auto dy = hn::Sub(qy, set(shade[S::kV]));
        const auto put_normal = [&](std::size_t axis, Number& to) {
            const auto n = hn::Add(
                hn::Add(set(shade[S::kNormal + axis]), hn::Mul(set(shade[S::kRight + axis]), dx)),
                hn::Mul(set(shade[S::kDown + axis]), dy));
            to = hn::IfThenElse(lanes, n, to);
        };
        put_normal(0, normal.x);
        put_normal(1, normal.y);
        put_normal(2, normal.z);
        facet.x = hn::IfThenElse(lanes, set(shade[S::kFacet]), facet.x);
        facet.y = hn::IfThenElse(lanes, set(shade[S::kFacet + 1]), facet.y);
        facet.z = hn::IfThenElse(lanes, set(shade[S::kFacet + 2]), facet.z);
        const auto own = hn::RebindMask(kWords, lanes);
        const auto number = [&](std::size_t place) {
            return hn::BitCast(kWords, set(shade[place]));
        };
        object = hn::IfThenElse(own, number(S::kObject), object);
        primitive = hn::IfThenElse(own, number(S::kPrimitive), primitive);
    }

    /// What each lane saw, by the numbers of its winner, or `kNothing`.
    HWY_INLINE Seen(const float* const* shades, Number qx, Number qy) {
        using S = ShadeNumbers;
        const auto [nx, ny, nz, right_x] = four_numbers(shades, 0);
        const auto [right_y, right_z, down_x, down_y] = four_numbers(shades, 4);
        const auto [down_z, u, v, facet_x] = four_numbers(shades, 8);
        const auto [facet_y, facet_z, name, of_object] = four_numbers(shades, 12);
        static_assert(S::kRight == 3 && S::kDown == 6 && S::kU == 9 && S::kFacet == 11);
        static_assert(S::kPrimitive == 14 && S::kObject == 15);
        const auto dx = hn::Sub(qx, u);
        const auto dy = hn::Sub(qy, v);
        const auto linear = [&](Number n, Number right, Number down) {
            return hn::Add(hn::Add(n, hn::Mul(right, dx)), hn::Mul(down, dy));
        };
        normal = {linear(nx, right_x, down_x), linear(ny, right_y, down_y),
                  linear(nz, right_z, down_z)};
        facet = {facet_x, facet_y, facet_z};
        primitive = hn::BitCast(kWords, name);
        object = hn::BitCast(kWords, of_object);
    }

    /// As interpolate_normals: on the facet's side, which stands in where normals cancel.
    HWY_INLINE Vectors unit_normal() const {
        const auto squared = dot(normal, normal);
        const auto use = hn::Gt(squared, set(kLeastNormalSquared));
        const auto length = hn::Sqrt(hn::IfThenElse(use, squared, set(1.0F)));
        const auto scale = hn::Div(hn::CopySign(set(1.0F), dot(normal, facet)), length);
        return {hn::IfThenElse(use, hn::Mul(normal.x, scale), facet.x),
                hn::IfThenElse(use, hn::Mul(normal.y, scale), facet.y),
                hn::IfThenElse(use, hn::Mul(normal.z, scale), facet.z)};
    }
};

/// So many winners are told one by one, in less time than those of all lanes.
constexpr int kFewWinners = 3;

/// Lane by lane, of some lanes from one on.
HWY_INLINE Seen see_each(const Front& front, LaneBits hit, const PacketShades* shades, Number qx,
                         Number qy, int i) {
    std::array<const float*, kStep> from;
    for (int n = 0; n < kStep; ++n) {
        const std::uint32_t winner = front.winner[i + n];
        from[static_cast<std::size_t>(n)] =
            (hit >> static_cast<unsigned>(n) & 1U) != 0
                ? shades[winner / kLanes].numbers[winner % kLanes].data()
                : kNothing.data();
    }
    return {from.data(), qx, qy};
}

HWY_INLINE void see_front(const RayFloats& rays, const Front& front, const PacketShades* shades,
                          HitPacket& hits, NormalPacket& normals, PlacePacket* places) {
    for (int i = 0; i < kLanes; i += kStep) {
        const auto depth = load(front.depth, i);
        const auto hit = hn::And(hn::Lt(depth, set(kInfinity)), hn::Gt(depth, set(-kInfinity)));
        const auto qx = load(front.x, i);
        const auto qy = load(front.y, i);
        const auto winners = load(front.winner, i);
        Seen seen;
        int added = 0;
        for (LaneBits left = bits_of(hit); left != 0; ++added) {
            if (added == kFewWinners) {
                seen = see_each(front, bits_of(hit), shades, qx, qy, i);
                break;
            }
            const std::uint32_t winner = front.winner[i + std::countr_zero(left)];
            const auto own =
                hn::And(hn::RebindMask(kFloats, hn::Eq(winners, hn::Set(kWords, winner))), hit);
            left &= ~bits_of(own);
            seen.add(shades[winner / kLanes].numbers[winner % kLanes].data(), qx, qy, own);
        }
        store(seen.unit_normal(), normals.x, normals.y, normals.z, i);
        store(seen.facet, hits.normal_x, hits.normal_y, hits.normal_z, i);
        store(seen.object, hits.object, i);
        store(seen.primitive, hits.primitive, i);
        if (places == nullptr) continue;
        store(rays.place(qx, qy, hn::IfThenElseZero(hit, depth)), places->x, places->y, places->z,
              i);
        const auto t = rays.distance(qx, qy, depth);
        store(hn::IfThenElse(hit, t, set(kInfinity)), hits.t, i);
    }
}

void see_fronts(const Basis& basis, std::span<const Front> fronts, const PacketShades* shades,
                HitPacket* hits, NormalPacket* normals, PlacePacket* places) {
    const RayFloats rays(basis);
    for (std::size_t k = 0; k < fronts.size(); ++k) {
        see_front(rays, fronts[k], shades, hits[k], normals[k],
                  places == nullptr ? nullptr : &places[k]);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(see_fronts);

void see(const Basis& basis, std::span<const Front> fronts, const PacketShades* shades,
         HitPacket* hits, NormalPacket* normals, PlacePacket* places) {
    HWY_DYNAMIC_DISPATCH(see_fronts)(basis, fronts, shades, hits, normals, places);
}

}  // namespace ink

#endif
