#include "accel/screen_kernels.h"

#include <bit>
#include <cmath>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/screen_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kLanes>;
using Indices = hn::Rebind<std::uint32_t, Floats>;
constexpr Floats kFloats;
constexpr Indices kIndices;
constexpr int kStep = static_cast<int>(hn::MaxLanes(Floats()));

template <class T>
HWY_INLINE auto load(const Lanes<T>& lanes, int first) {
    return hn::Load(hn::CappedTag<T, kLanes>(), lanes.data() + first);
}

HWY_INLINE auto set(float value) { return hn::Set(kFloats, value); }

template <class Mask>
HWY_INLINE LaneBits bits(Mask mask) {
    alignas(8) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kFloats, mask, bytes);
    return bytes[0] | static_cast<LaneBits>(bytes[1]) << 8U;
}

HWY_INLINE LaneBits overlap_lanes(const BoundsPacket& bounds, const Window& window) {
    LaneBits all = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto across = hn::And(hn::Le(load(bounds.left, i), set(window.right)),
                                    hn::Ge(load(bounds.right, i), set(window.left)));
        const auto down = hn::And(hn::Le(load(bounds.top, i), set(window.bottom)),
                                  hn::Ge(load(bounds.bottom, i), set(window.top)));
        const auto near = hn::Lt(load(bounds.depth, i), set(window.farthest));
        all |= bits(hn::And(hn::And(across, down), near)) << static_cast<unsigned>(i);
    }
    return all;
}

LaneBits find_overlap(const BoundsPacket& bounds, const Window& window) {
    return overlap_lanes(bounds, window);
}

/// Takes the hits that lie in front of what there is.
template <class Depth, class Mask>
HWY_INLINE bool keep_nearer(Depth depth, Mask covered, std::uint32_t winner, int i, Front& front) {
    const auto before = load(front.depth, i);
    const auto hit = hn::And(covered, hn::Lt(depth, before));
    if (hn::AllFalse(kFloats, hit)) return false;
    hn::Store(hn::IfThenElse(hit, depth, before), kFloats, front.depth.data() + i);
    const auto winners = hn::IfThenElse(hn::RebindMask(kIndices, hit), hn::Set(kIndices, winner),
                                        load(front.winner, i));
    hn::Store(winners, kIndices, front.winner.data() + i);
    return true;
}

HWY_INLINE void update_farthest(Front& front) {
    auto most = load(front.depth, 0);
    for (int i = kStep; i < kLanes; i += kStep) most = hn::Max(most, load(front.depth, i));
    front.window.farthest = hn::GetLane(hn::MaxOfLanes(kFloats, most));
}

HWY_INLINE void intersect_sphere(float origin_step, float slope_step, const SphereForm& form,
                                 std::uint32_t winner, Front& front) {
    const auto u = set(form.u);
    const auto v = set(form.v);
    const auto a = set(form.a);
    const auto b = set(form.b);
    const auto c = set(form.c);
    const auto f = set(form.f);
    const auto x = set(form.x);
    const auto y = set(form.y);
    const auto z = set(form.z);
    const auto origin = set(origin_step);
    const auto slope = set(slope_step);
    bool changed = false;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto qx = load(front.x, i);
        const auto qy = load(front.y, i);
        const auto dx = hn::Sub(qx, u);
        const auto dy = hn::Sub(qy, v);
        const auto across = hn::Mul(dx, hn::Add(hn::Mul(a, dx), hn::Mul(b, dy)));
        const auto h = hn::Sub(f, hn::Add(across, hn::Mul(c, hn::Mul(dy, dy))));
        const auto covered = hn::Gt(h, hn::Zero(kFloats));
        if (hn::AllFalse(kFloats, covered)) continue;
        const auto along_x = hn::Mul(hn::Mul(qx, slope), hn::Sub(x, hn::Mul(qx, origin)));
        const auto along_y = hn::Mul(hn::Mul(qy, slope), hn::Sub(y, hn::Mul(qy, origin)));
        const auto m = hn::Add(hn::Add(z, along_x), along_y);
        const auto depth = hn::Mul(hn::Sub(m, hn::Sqrt(h)), load(front.foreshortening, i));
        changed |= keep_nearer(depth, covered, winner, i, front);
    }
    if (changed) update_farthest(front);
}

void intersect_spheres(float origin_step, float slope_step, const SpherePacket& packet,
                       std::uint32_t first, Front& front) {
    for (LaneBits lanes = overlap_lanes(packet.bounds, front.window); lanes != 0;
         lanes &= lanes - 1) {
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
        intersect_sphere(origin_step, slope_step, packet.forms[lane], first + lane, front);
    }
}

