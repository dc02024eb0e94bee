#include <bit>

#include "accel/screen_kernels.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/screen_hits.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "accel/screen_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

/// Lanes of a hit packet, to be written.
struct HitLanes {
    Mask lanes;
    int i;
    HitPacket& hits;

    HWY_INLINE void put(Vector value, Lanes<float>& to) const {
        hn::Store(hn::IfThenElse(lanes, value, load(to, i)), kFloats, to.data() + i);
    }
    HWY_INLINE void put(std::uint32_t value, Lanes<std::uint32_t>& to) const {
        const auto merged =
            hn::IfThenElse(hn::RebindMask(kIndices, lanes), hn::Set(kIndices, value), load(to, i));
        hn::Store(merged, kIndices, to.data() + i);
    }
    HWY_INLINE void put_normal(const Vectors& n) const {
        put(n.x, hits.normal_x);
        put(n.y, hits.normal_y);
        put(n.z, hits.normal_z);
    }
};

HWY_INLINE Vectors vectors(const ScreenPacket& packet, int lane, std::size_t first) {
    return {set(packet.hit[first][lane]), set(packet.hit[first + 1][lane]),
            set(packet.hit[first + 2][lane])};
}

/// The hits of a sphere or triangle, from their place in the scene.
HWY_INLINE void resolve_placed(const ScreenPacket& packet, int lane, const RayPacket& rays,
                               const HitLanes& to) {
    const int i = to.i;
    const Vectors from = vectors(packet, lane, 0);
    const auto t = load(to.hits.t, i);
    const auto at = [&](const Lanes<float>& origin, const Lanes<float>& dir, Vector from_origin) {
        return hn::Sub(hn::Add(load(origin, i), hn::Mul(t, load(dir, i))), from_origin);
    };
    if (packet.kind == ClusterKind::solids) return to.put_normal(vectors(packet, lane, 3));
    const Vectors p{at(rays.origin_x, rays.dir_x, from.x), at(rays.origin_y, rays.dir_y, from.y),
                    at(rays.origin_z, rays.dir_z, from.z)};
    if (packet.kind == ClusterKind::spheres) return to.put_normal(p);
    const auto zero = hn::Zero(kFloats);
    const auto one = set(1.0F);
    const auto u = hn::Min(hn::Max(dot(p, vectors(packet, lane, 6)), zero), one);
    const auto v = hn::Min(hn::Max(dot(p, vectors(packet, lane, 9)), zero), hn::Sub(one, u));
    to.put_normal(vectors(packet, lane, 3));
    to.put(u, to.hits.u);
    to.put(v, to.hits.v);
}

/// The normal of a unit shape at a point of its surface.
HWY_INLINE Vectors unit_normal(const UnitShape& shape, const Vectors& p) {
    const auto zero = hn::Zero(kFloats);
    const auto one = set(1.0F);
    switch (shape.kind) {
        case GlyphKind::ellipsoid: return p;
        case GlyphKind::box: {
            // Of the face that the point is nearest to.
            const auto x = hn::Abs(p.x);
            const auto y = hn::Abs(p.y);
            const auto z = hn::Abs(p.z);
            const auto on_x = hn::And(hn::Ge(x, y), hn::Ge(x, z));
            const auto on_y = hn::AndNot(on_x, hn::Ge(y, z));
            const auto on_z = hn::Not(hn::Or(on_x, on_y));
            return {hn::IfThenElseZero(on_x, hn::CopySign(one, p.x)),
                    hn::IfThenElseZero(on_y, hn::CopySign(one, p.y)),
                    hn::IfThenElseZero(on_z, hn::CopySign(one, p.z))};
        }
        case GlyphKind::frustum: {
            const auto slope = 0.5F * (static_cast<float>(shape.a) - 1.0F);
            const auto middle = 0.5F * (1.0F + static_cast<float>(shape.a));
            const auto radius = hn::Add(set(middle), hn::Mul(set(slope), p.z));
            const auto about = hn::Sqrt(hn::Add(hn::Mul(p.x, p.x), hn::Mul(p.y, p.y)));
            const auto off_side = hn::Abs(hn::Sub(about, radius));
            const auto off_cap = hn::Abs(hn::Sub(hn::Abs(p.z), one));
            const auto on_cap = shape.capped ? hn::Lt(off_cap, off_side) : hn::Lt(one, zero);
            return {hn::IfThenElse(on_cap, zero, p.x), hn::IfThenElse(on_cap, zero, p.y),
                    hn::IfThenElse(on_cap, hn::CopySign(one, p.z), hn::Mul(set(-slope), radius))};
        }
        default: return {zero, zero, one};
    }
}

