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

/// Some lanes of a hit packet as they are found. They stay in registers: a packet has several
/// winners, each of which would wait until what the one before wrote can be read.
struct Found {
    Vectors normal;
    Number u, v;
    Word object, primitive;

    HWY_INLINE Found()
        : normal{hn::Zero(kFloats), hn::Zero(kFloats), hn::Zero(kFloats)},
          u(hn::Zero(kFloats)),
          v(hn::Zero(kFloats)),
          object(hn::Set(kWords, kNoObject)),
          primitive(hn::Set(kWords, kNoObject)) {}

    HWY_INLINE void put_normal(Mask lanes, const Vectors& n) {
        normal.x = hn::IfThenElse(lanes, n.x, normal.x);
        normal.y = hn::IfThenElse(lanes, n.y, normal.y);
        normal.z = hn::IfThenElse(lanes, n.z, normal.z);
    }

    HWY_INLINE void put(int i, HitPacket& hits) const {
        store(normal.x, hits.normal_x, i);
        store(normal.y, hits.normal_y, i);
        store(normal.z, hits.normal_z, i);
        store(u, hits.u, i);
        store(v, hits.v, i);
        store(object, hits.object, i);
        store(primitive, hits.primitive, i);
    }
};

HWY_INLINE Vectors vectors(const HitNumbers& hit, std::size_t first) {
    return {set(hit[first]), set(hit[first + 1]), set(hit[first + 2])};
}