template <class Vector>
HWY_INLINE Vector edge_value(const TriangleForm::Edge& edge, Vector qx, Vector qy) {
    return hn::Sub(hn::Mul(set(edge.dx), hn::Sub(qy, set(edge.y))),
                   hn::Mul(set(edge.dy), hn::Sub(qx, set(edge.x))));
}

/// True if it is the nearest so far on some ray.
HWY_INLINE bool intersect_triangle(const TriangleForm& form, std::uint32_t winner, Front& front) {
    bool changed = false;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto qx = load(front.x, i);
        const auto qy = load(front.y, i);
        const auto e0 = edge_value(form.edges[0], qx, qy);
        const auto e1 = edge_value(form.edges[1], qx, qy);
        const auto e2 = edge_value(form.edges[2], qx, qy);
        const auto covered = hn::Ge(hn::Min(hn::Min(e0, e1), e2), hn::Zero(kFloats));
        if (hn::AllFalse(kFloats, covered)) continue;
        const auto rise = hn::Add(hn::Mul(set(form.gx), hn::Sub(qx, set(form.u))),
                                  hn::Mul(set(form.gy), hn::Sub(qy, set(form.v))));
        const auto facing =
            hn::Add(hn::Add(set(form.w), hn::Mul(set(form.wx), qx)), hn::Mul(set(form.wy), qy));
        const auto plane = hn::Add(set(form.z), hn::Div(rise, facing));
        const auto depth = hn::Min(hn::Max(plane, set(form.near)), set(form.far));
        changed |= keep_nearer(depth, covered, winner, i, front);
    }
    return changed;
}

void intersect_triangles(const TrianglePacket& packet, std::uint32_t first, Front& front) {
    bool changed = false;
    for (LaneBits lanes = overlap_lanes(packet.bounds, front.window); lanes != 0;
         lanes &= lanes - 1) {
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
        changed |= intersect_triangle(packet.forms[lane], first + lane, front);
    }
    if (changed) update_farthest(front);
}

void start_front(float centre_x, float centre_y, float slope_step, const PointPacket& points,
                 Front& front) {
    const auto infinity = set(kInfinity);
    const auto minus_infinity = set(-kInfinity);
    auto left = infinity;
    auto top = infinity;
    auto right = minus_infinity;
    auto bottom = minus_infinity;
    auto farthest = minus_infinity;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto on = hn::RebindMask(
            kFloats,
            hn::Ne(load(points.active, i), hn::Zero(hn::CappedTag<std::int32_t, kLanes>())));
        const auto x = hn::Sub(load(points.x, i), set(centre_x));
        const auto y = hn::Sub(load(points.y, i), set(centre_y));
        const auto slope_x = hn::Mul(x, set(slope_step));
        const auto slope_y = hn::Mul(y, set(slope_step));
        const auto squared =
            hn::Add(hn::Add(set(1.0F), hn::Mul(slope_x, slope_x)), hn::Mul(slope_y, slope_y));
        const auto depth = hn::IfThenElse(on, infinity, minus_infinity);
        hn::Store(x, kFloats, front.x.data() + i);
        hn::Store(y, kFloats, front.y.data() + i);
        hn::Store(hn::Div(set(1.0F), squared), kFloats, front.foreshortening.data() + i);
        hn::Store(depth, kFloats, front.depth.data() + i);
        left = hn::Min(left, hn::IfThenElse(on, x, infinity));
        top = hn::Min(top, hn::IfThenElse(on, y, infinity));
        right = hn::Max(right, hn::IfThenElse(on, x, minus_infinity));
        bottom = hn::Max(bottom, hn::IfThenElse(on, y, minus_infinity));
        farthest = hn::Max(farthest, depth);
    }
    front.window = {
        hn::GetLane(hn::MinOfLanes(kFloats, left)), hn::GetLane(hn::MaxOfLanes(kFloats, right)),
        hn::GetLane(hn::MinOfLanes(kFloats, top)), hn::GetLane(hn::MaxOfLanes(kFloats, bottom)),
        hn::GetLane(hn::MaxOfLanes(kFloats, farthest))};
}

