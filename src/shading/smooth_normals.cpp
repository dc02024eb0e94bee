#include "shading/smooth_normals.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shading/smooth_normals.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "scene/packed_normals-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kLanes>;
using Indices = hn::Rebind<std::int32_t, Floats>;
using Bits = hn::Rebind<std::uint32_t, Floats>;
constexpr Floats kFloats;
constexpr Indices kIndices;
constexpr Bits kBits;
using Vector = hn::Vec<Floats>;

HWY_INLINE Vector set(float value) { return hn::Set(kFloats, value); }
HWY_INLINE Vector load(const Lanes<float>& lanes, int i) {
    return hn::Load(kFloats, lanes.data() + i);
}

struct Sum {
    Vector x, y, z;
};

HWY_INLINE void add_corner(hn::Vec<Bits> packed, Vector weight, Sum& sum) {
    const auto corner = unpack_normals(kFloats, packed);
    sum.x = hn::Add(sum.x, hn::Mul(weight, corner.x));
    sum.y = hn::Add(sum.y, hn::Mul(weight, corner.y));
    sum.z = hn::Add(sum.z, hn::Mul(weight, corner.z));
}

void interpolate(const std::uint32_t* corner_normals, std::uint32_t object, const HitPacket& hits,
                 const NormalLanes& geometric, NormalPacket& normals) {
    for (int i = 0; i < kLanes; i += static_cast<int>(hn::MaxLanes(kFloats))) {
        const auto own = hn::Eq(hn::Load(kBits, hits.object.data() + i), hn::Set(kBits, object));
        const auto primitive = hn::IfThenElseZero(own, hn::Load(kBits, hits.primitive.data() + i));
        const auto twice = hn::Add(primitive, primitive);
        const auto first = hn::BitCast(kIndices, hn::Add(twice, primitive));
        const auto corner = [&](int k) {
            const auto* base = reinterpret_cast<const std::int32_t*>(corner_normals) + k;
            return hn::BitCast(kBits, hn::GatherIndex(kIndices, base, first));
        };
        const auto u = load(hits.u, i);
        const auto v = load(hits.v, i);
        Sum sum{hn::Zero(kFloats), hn::Zero(kFloats), hn::Zero(kFloats)};
        add_corner(corner(0), hn::Sub(hn::Sub(set(1.0F), u), v), sum);
        add_corner(corner(1), u, sum);
        add_corner(corner(2), v, sum);

        const auto gx = load(geometric.x, i);
        const auto gy = load(geometric.y, i);
        const auto gz = load(geometric.z, i);
        const auto dot = [](auto a, auto b, auto c, auto d, auto e, auto f) {
            return hn::Add(hn::Add(hn::Mul(a, d), hn::Mul(b, e)), hn::Mul(c, f));
        };
        const auto side = dot(sum.x, sum.y, sum.z, gx, gy, gz);
        const auto squared = dot(sum.x, sum.y, sum.z, sum.x, sum.y, sum.z);
        // Else the geometric normal stands in.
        const auto use =
            hn::And(hn::RebindMask(kFloats, own), hn::Gt(squared, set(kLeastNormalSquared)));
        const auto length = hn::Sqrt(hn::IfThenElse(use, squared, set(1.0F)));
        const auto scale = hn::Div(hn::CopySign(set(1.0F), side), length);
        hn::Store(hn::IfThenElse(use, hn::Mul(sum.x, scale), gx), kFloats, normals.x.data() + i);
        hn::Store(hn::IfThenElse(use, hn::Mul(sum.y, scale), gy), kFloats, normals.y.data() + i);
        hn::Store(hn::IfThenElse(use, hn::Mul(sum.z, scale), gz), kFloats, normals.z.data() + i);
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