/// The hits of a sphere or triangle, from their place in the scene.
HWY_INLINE void resolve_placed(const ScreenPacket& packet, const HitNumbers& hit,
                               const Vectors& place, Mask lanes, Found& found) {
    if (packet.kind == ClusterKind::solids) return found.put_normal(lanes, vectors(hit, 3));
    const Vectors p = place - vectors(hit, 0);
    if (packet.kind == ClusterKind::spheres) return found.put_normal(lanes, p);
    const auto zero = hn::Zero(kFloats);
    const auto one = set(1.0F);
    const auto u = hn::Min(hn::Max(dot(p, vectors(hit, 6)), zero), one);
    const auto v = hn::Min(hn::Max(dot(p, vectors(hit, 9)), zero), hn::Sub(one, u));
    found.put_normal(lanes, vectors(hit, 3));
    found.u = hn::IfThenElse(lanes, u, found.u);
    found.v = hn::IfThenElse(lanes, v, found.v);
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

HWY_INLINE void resolve_glyph(const ScreenPacket& packet, int lane, const Front& front, int i,
                              Mask lanes, Found& found) {
    const auto form = glyph_form(packet.forms[static_cast<std::size_t>(lane)]);
    const LocalRays rays = local_rays(form, load(front.x, i), load(front.y, i));
    const auto s = hn::Sub(load(front.depth, i), set(form.z));
    const Vectors n = unit_normal(packet.shape, along(rays.p, rays.d, s));
    const HitNumbers& hit = packet.hit[static_cast<std::size_t>(lane)];
    const Vectors x = vectors(hit, 0);
    const Vectors y = vectors(hit, 3);
    const Vectors z = vectors(hit, 6);
    const auto turned = [&](Number a, Number b, Number c) {
        return hn::Add(hn::Add(hn::Mul(a, n.x), hn::Mul(b, n.y)), hn::Mul(c, n.z));
    };
    found.put_normal(lanes, {turned(x.x, y.x, z.x), turned(x.y, y.y, z.y), turned(x.z, y.z, z.z)});
}

/// The lanes of a hit packet, from the i-th on, that one primitive won.
HWY_INLINE void resolve_winner(const ScreenPacket& packet, int lane, const Front& front,
                               const Vectors& place, int i, Mask lanes, Found& found) {
    if (packet.kind == ClusterKind::glyphs) {
        resolve_glyph(packet, lane, front, i, lanes, found);
    } else {
        const HitNumbers& hit = packet.hit[static_cast<std::size_t>(lane)];
        resolve_placed(packet, hit, place, lanes, found);
    }
    const auto own = hn::RebindMask(kWords, lanes);
    found.object = hn::IfThenElse(own, hn::Set(kWords, packet.object), found.object);
    found.primitive = hn::IfThenElse(own, hn::Set(kWords, packet.primitive[lane]), found.primitive);
}

/// Which lanes of a front hit anything.
HWY_INLINE Mask hit_lanes_of(Number depth) {
    return hn::And(hn::Lt(depth, set(kInfinity)), hn::Gt(depth, set(-kInfinity)));
}

/// Distances along rays, which start where depth is 0.
HWY_INLINE Number distance(const Front& front, Number depth, int i) {
    return hn::Div(depth, hn::Sqrt(load(front.foreshortening, i)));
}

/// What the lanes that hit anything found at their places.
HWY_INLINE Found find_winners(const Front& front, const ScreenPacket* packets, const Vectors& place,
                              int i, Mask hit) {
    const auto winners = load(front.winner, i);
    Found found;
    for (LaneBits left = bits_of(hit); left != 0;) {
        const std::uint32_t winner = front.winner[i + std::countr_zero(left)];
        const auto won = hn::RebindMask(kFloats, hn::Eq(winners, hn::Set(kWords, winner)));
        left &= ~bits_of(won);
        resolve_winner(packets[winner / kLanes], static_cast<int>(winner % kLanes), front, place, i,
                       hn::And(won, hit), found);
    }
    return found;
}

void resolve_front(const Front& front, const RayPacket& rays, const ScreenPacket* packets,
                   HitPacket& hits) {
    for (int i = 0; i < kLanes; i += kStep) {
        const auto depth = load(front.depth, i);
        const auto hit = hit_lanes_of(depth);
        const auto t = distance(front, depth, i);
        store(hn::IfThenElse(hit, t, set(kInfinity)), hits.t, i);
        const auto at = [&](const Lanes<float>& origin, const Lanes<float>& dir) {
            return hn::Add(load(origin, i), hn::Mul(t, load(dir, i)));
        };
        const Vectors place{at(rays.origin_x, rays.dir_x), at(rays.origin_y, rays.dir_y),
                            at(rays.origin_z, rays.dir_z)};
        find_winners(front, packets, place, i, hit).put(i, hits);
    }
}

/// Of unit length, on the viewer's side; zero where nothing was hit.
HWY_INLINE Vectors facing(const Vectors& normal, const Vectors& ray) {
    const auto one = set(1.0F);
    const auto away = hn::Gt(dot(normal, ray), hn::Zero(kFloats));
    const auto squared = dot(normal, normal);
    const auto scale = hn::Div(hn::IfThenElse(away, hn::Neg(one), one), hn::Sqrt(squared));
    return scaled(normal, hn::IfThenElseZero(hn::Gt(squared, hn::Zero(kFloats)), scale));
}

void see_solid_fronts(const Basis& basis, std::span<const Front> fronts,
                      const ScreenPacket* packets, HitPacket* hits, NormalPacket* normals,
                      PlacePacket* places) {
    const RayFloats rays(basis);
    for (std::size_t k = 0; k < fronts.size(); ++k) {
        const Front& front = fronts[k];
        for (int i = 0; i < kLanes; i += kStep) {
            const auto depth = load(front.depth, i);
            const auto hit = hit_lanes_of(depth);
            const auto qx = load(front.x, i);
            const auto qy = load(front.y, i);
            const Vectors place = rays.place(qx, qy, hn::IfThenElseZero(hit, depth));
            const Found found = find_winners(front, packets, place, i, hit);
            const Vectors normal = facing(found.normal, rays.direction(qx, qy));
            store(hn::IfThenElse(hit, distance(front, depth, i), set(kInfinity)), hits[k].t, i);
            store(normal, hits[k].normal_x, hits[k].normal_y, hits[k].normal_z, i);
            store(normal, normals[k].x, normals[k].y, normals[k].z, i);
            store(found.object, hits[k].object, i);
            store(found.primitive, hits[k].primitive, i);
            if (places != nullptr) store(place, places[k].x, places[k].y, places[k].z, i);
        }
    }
}

void identify_front(const Front& front, const ScreenPacket* packets, HitPacket& hits) {
    LaneBits hit_lanes = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto depth = load(front.depth, i);
        const auto hit = hit_lanes_of(depth);
        hit_lanes |= bits_of(hit) << static_cast<unsigned>(i);
        store(hn::IfThenElse(hit, distance(front, depth, i), set(kInfinity)), hits.t, i);
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
HWY_EXPORT(see_solid_fronts);

void identify(const Front& front, const ScreenPacket* packets, HitPacket& hits) {
    HWY_DYNAMIC_DISPATCH(identify_front)(front, packets, hits);
}

void resolve(const Front& front, const RayPacket& rays, const ScreenPacket* packets,
             HitPacket& hits) {
    HWY_DYNAMIC_DISPATCH(resolve_front)(front, rays, packets, hits);
}

void see(const Basis& basis, std::span<const Front> fronts, const ScreenPacket* packets,
         HitPacket* hits, NormalPacket* normals, PlacePacket* places) {
    HWY_DYNAMIC_DISPATCH(see_solid_fronts)(basis, fronts, packets, hits, normals, places);
}

}  // namespace ink

#endif
