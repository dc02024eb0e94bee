#include "shading/smooth_normals.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shading/smooth_normals.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"
#include "scene/packed_normals-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

HWY_INLINE void add_corner(Word packed, Number weight, Vectors& sum) {
    const auto corner = unpack_normals(kFloats, packed);
    sum.x = hn::Add(sum.x, hn::Mul(weight, corner.x));
    sum.y = hn::Add(sum.y, hn::Mul(weight, corner.y));
    sum.z = hn::Add(sum.z, hn::Mul(weight, corner.z));
}

void interpolate(const std::uint32_t* corner_normals, std::uint32_t object, const HitPacket& hits,
                 const NormalLanes& geometric, NormalPacket& normals) {
    for (int i = 0; i < kLanes; i += kStep) {
        const auto own = hn::Eq(load(hits.object, i), hn::Set(kWords, object));
        const auto primitive = hn::IfThenElseZero(own, load(hits.primitive, i));
        const auto twice = hn::Add(primitive, primitive);
        const auto first = hn::BitCast(kIntegers, hn::Add(twice, primitive));
        const auto corner = [&](int k) {
            const auto* base = reinterpret_cast<const std::int32_t*>(corner_normals) + k;
            return hn::BitCast(kWords, hn::GatherIndex(kIntegers, base, first));
        };
        const auto u = load(hits.u, i);
        const auto v = load(hits.v, i);
        Vectors sum{hn::Zero(kFloats), hn::Zero(kFloats), hn::Zero(kFloats)};
        add_corner(corner(0), hn::Sub(hn::Sub(set(1.0F), u), v), sum);
        add_corner(corner(1), u, sum);
        add_corner(corner(2), v, sum);

        const Vectors g{load(geometric.x, i), load(geometric.y, i), load(geometric.z, i)};
        const auto side = dot(sum, g);
        const auto squared = dot(sum, sum);
        // Else the geometric normal stands in.
        const auto use =
            hn::And(hn::RebindMask(kFloats, own), hn::Gt(squared, set(kLeastNormalSquared)));
        const auto length = hn::Sqrt(hn::IfThenElse(use, squared, set(1.0F)));
        const auto scale = hn::Div(hn::CopySign(set(1.0F), side), length);
        store(hn::IfThenElse(use, hn::Mul(sum.x, scale), g.x), normals.x, i);
        store(hn::IfThenElse(use, hn::Mul(sum.y, scale), g.y), normals.y, i);
        store(hn::IfThenElse(use, hn::Mul(sum.z, scale), g.z), normals.z, i);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(interpolate);

void interpolate_normals(const std::uint32_t* corner_normals, std::uint32_t object,
                         const HitPacket& hits, const NormalLanes& geometric,
                         NormalPacket& normals) {
    HWY_DYNAMIC_DISPATCH(interpolate)(corner_normals, object, hits, geometric, normals);
}

}  // namespace ink

#endif
