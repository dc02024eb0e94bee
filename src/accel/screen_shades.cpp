#include <bit>

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

HWY_INLINE void see_front(const RayFloats& rays, const Front& front, const PacketShades* shades,
                          HitPacket& hits, NormalPacket& normals, PlacePacket* places) {
    for (int i = 0; i < kLanes; i += kStep) {
        const auto depth = load(front.depth, i);
        const auto hit = hn::And(hn::Lt(depth, set(kInfinity)), hn::Gt(depth, set(-kInfinity)));
        const auto qx = load(front.x, i);
        const auto qy = load(front.y, i);
        const auto winners = load(front.winner, i);
        Seen seen;
        for (LaneBits left = bits_of(hit); left != 0;) {
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