HWY_INLINE void resolve_glyph(const ScreenPacket& packet, int lane, const Front& front,
                              const HitLanes& to) {
    const int i = to.i;
    const auto form = form_of<GlyphForm>(packet, lane);
    const LocalRays rays = local_rays(form, load(front.x, i), load(front.y, i));
    const auto s = hn::Sub(load(front.depth, i), set(form.z));
    const Vectors n = unit_normal(packet.shape, along(rays.p, rays.d, s));
    const Vectors x = vectors(packet, lane, 0);
    const Vectors y = vectors(packet, lane, 3);
    const Vectors z = vectors(packet, lane, 6);
    const auto turned = [&](Vector a, Vector b, Vector c) {
        return hn::Add(hn::Add(hn::Mul(a, n.x), hn::Mul(b, n.y)), hn::Mul(c, n.z));
    };
    to.put_normal({turned(x.x, y.x, z.x), turned(x.y, y.y, z.y), turned(x.z, y.z, z.z)});
}

/// The lanes of a hit packet that one primitive won.
HWY_INLINE void resolve_winner(const ScreenPacket* packets, std::uint32_t winner,
                               const Front& front, const RayPacket& rays, HitPacket& hits) {
    const ScreenPacket& packet = packets[winner / kLanes];
    const int lane = static_cast<int>(winner % kLanes);
    for (int i = 0; i < kLanes; i += kStep) {
        const auto own = hn::Eq(load(front.winner, i), hn::Set(kIndices, winner));
        const auto depth = load(front.depth, i);
        const auto lanes =
            hn::And(hn::RebindMask(kFloats, own),
                    hn::And(hn::Lt(depth, set(kInfinity)), hn::Gt(depth, set(-kInfinity))));
        if (hn::AllFalse(kFloats, lanes)) continue;
        const HitLanes to{lanes, i, hits};
        if (packet.kind == ClusterKind::glyphs) {
            resolve_glyph(packet, lane, front, to);
        } else {
            resolve_placed(packet, lane, rays, to);
        }
        to.put(packet.object, hits.object);
        to.put(packet.primitive[lane], hits.primitive);
    }
}

void resolve_front(const Front& front, const RayPacket& rays, const ScreenPacket* packets,
                   HitPacket& hits) {
    LaneBits left = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto depth = load(front.depth, i);
        const auto hit = hn::And(hn::Lt(depth, set(kInfinity)), hn::Gt(depth, set(-kInfinity)));
        left |= bits(hit) << static_cast<unsigned>(i);
        // Rays start where depth is 0.
        const auto t = hn::Div(depth, hn::Sqrt(load(front.foreshortening, i)));
        hn::Store(hn::IfThenElse(hit, t, set(kInfinity)), kFloats, hits.t.data() + i);
        for (Lanes<float>* lanes :
             {&hits.normal_x, &hits.normal_y, &hits.normal_z, &hits.u, &hits.v}) {
            hn::Store(hn::Zero(kFloats), kFloats, lanes->data() + i);
        }
        const auto none = hn::Set(kIndices, kNoObject);
        hn::Store(none, kIndices, hits.object.data() + i);
        hn::Store(none, kIndices, hits.primitive.data() + i);
    }
    while (left != 0) {
        const std::uint32_t winner = front.winner[std::countr_zero(left)];
        resolve_winner(packets, winner, front, rays, hits);
        for (int i = 0; i < kLanes; i += kStep) {
            const auto own = hn::Eq(load(front.winner, i), hn::Set(kIndices, winner));
            left &= ~(bits(hn::RebindMask(kFloats, own)) << static_cast<unsigned>(i));
        }
    }
}

void identify_front(const Front& front, const ScreenPacket* packets, HitPacket& hits) {
    LaneBits hit_lanes = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto depth = load(front.depth, i);
        const auto hit = hn::And(hn::Lt(depth, set(kInfinity)), hn::Gt(depth, set(-kInfinity)));
        hit_lanes |= bits(hit) << static_cast<unsigned>(i);
        const auto t = hn::Div(depth, hn::Sqrt(load(front.foreshortening, i)));
        hn::Store(hn::IfThenElse(hit, t, set(kInfinity)), kFloats, hits.t.data() + i);
    }
    for (int i = 0; i < kLanes; ++i) {
        const bool hit = (hit_lanes >> static_cast<unsigned>(i) & 1U) != 0;
        const std::uint32_t winner = front.winner[i];
        hits.object[i] = hit ? packets[winner / kLanes].object : kNoObject;
        hits.primitive[i] =
            hit ? packets[winner / kLanes].primitive[static_cast<int>(winner % kLanes)] : kNoObject;
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(identify_front);
HWY_EXPORT(resolve_front);

void identify(const Front& front, const ScreenPacket* packets, HitPacket& hits) {
    HWY_DYNAMIC_DISPATCH(identify_front)(front, packets, hits);
}

void resolve(const Front& front, const RayPacket& rays, const ScreenPacket* packets,
             HitPacket& hits) {
    HWY_DYNAMIC_DISPATCH(resolve_front)(front, rays, packets, hits);
}

}  // namespace ink

#endif