/// The lanes of a hit packet that one primitive won.
HWY_INLINE void resolve_winner(const HitRecord& record, std::uint32_t winner, const Front& front,
                               const RayPacket& rays, HitPacket& hits) {
    for (int i = 0; i < kLanes; i += kStep) {
        const auto own = hn::Eq(load(front.winner, i), hn::Set(kIndices, winner));
        const auto depth = load(front.depth, i);
        const auto lanes =
            hn::And(hn::RebindMask(kFloats, own),
                    hn::And(hn::Lt(depth, set(kInfinity)), hn::Gt(depth, set(-kInfinity))));
        if (hn::AllFalse(kFloats, lanes)) continue;
        const auto t = load(hits.t, i);
        const auto px = hn::Sub(hn::Add(load(rays.origin_x, i), hn::Mul(t, load(rays.dir_x, i))),
                                set(record.origin.x));
        const auto py = hn::Sub(hn::Add(load(rays.origin_y, i), hn::Mul(t, load(rays.dir_y, i))),
                                set(record.origin.y));
        const auto pz = hn::Sub(hn::Add(load(rays.origin_z, i), hn::Mul(t, load(rays.dir_z, i))),
                                set(record.origin.z));
        const auto put = [&](auto value, Lanes<float>& to) {
            hn::Store(hn::IfThenElse(lanes, value, load(to, i)), kFloats, to.data() + i);
        };
        if (record.is_sphere) {
            put(px, hits.normal_x);
            put(py, hits.normal_y);
            put(pz, hits.normal_z);
        } else {
            const auto along = [&](Vec3f axis) {
                return hn::Add(hn::Add(hn::Mul(px, set(axis.x)), hn::Mul(py, set(axis.y))),
                               hn::Mul(pz, set(axis.z)));
            };
            const auto zero = hn::Zero(kFloats);
            const auto one = set(1.0F);
            const auto u = hn::Min(hn::Max(along(record.u_axis), zero), one);
            const auto v = hn::Min(hn::Max(along(record.v_axis), zero), hn::Sub(one, u));
            put(set(record.normal.x), hits.normal_x);
            put(set(record.normal.y), hits.normal_y);
            put(set(record.normal.z), hits.normal_z);
            put(u, hits.u);
            put(v, hits.v);
        }
        const auto put_index = [&](std::uint32_t value, Lanes<std::uint32_t>& to) {
            const auto merged = hn::IfThenElse(hn::RebindMask(kIndices, lanes),
                                               hn::Set(kIndices, value), load(to, i));
            hn::Store(merged, kIndices, to.data() + i);
        };
        put_index(record.object, hits.object);
        put_index(record.primitive, hits.primitive);
    }
}

void resolve_front(const Front& front, const RayPacket& rays, const HitRecord* records,
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
        resolve_winner(records[winner], winner, front, rays, hits);
        for (int i = 0; i < kLanes; i += kStep) {
            const auto own = hn::Eq(load(front.winner, i), hn::Set(kIndices, winner));
            left &= ~(bits(hn::RebindMask(kFloats, own)) << static_cast<unsigned>(i));
        }
    }
}

void identify_front(const Front& front, const HitRecord* records, HitPacket& hits) {
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
        hits.object[i] = hit ? records[front.winner[i]].object : kNoObject;
        hits.primitive[i] = hit ? records[front.winner[i]].primitive : kNoObject;
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(find_overlap);
HWY_EXPORT(identify_front);
HWY_EXPORT(intersect_spheres);
HWY_EXPORT(intersect_triangles);
HWY_EXPORT(resolve_front);
HWY_EXPORT(start_front);

LaneBits overlap(const BoundsPacket& bounds, const Window& window) {
    return HWY_DYNAMIC_DISPATCH(find_overlap)(bounds, window);
}

void intersect(const Projection& projection, const SpherePacket& packet, std::uint32_t first,
               Front& front) {
    HWY_DYNAMIC_DISPATCH(intersect_spheres)
    (static_cast<float>(projection.origin_step), static_cast<float>(projection.slope_step), packet,
     first, front);
}

void intersect(const Projection& /*projection*/, const TrianglePacket& packet, std::uint32_t first,
               Front& front) {
    HWY_DYNAMIC_DISPATCH(intersect_triangles)(packet, first, front);
}

void identify(const Front& front, const HitRecord* records, HitPacket& hits) {
    HWY_DYNAMIC_DISPATCH(identify_front)(front, records, hits);
}

void resolve(const Front& front, const RayPacket& rays, const HitRecord* records, HitPacket& hits) {
    HWY_DYNAMIC_DISPATCH(resolve_front)(front, rays, records, hits);
}

void Front::start(const Projection& projection, const PointPacket& points) {
    HWY_DYNAMIC_DISPATCH(start_front)
    (projection.centre.x, projection.centre.y, static_cast<float>(projection.slope_step), points,
     *this);
}

}  // namespace ink

#endif
