#include <array>

#include "accel/screen_packets.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/shade_forms.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "accel/screen_lanes-inl.h"
#include "accel/side_by_side-inl.h"
#include "scene/packed_normals-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

using ShadeLanes = std::array<Lanes<float>, ShadeNumbers::kCount>;

HWY_INLINE void store(const Vectors& v, ShadeLanes& lanes, std::size_t first, int i) {
    store(v.x, lanes[first], i);
    store(v.y, lanes[first + 1], i);
    store(v.z, lanes[first + 2], i);
}

HWY_INLINE Vectors load(const Points& points, int first) {
    return {load(points.x, first), load(points.y, first), load(points.z, first)};
}

/// Of unit length, on the side that is seen. Zero without an area.
HWY_INLINE Vectors facet(const TriangleLanes& triangles, Number area, int i) {
    const Vectors a = load(triangles.a, i);
    const Vectors e = load(triangles.b, i) - a;
    const Vectors f = load(triangles.c, i) - a;
    const Vectors n = cross(e, f);
    const auto length = hn::Sqrt(dot(n, n));
    const auto side = hn::Neg(hn::CopySign(set(1.0F), area));
    return scaled(n, hn::IfThenElseZero(hn::Gt(length, hn::Zero(kFloats)), hn::Div(side, length)));
}

/// A corner's place on the screen from the first one's, and what its normal counts there.
struct WeighedCorner {
    Number du, dv;
    Vectors n;
};

HWY_INLINE Vectors unpacked(const Lanes<std::uint32_t>& packed, int i) {
    const auto n = unpack_normals(kFloats, load(packed, i));
    return {n.x, n.y, n.z};
}

HWY_INLINE WeighedCorner weigh(const Basis& basis, const ScreenCorners::Corner& corner,
                               const ScreenCorners::Corner& first,
                               const Lanes<std::uint32_t>& packed, int i) {
    const auto from_eye = [&](const ScreenCorners::Corner& of) {
        return hn::Add(load(of.depth, i), set(static_cast<float>(basis.start_depth)));
    };
    const auto weight = basis.orthographic ? set(1.0F) : hn::Div(from_eye(first), from_eye(corner));
    return {hn::Sub(load(corner.u, i), load(first.u, i)),
            hn::Sub(load(corner.v, i), load(first.v, i)), scaled(unpacked(packed, i), weight)};
}

/// The plane through the three corners' normals. Where a triangle is so thin that rounded corners
/// do not tell how normals change across it, their sum.
HWY_INLINE void lay_normals(const Basis& basis, const ScreenCorners& corners,
                            const CornerNormals& normals, int i, ShadeLanes& lanes) {
    const Vectors first = unpacked(normals.a, i);
    const WeighedCorner b = weigh(basis, corners.b, corners.a, normals.b, i);
    const WeighedCorner c = weigh(basis, corners.c, corners.a, normals.c, i);
    const auto squared = [](const WeighedCorner& of) {
        return hn::Add(hn::Mul(of.du, of.du), hn::Mul(of.dv, of.dv));
    };
    constexpr float kThin = 1e-5F;  // of the square on its longest side
    const auto area = load(corners.area, i);
    const auto is_thin =
        hn::Lt(hn::Abs(area), hn::Mul(set(kThin), hn::Max(squared(b), squared(c))));
    const auto scale =
        hn::IfThenElse(is_thin, hn::Zero(kFloats), hn::Div(set(1.0F), not_zero(area)));
    const Vectors to_b = b.n - first;
    const Vectors to_c = c.n - first;
    const auto slope = [&](Number along_b, Number along_c) -> Vectors {
        const auto of = [&](Number by_b, Number by_c) {
            return hn::Mul(hn::Add(hn::Mul(by_b, along_b), hn::Mul(by_c, along_c)), scale);
        };
        return {of(to_b.x, to_c.x), of(to_b.y, to_c.y), of(to_b.z, to_c.z)};
    };
    const auto start = [&](Number a, Number of_b, Number of_c) {
        return hn::IfThenElse(is_thin, hn::Add(hn::Add(a, of_b), of_c), a);
    };
    store(
        {start(first.x, b.n.x, c.n.x), start(first.y, b.n.y, c.n.y), start(first.z, b.n.z, c.n.z)},
        lanes, ShadeNumbers::kNormal, i);
    store(slope(c.dv, hn::Neg(b.dv)), lanes, ShadeNumbers::kRight, i);
    store(slope(hn::Neg(c.du), b.du), lanes, ShadeNumbers::kDown, i);
}

void lay_shades(Basis basis, const TriangleLanes& triangles, const ScreenCorners& corners,
                const CornerNormals* normals, const ScreenPacket& packet, PacketShades& shades) {
    ShadeLanes lanes;
    const Vectors none{hn::Zero(kFloats), hn::Zero(kFloats), hn::Zero(kFloats)};
    for (int i = 0; i < kLanes; i += kStep) {
        if (normals != nullptr) {
            lay_normals(basis, corners, *normals, i, lanes);
        } else {
            store(none, lanes, ShadeNumbers::kNormal, i);
            store(none, lanes, ShadeNumbers::kRight, i);
            store(none, lanes, ShadeNumbers::kDown, i);
        }
        store(load(corners.a.u, i), lanes[ShadeNumbers::kU], i);
        store(load(corners.a.v, i), lanes[ShadeNumbers::kV], i);
        store(facet(triangles, load(corners.area, i), i), lanes, ShadeNumbers::kFacet, i);
        store(hn::BitCast(kFloats, load(packet.primitive, i)), lanes[ShadeNumbers::kPrimitive], i);
        store(hn::BitCast(kFloats, hn::Set(kWords, packet.object)), lanes[ShadeNumbers::kObject],
              i);
    }
    lay_side_by_side(lanes, ShadeNumbers::kCount, shades.numbers);
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(lay_shades);

void prepare_shades(const Basis& basis, const TriangleLanes& triangles,
                    const ScreenCorners& corners, const CornerNormals* normals,
                    const ScreenPacket& packet, PacketShades& shades) {
    HWY_DYNAMIC_DISPATCH(lay_shades)(basis, triangles, corners, normals, packet, shades);
}

}  // namespace ink

#endif
